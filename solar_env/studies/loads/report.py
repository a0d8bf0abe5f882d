"""Report of the loads in an ensemble of deployments, as a few sentences and tables."""

import math
from collections.abc import Iterable, Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from solar_env.pictures.page.content import Table
from solar_env.studies.common.bootstrap import FEWEST
from solar_env.studies.loads.ensemble import Loads
from solar_env.studies.loads.quantities import HUB_QUANTITIES, JOINT_QUANTITIES, QUANTITIES, Quantity
from solar_env.studies.loads.runs import FREQUENCIES
from solar_env.studies.loads.sensitivity import SHARE, Effects
from solar_env.studies.loads.statistics import Figure, counted, rounded, shortened

COLUMNS = ("quantity", "", "mean", "95 % interval", "99 % of runs below", "at 95 % confidence", "discretisation error")
WEAR_LIMIT = 1e-6  # m; wear depth up to which deployments are counted
MANY_DEPLOYMENTS = 1e5  # number of deployments that no array sees, ground tests included
_SHOWN = slice(3, None, 6)  # frequencies shown in the table
_SIZING = ("latch_torque", "peak_force", "hub_excursion")  # quantities whose sensitivities a sentence states
_TOLD = 3  # greatest number of parameters stated for a quantity


def answer(loads: Loads, before: Sequence[str] = ()) -> list[str]:
    """Return sentences on latch torque, hub motion, pin force, momentum, wear, hub loads, and the runs.

    The sentences `before`, known before any run, follow the first. Each load has the 95 % interval of its mean.
    """
    stated = {name: _stated(figure, QUANTITIES[name]) for name, (_, figure) in _worst_of(loads, _STATED).items()}
    worst = _worst_of(loads, JOINT_QUANTITIES)
    hub = {name: _with_interval(loads.figures[name][0], QUANTITIES[name]) for name in HUB_QUANTITIES}
    errors = {name: _with_model_error(loads.figures[name][0], QUANTITIES[name]) for name in HUB_QUANTITIES}
    joint, deepest = worst["wear_depth"]
    deployments = WEAR_LIMIT / deepest.mean if deepest.mean > 0.0 else math.inf
    scatter = loads.plan.members >= FEWEST and not loads.plan.array.randomize
    alone = "Intervals (\u00b1) are of an assumed scatter of the release alone: give tolerances in the file. "
    negligible = "which is negligible: " if deployments > MANY_DEPLOYMENTS else ""
    (stopped, _), (fastest, rate), (bent, moment) = (
        worst[name] for name in ("latch_torque", "latch_rate", "peak_torque")
    )
    return [
        (alone if scatter else "")
        + f"The latch of {stopped} takes the greatest torque, on which a hinge is sized: {stated['latch_torque']}; "
        f"{fastest} latches fastest, at {_with_interval(rate, QUANTITIES['latch_rate'])}; the root of the panel of "
        f"{bent} is bent hardest, by {_with_interval(moment, QUANTITIES['peak_torque'])}; the hub turns by "
        f"{hub['hub_excursion']} at most ({errors['hub_excursion']}) and is accelerated by {hub['hub_acceleration']}.",
        *before,
        f"The pin of {worst['peak_force'][0]} is hit hardest: {stated['peak_force']}; {_forms(loads)}.",
        f"Within {loads.plan.window:g} s of the last latching {worst['impulse'][0]} exchanges most momentum: "
        f"{stated['impulse']}.",
        f"A deployment wears {joint} deepest: {stated['wear_depth']}; {negligible}{counted(deployments)} "
        "deployments to 1 micrometre, if every one wears the same place.",
        f"The hub sees {hub['hub_force']} ({errors['hub_force']}) and {hub['hub_torque']} ({errors['hub_torque']}) at "
        "the peak.",
        _basis(loads),
    ]


_STATED = ("latch_torque", "peak_force", "impulse", "wear_depth")


def _worst_of(loads: Loads, names: Iterable[str]) -> dict[str, tuple[str, Figure]]:
    """Return, for each quantity in `names`, the name of the joint with the greatest mean, and the statistics there."""
    found = {name: worst_joint(loads.figures[name]) for name in names}
    joints = loads.plan.array.parameters.joints
    return {name: (joints[joint].name, loads.figures[name][joint]) for name, joint in found.items()}


def worst_joint(figures: Sequence[Figure]) -> int:
    """Return the index of the joint with a quantity's greatest mean; `figures` has the statistics at each joint."""
    return max(range(len(figures)), key=lambda j: figures[j].mean if math.isfinite(figures[j].mean) else -math.inf)


def full_name(loads: Loads, quantity: str, joint: int) -> str:
    """Return a quantity's printed name, with the joint's name unless it is a hub quantity; `joint` counts from 0."""
    of_joint = f" of {loads.plan.array.parameters.joints[joint].name}" if quantity in JOINT_QUANTITIES else ""
    return f"{QUANTITIES[quantity].name}{of_joint}"


