"""Report of an ensemble, in five lines and in tables."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from solar_env.pictures.page.content import Table
from solar_env.studies.common.bootstrap import FEWEST
from solar_env.studies.loads.ensemble import Loads
from solar_env.studies.loads.quantities import HUB_QUANTITIES, JOINT_QUANTITIES, QUANTITIES
from solar_env.studies.loads.runs import FREQUENCIES
from solar_env.studies.loads.statistics import Figure, counted, rounded, shortened

COLUMNS = ("quantity", "", "mean", "95 % interval", "99 % of runs below", "at 95 % confidence", "model error")


def answer(loads: Loads, wear_limit: float) -> list[str]:
    """Five lines: peak force, impulse, wear, hub, and what they rest on.

    Each figure comes with the interval of its mean, its high quantile and its own model error.
    """
    figures = loads.figures
    joint, hit = _worst(figures["peak_force"])
    lines = [f"Joint {joint} is hit hardest: peak force {_stated(hit, 'N')}."]
    joint, push = _worst(figures["impulse"])
    lines.append(f"The impulse after latching is greatest at joint {joint}: {_stated(push, 'N s')}.")
    joint, deepest = _worst(figures["wear_depth"])
    deployments = wear_limit / deepest.mean if deepest.mean > 0.0 else math.inf
    limit = 1e6 * wear_limit
    lines.append(
        f"A deployment wears joint {joint} deepest: {_stated(deepest, 'fm', 1e15)}; {counted(deployments)} deployments "
        f"to {limit:g} {'micrometre' if limit == 1.0 else 'micrometres'}, if every one wears the same place."
    )
    hub = [
        f"{_with_interval(figures[name][0], unit, scale)} ({_with_model_error(figures[name][0], unit, scale)})"
        for name, unit, scale in _HUB_SENTENCE
    ]
    lines.append(f"The hub turns by {hub[0]} at most and sees {hub[1]} and {hub[2]} at the peak.")
    lines.append(_basis(loads))
    return lines


_HUB_SENTENCE = (("hub_excursion", "deg", 180.0 / math.pi), ("hub_force", "N", 1.0), ("hub_torque", "N m", 1.0))


def _worst(figures: Sequence[Figure]) -> tuple[int, Figure]:
    """The joint with the greatest mean, counted from 1, and its figure."""
    worst = max(range(len(figures)), key=lambda j: figures[j].mean if math.isfinite(figures[j].mean) else -math.inf)
    return worst + 1, figures[worst]


def _stated(figure: Figure, unit: str, scale: float = 1.0) -> str:
    """Mean with its interval, the high quantile and its bound, the model error."""
    parts = [_with_interval(figure, unit, scale)]
    spread = scale * (figure.quantile_bound - figure.quantile)
    if math.isfinite(spread):
        quantile, bound = (rounded(scale * x, spread) for x in _quantiles(figure))
        parts.append(f"99 % of deployments stay below {quantile} {unit} (with 95 % confidence below {bound} {unit})")
    return ", ".join([*parts, _with_model_error(figure, unit, scale)])


def _with_interval(figure: Figure, unit: str, scale: float) -> str:
    half = scale * figure.half_width
    spread = f" \u00b1 {rounded(half, half)}" if math.isfinite(half) else ""
    return f"{rounded(scale * figure.mean, half)}{spread} {unit}"


def _with_model_error(figure: Figure, unit: str, scale: float) -> str:
    error = _model_error(figure, scale)
    return f"model error {error} {unit}" if error else "model error unknown"


def _model_error(figure: Figure, scale: float) -> str:
    """The model error with its interval; empty where it is not known."""
    half = scale * figure.model_half_width
    if not math.isfinite(half):
        return ""
    text = rounded(scale * figure.model_error, half)
    if float(text) == 0.0:
        text = text.removeprefix("-")
    elif not text.startswith("-"):
        text = f"+{text}"
    return f"{text} \u00b1 {rounded(half, half)}"


def _basis(loads: Loads) -> str:
    """State what the figures rest on, and what is missing."""
    plan, (level, finer) = loads.plan, loads.plan.levels
    drawn = ", ".join(plan.array.randomize) or "no parameter"
    runs = "1 run" if plan.members == 1 else f"{plan.members} runs"
    text = f"{runs} of each level, released within 0.5 mrad/s of rest; drawn: {drawn}."
    if plan.members >= FEWEST:
        text += " \u00b1 is the 95 % interval of a mean."
    else:
        text += f" Fewer than {FEWEST} runs have no interval and no model error."
    text += (
        f" Level: {level.name}, the cheapest for {plan.question} within {plan.tolerance:g}, and chosen for that "
        f"question alone; the model error of every figure is that seen at the next finer level, {finer.name}: its "
        "mean minus this one, over the same runs."
    )
    if any(loads.unlatched):
        text += (
            f" In {loads.unlatched[0]} runs of the level and {loads.unlatched[1]} of the finer a joint had not latched "
            f"within {plan.deadline:g} s; they count only where no latching is needed."
        )
    for warning, times in loads.warnings.items():
        text += f" In {times} of {2 * plan.members} runs: {warning}."
    return text


def tables(loads: Loads) -> list[Table]:
    """A table for each joint and one for the hub."""
    joints = len(loads.plan.array.parameters.joints)
    by_joint = [
        Table(f"Joint {j + 1}", COLUMNS, [_row(loads, name, j) for name in JOINT_QUANTITIES]) for j in range(joints)
    ]
    spectra = [_spectrum_rows(f"force of hinge {j + 1} [N]", loads.hinge_spectrum[..., j]) for j in range(joints)]
    spectra.append(_spectrum_rows("acceleration of the hub [m/s2]", loads.hub_spectrum))
    title = "Shock response spectra, Q = 10: mean over runs, and of the next finer level"
    columns = ("spectrum", *(f"{f:.0f} Hz" for f in FREQUENCIES[_SHOWN]))
    return [
        *by_joint,
        Table("Hub", COLUMNS, [_row(loads, name, 0) for name in HUB_QUANTITIES]),
        Table(title, columns, [row for rows in spectra for row in rows]),
    ]


_SHOWN = slice(3, None, 6)


def _row(loads: Loads, name: str, index: int) -> list[str]:
    quantity, figure = QUANTITIES[name], loads.figures[name][index]
    scale, half = quantity.scale, quantity.scale * figure.half_width
    interval = "-"
    if math.isfinite(half):
        interval = f"{rounded(scale * figure.low, half)} to {rounded(scale * figure.high, half)}"
    return [
        quantity.name,
        quantity.unit,
        rounded(scale * figure.mean, half),
        interval,
        *(rounded(scale * x, scale * (figure.quantile_bound - figure.quantile)) for x in _quantiles(figure)),
        _model_error(figure, scale) or "-",
    ]


def _quantiles(figure: Figure) -> tuple[float, float]:
    return figure.quantile, figure.quantile_bound


def _spectrum_rows(name: str, spectra: NDArray[np.float64]) -> list[list[str]]:
    means = spectra.mean(axis=1) if spectra.size else np.zeros((2, 0))
    return [
        [label, *map(shortened, level[_SHOWN])] for label, level in zip((name, "  finer level"), means, strict=True)
    ]
