"""Conclusions of the figures of the paper, in words from their tables: the second lines of their titles."""

from collections.abc import Callable, Mapping

import numpy as np

from solar_env.array import MODELS
from solar_env.studies.common.tables import Table
from solar_env.studies.paper.cases import EQ_40, FOUR_BAR_TURNS

JOINT_NUMBERS = (1, 2)  # as the columns of the tables count them


def shown_of_models(table: Table) -> tuple[str, str]:
    """Quantity and unit in the columns of a table of the four models."""
    return ("angles", "rad") if f"{MODELS[0]}_angles_1_rad" in table.rows[0] else ("rates", "rad_s")


def _greatest(name: str, unit: str) -> Callable[[Table], str]:
    def words(table: Table) -> str:
        first, second = (np.abs(table.column(name.format(joint))).max() for joint in JOINT_NUMBERS)
        return f"at most {first:.3g} {unit} at joint 1, {second:.3g} {unit} at joint 2"

    return words


def _small_forces(table: Table) -> str:
    return f"{_greatest('force_{}_N', 'N')(table)} (by Eq 40 {_greatest(EQ_40 + 'force_{}_N', 'N')(table)})"


def _angles(table: Table) -> str:
    late = table.column("time_s") > table.column("time_s")[-1] - 10.0
    swings = [np.ptp(table.column(f"angle_{joint}_rad")[late]) for joint in JOINT_NUMBERS]
    return f"in the last 10 s they still swing over {swings[0]:.2g} and {swings[1]:.2g} rad"


def _path(table: Table) -> str:
    time, phase = table.column("time_s"), table.column("phase")
    return f"impacts to {time[phase > 1][0]:.2f} s, then along the wall to {time[phase > 2][0]:.2f} s, then across"


def _models(table: Table) -> str:
    quantity, unit = shown_of_models(table)
    late = table.column("phase") == 3

    def values(model: str) -> np.ndarray:
        return np.stack([table.column(f"{model}_{quantity}_{joint}_{unit}")[late] for joint in JOINT_NUMBERS])

    apart = {model: np.abs(values(model) - values(MODELS[0])).max() for model in MODELS[1:]}
    furthest = max(apart, key=lambda model: apart[model])
    return f"after latching {furthest} differs most from {MODELS[0]}, by {apart[furthest]:.2g} {unit.replace('_', '/')}"


def _wear(table: Table) -> str:
    return f"deepest in the {_deepest('', table)} (by Eq 40 in the {_deepest(EQ_40, table)})"


def _deepest(prefix: str, table: Table) -> str:
    depths = {
        f"{surface} of joint {joint}": table.column(f"{prefix}{surface}_{joint}_m").max()
        for surface in ("bearing", "journal")
        for joint in JOINT_NUMBERS
    }
    deepest = max(depths, key=lambda place: depths[place])
    return f"{deepest}, {depths[deepest]:.1e} m"


def _four_bar(table: Table) -> str:
    moment = table.where(quantity="crank moment [N m]")
    ideal, loose = (np.abs(moment.where(turns=turns).column("value")).max() for turns in (0, FOUR_BAR_TURNS[-1]))
    return f"the clearance makes the greatest moment {loose / ideal:.2g} times that of ideal joints"


CONCLUSIONS: Mapping[str, Callable[[Table], str]] = {
    "angles": _angles,
    "path": _path,
    "forces": _greatest("force_{}_N", "N"),
    "small-forces": _small_forces,
    "torques": _greatest("torque_{}_Nm", "N m"),
    "models": _models,
    "wear": _wear,
    "four-bar": _four_bar,
}