def _forms(loads: Loads) -> str:
    """Return a clause with the peak pin force under each alternative contact law, and the range over all laws."""
    if not loads.forms:
        return "model form unknown, for no other contact law takes this array"
    told, means = [], [loads.figures["peak_force"][worst_joint(loads.figures["peak_force"])].mean]
    for contact, figures in loads.forms.items():
        joint = worst_joint(figures)
        name = loads.plan.array.parameters.joints[joint].name
        force = _with_interval(figures[joint], QUANTITIES["peak_force"])
        told.append(f"{force} at {name} by the contact law of {contact}")
        means.append(figures[joint].mean)
    low, high = (shortened(end) for end in (min(means), max(means)))
    size = "size on the greatest, or measure bracket_stiffness and take contact_law = bracket"
    return f"{', '.join(told)}: the model form leaves it between {low} and {high} N ({size})"


def what_changes(loads: Loads) -> str:
    """Return a sentence on the parameters that change latch torque, pin force and hub rotation (`_SIZING`) most."""
    found = loads.sensitivity
    if found.missing:
        return f"What changes the figures is not known: {found.missing}."
    told, one_sided = [], False
    for name in _SIZING:
        joint = worst_joint(loads.figures[name])
        effects = found.effects[name][joint]
        one_sided |= any(effects.one_sided(parameter) for parameter in effects.ranking[:_TOLD])
        most = [f"{parameter} {effect_text(effects, parameter)}" for parameter in effects.ranking[:_TOLD]]
        told.append(f"the {full_name(loads, name, joint)}: {', '.join(most) if most else 'nothing beyond its scatter'}")
    how = (
        "standardised coefficients of the drawn parameters"
        if found.drawn
        else f"{100 * SHARE:g} % less, {100 * SHARE:g} % more"
    )
    luck = " Where less and more change a load alike, the nominal value is a lucky or unlucky one." if one_sided else ""
    return f"What changes them most ({how}): {'; '.join(told)}.{luck}"


def effect_text(effects: Effects, parameter: str) -> str:
    """Format a parameter's effect on a quantity: after a regression, the coefficient and its 95 % half-interval.

    After shifts of one parameter at a time: the quantity's changes [%] as the parameter is lowered, and raised.
    """
    low, high = effects.low[parameter], effects.high[parameter]
    if math.isfinite(effects.explained):
        return f"{0.5 * (low + high):+.2f} \u00b1 {0.5 * (high - low):.2f}"
    return ", ".join(f"{100.0 * end:+.2g} %" if math.isfinite(end) else "-" for end in (low, high))


def sureness(effects: Effects) -> str:
    """Return a phrase on how sure effects are: after a regression, the percentage of variance that it explains.

    After shifts of one parameter at a time: the change [%] of the quantity that slight perturbations alone may cause.
    """
    if math.isfinite(effects.explained):
        return f"{100.0 * max(effects.explained, 0.0):.0f} % of the variance explained"
    return f"below {shortened(100.0 * effects.noise)} % is scatter" if effects.noise > 0.0 else "scatter unknown"


def _stated(figure: Figure, quantity: Quantity) -> str:
    """Return a text: mean with interval, 99 % quantile with upper confidence bound (if known), discretisation error."""
    parts, (quantile, bound), unit = [_with_interval(figure, quantity)], _quantiles(figure, quantity), quantity.unit
    if quantile != "-":
        parts.append(f"99 % of deployments stay below {quantile} {unit} (with 95 % confidence below {bound} {unit})")
    return ", ".join([*parts, _with_model_error(figure, quantity)])


def _with_interval(figure: Figure, quantity: Quantity) -> str:
    half = quantity.scale * figure.half_width
    spread = f" \u00b1 {rounded(half, half)}" if math.isfinite(half) else ""
    return f"{rounded(quantity.scale * figure.mean, half)}{spread} {quantity.unit}"


def _quantiles(figure: Figure, quantity: Quantity) -> tuple[str, str]:
    """Return the 99 % quantile of `quantity` and the quantile's upper bound as texts; "-" if unknown.

    `figure` has the quantity's statistics. The difference of both numbers decides how many digits are shown.
    """
    quantile, bound = quantity.scale * figure.quantile, quantity.scale * figure.quantile_bound
    return rounded(quantile, bound - quantile), rounded(bound, bound - quantile)


def _with_model_error(figure: Figure, quantity: Quantity) -> str:
    error = _model_error(figure, quantity)
    return "discretisation error unknown" if error == "-" else f"discretisation error {error} {quantity.unit}"


