"""Report of an ensemble, in five lines and in tables."""

import math

import numpy as np

from solar_env.pictures.page.content import Table
from solar_env.studies.loads.ensemble import Loads
from solar_env.studies.loads.quantities import HUB_QUANTITIES, JOINT_QUANTITIES, QUANTITIES
from solar_env.studies.loads.statistics import FEWEST, Figure, rounded, shortened

COLUMNS = ("quantity", "", "mean", "95 % interval", "99 % of runs below", "at 95 % confidence", "model error")


def answer(loads: Loads, wear_limit: float) -> list[str]:
    """Five lines: how hard, how sure, the hub, the wear, and what was left out."""
    plan, figures = loads.plan, loads.figures
    forces = figures["peak_force"]
    worst = max(range(len(forces)), key=lambda j: _or_zero(forces[j].mean))
    hit = forces[worst]
    spread = hit.quantile_bound - hit.quantile
    bound = f"; 99 % of deployments stay below {rounded(hit.quantile, spread)} N" if math.isfinite(hit.quantile) else ""
    if math.isfinite(hit.quantile_bound):
        bound += f", with 95 % confidence below {rounded(hit.quantile_bound, spread)} N"
    lines = [f"Joint {worst + 1} is hit hardest: peak force {_with_interval(hit, 'N')} in the mean{bound}."]
    level, finer = plan.levels
    share = abs(hit.model_error / hit.mean)
    known = math.isfinite(hit.model_low)
    error = f"changes that by {share:.1%}" if known else "cannot yet be compared: give more runs"
    if known and hit.model_low < 0.0 < hit.model_high:
        error += ", which is within sampling"
    lines.append(
        f"Model: {level.name}, the cheapest level for {plan.question} within {plan.tolerance:g}; the next finer, "
        f"{finer.name}, {error}."
    )
    hub = [_with_interval(figures[name][0], unit, scale) for name, unit, scale in _HUB_SENTENCE]
    lines.append(f"The hub turns by {hub[0]} at most and sees {hub[1]} and {hub[2]} at the peak.")
    wear = figures["wear_depth"]
    deepest = max((f for f in wear if math.isfinite(f.mean)), key=lambda f: f.mean, default=wear[0])
    deployments = wear_limit / deepest.mean if deepest.mean > 0.0 else math.inf
    lines.append(
        f"Wear: {rounded(1e15 * deepest.mean, 1e15 * deepest.uncertainty)} fm a deployment at the deepest place; "
        f"{shortened(deployments)} deployments to {1e6 * wear_limit:g} micrometres, if every one wears the same place."
    )
    lines.append(_basis(loads))
    return lines


_HUB_SENTENCE = (("hub_excursion", "deg", 180.0 / math.pi), ("hub_force", "N", 1.0), ("hub_torque", "N m", 1.0))


def _basis(loads: Loads) -> str:
    """State what the figures rest on, and what is missing."""
    plan = loads.plan
    drawn = ", ".join(plan.array.randomize) or "no parameter"
    runs = "1 run" if plan.members == 1 else f"{plan.members} runs"
    text = f"{runs} of each level, released within 0.5 mrad/s of rest; drawn: {drawn}."
    if plan.members < FEWEST:
        text += f" Fewer than {FEWEST} runs have no interval."
    if any(loads.unlatched):
        text += (
            f" In {loads.unlatched[0]} of them a joint had not latched within {plan.deadline:g} s; they count only "
            "where no latching is needed."
        )
    for warning, times in loads.warnings.items():
        text += f" In {times} of {2 * plan.members} runs: {warning}."
    return text


def tables(loads: Loads) -> list[Table]:
    """A table for each joint and one for the hub."""
    joints = loads.plan.array.parameters.panel_count
    by_joint = [
        Table(f"Joint {j + 1}", COLUMNS, [_row(loads, name, j) for name in JOINT_QUANTITIES]) for j in range(joints)
    ]
    spectra = [_spectrum_row(loads, j) for j in range(joints)]
    title = "Shock response spectra, Q = 10: mean over runs, and of the next finer level"
    columns = ("spectrum", *(f"{f:.0f} Hz" for f in loads.frequencies[_SHOWN]))
    return [
        *by_joint,
        Table("Hub", COLUMNS, [_row(loads, name, 0) for name in HUB_QUANTITIES]),
        Table(title, columns, [row for rows in spectra for row in rows] + _hub_spectrum_rows(loads)),
    ]


_SHOWN = slice(3, None, 6)


def _row(loads: Loads, name: str, index: int) -> list[str]:
    quantity, figure = QUANTITIES[name], loads.figures[name][index]
    scale, uncertainty = quantity.scale, quantity.scale * figure.uncertainty
    interval = "-"
    if math.isfinite(figure.low):
        interval = f"{rounded(scale * figure.low, uncertainty)} to {rounded(scale * figure.high, uncertainty)}"
    error = "-"
    if math.isfinite(figure.model_low):
        half = 0.5 * (figure.model_high - figure.model_low)
        error = f"{_signed(scale * figure.model_error, scale * half)} \u00b1 {shortened(scale * half, 1)}"
    return [
        quantity.name,
        quantity.unit,
        rounded(scale * figure.mean, uncertainty),
        interval,
        *(rounded(scale * x, scale * (figure.quantile_bound - figure.quantile)) for x in _quantiles(figure)),
        error,
    ]


def _quantiles(figure: Figure) -> tuple[float, float]:
    return figure.quantile, figure.quantile_bound


def _signed(value: float, uncertainty: float) -> str:
    text = rounded(value, uncertainty)
    return text if text.startswith("-") else f"+{text}"


def _spectrum_row(loads: Loads, joint: int) -> list[list[str]]:
    means = loads.hinge_spectrum[..., joint].mean(axis=1) if loads.hinge_spectrum.size else np.zeros((2, 0))
    labels = (f"force of hinge {joint + 1} [N]", "  finer level")
    return [[label, *map(shortened, level[_SHOWN])] for label, level in zip(labels, means, strict=True)]


def _hub_spectrum_rows(loads: Loads) -> list[list[str]]:
    means = loads.hub_spectrum.mean(axis=1) if loads.hub_spectrum.size else np.zeros((2, 0))
    labels = ("acceleration of the hub [m/s2]", "  finer level")
    return [[label, *map(shortened, level[_SHOWN])] for label, level in zip(labels, means, strict=True)]


def _with_interval(figure: Figure, unit: str, scale: float = 1.0) -> str:
    text = f"{rounded(scale * figure.mean, scale * figure.uncertainty)} {unit}"
    if not math.isfinite(figure.low):
        return text
    return f"{text} (\u00b1 {shortened(scale * 0.5 * (figure.high - figure.low), 1)})"


def _or_zero(value: float) -> float:
    return value if math.isfinite(value) else 0.0