def _model_error(figure: Figure, quantity: Quantity) -> str:
    """Format the discretisation error in `figure`, a quantity's statistics, with its 95 % interval; "-" if unknown."""
    half = quantity.scale * figure.model_half_width
    if not math.isfinite(half):
        return "-"
    text = rounded(quantity.scale * figure.model_error, half)
    return f"{'' if text.startswith('-') or float(text) == 0.0 else '+'}{text} \u00b1 {rounded(half, half)}"


def _basis(loads: Loads) -> str:
    """Return sentences on the runs and model levels behind the results, and on missing runs."""
    plan, (level, finest) = loads.plan, loads.plan.levels
    drawn = ", ".join(plan.array.randomize)
    runs = "1 run" if plan.members == 1 else f"{plan.members} runs"
    text = f"{runs} of each level, released within 0.5 mrad/s of rest; "
    if drawn:
        text += f"drawn: {drawn}."
    else:
        text += "no parameter is drawn."
    if plan.members >= FEWEST:
        text += " \u00b1 is the 95 % interval of a mean."
    else:
        text += f" Fewer than {FEWEST} runs have no interval and no discretisation error."
    text += (
        f" Level: {level.name}; the discretisation error of a figure is its difference from the finest level, "
        f"{finest.name}: its mean minus this one, over the same runs."
    )
    if any(loads.unlatched):
        text += (
            f" In {loads.unlatched[0]} runs of the level and {loads.unlatched[1]} of the finest a joint had not "
            f"latched within {plan.deadline:g} s; they count only where no latching is needed."
        )
    if loads.failures:
        text += f" {loads.failures}"
    for warning, times in loads.warnings.items():
        text += f" In {times} of {len(plan.asked) * plan.members} runs: {warning}."
    return text


def tables(loads: Loads) -> list[Table]:
    """Return a table for each joint, one for the hub, one of spectra, and one of sensitivities if these are known."""
    joints = loads.plan.array.parameters.joints
    spectra = {f"force of {joint.name} [N]": loads.hinge_spectrum[..., joint.index] for joint in joints}
    spectra["acceleration of the hub [m/s2]"] = loads.hub_spectrum
    rows = [row for name, levels in spectra.items() for row in _spectrum_rows(name, levels)]
    title = "Shock response spectra, Q = 10: mean over runs, and of the finest level"
    return [
        *(Table(f"J{joint.name[1:]}", COLUMNS, list(_joint_rows(loads, joint.index))) for joint in joints),
        Table("Hub", COLUMNS, [_row(QUANTITIES[name], loads.figures[name][0]) for name in HUB_QUANTITIES]),
        Table(title, ("spectrum", *(f"{f:.0f} Hz" for f in FREQUENCIES[_SHOWN])), rows),
        *_changes(loads),
    ]


def _changes(loads: Loads) -> Iterator[Table]:
    """Yield a table of the three parameters that change each quantity most at its worst joint, if effects are known."""
    ranks = ("most", "then", "then")
    rows = []
    for name, by_joint in loads.sensitivity.effects.items():
        joint = worst_joint(loads.figures[name])
        effects = by_joint[joint]
        cells = [f"{parameter}: {effect_text(effects, parameter)}" for parameter in effects.ranking[: len(ranks)]]
        blank = [""] * (len(ranks) - len(cells))
        rows.append([full_name(loads, name, joint), *cells, *blank, sureness(effects)])
    if rows and loads.sensitivity.drawn:
        title = "What changes a figure: standardised coefficients of the parameters drawn, with 95 % intervals"
        yield Table(title, ("figure", *ranks, "how sure"), rows)
    elif rows:
        title = f"What changes a figure: one parameter {100 * SHARE:g} % less, and more"
        yield Table(title, ("figure", *ranks, "how sure"), rows)


def _joint_rows(loads: Loads, joint: int) -> Iterator[list[str]]:
    """Yield a joint's table rows, one per quantity; the pin force has further rows, for alternative contact laws."""
    for name in JOINT_QUANTITIES:
        yield _row(QUANTITIES[name], loads.figures[name][joint])
        for contact, figures in loads.forms.items() if name == "peak_force" else ():
            *cells, _ = _row(QUANTITIES[name], figures[joint])
            yield [f"{QUANTITIES[name].name}, contact law of {contact}", *cells[1:], "-"]


def _row(quantity: Quantity, figure: Figure) -> list[str]:
    half = quantity.scale * figure.half_width
    mean, low, high = (rounded(quantity.scale * x, half) for x in (figure.mean, figure.low, figure.high))
    interval = f"{low} to {high}" if math.isfinite(half) else "-"
    return [quantity.name, quantity.unit, mean, interval, *_quantiles(figure, quantity), _model_error(figure, quantity)]


def _spectrum_rows(name: str, spectra: NDArray[np.float64]) -> Iterator[list[str]]:
    means = spectra.mean(axis=1) if spectra.size else np.zeros((2, 0))
    for label, level in zip((name, "  finest level"), means, strict=True):
        yield [label, *map(shortened, level[_SHOWN])]
