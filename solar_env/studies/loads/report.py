"""Report of an ensemble: five lines, tables, and a page with the nominal array in motion, plots and spectra."""

import math
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from solar_env.pictures.page.content import Chart, Line, Page, Table
from solar_env.pictures.style import COLOURS
from solar_env.studies.common.bootstrap import FEWEST
from solar_env.studies.common.deployment_page import charts_of, motion_of, parameter_table, shown_samples
from solar_env.studies.loads.ensemble import CYLINDER, Loads
from solar_env.studies.loads.quantities import HUB_QUANTITIES, JOINT_QUANTITIES, QUANTITIES, Quantity
from solar_env.studies.loads.runs import FREQUENCIES, Deployment
from solar_env.studies.loads.statistics import Figure, counted, rounded, shortened

COLUMNS = ("quantity", "", "mean", "95 % interval", "99 % of runs below", "at 95 % confidence", "discretisation error")
WEAR_LIMIT = 1e-6  # m, to which deployments are counted
MANY_DEPLOYMENTS = 1e5  # more than any array sees, ground tests included
_SHOWN = slice(3, None, 6)  # of the frequencies, in the table


def answer(loads: Loads, before: Sequence[str] = ()) -> list[str]:
    """State what sizes the hinges, pin force, momentum exchanged, wear, the hub's loads, and what they rest on.

    After the first line come those of what was known before the runs, see `statics`. Each figure comes with the
    interval of its mean, its high quantile and its discretisation error.
    """
    names = ("latch_torque", "latch_rate", "peak_force", "impulse", "wear_depth")
    worst = {name: _worst(loads.figures[name]) for name in names}
    stated = {name: _stated(figure, QUANTITIES[name]) for name, (_, figure) in worst.items()}
    joint, deepest = worst["wear_depth"]
    deployments = WEAR_LIMIT / deepest.mean if deepest.mean > 0.0 else math.inf
    negligible = "which is negligible: " if deployments > MANY_DEPLOYMENTS else ""
    hub = [
        f"{_with_interval(figure, quantity)} ({_with_model_error(figure, quantity)})"
        for name in ("hub_excursion", "hub_force", "hub_torque")
        for figure, quantity in [(loads.figures[name][0], QUANTITIES[name])]
    ]
    stopped, (fastest, rate) = worst["latch_torque"][0], worst["latch_rate"]
    return [
        f"The latch of joint {stopped} takes the greatest torque, on which a hinge is sized: {stated['latch_torque']}; "
        f"joint {fastest} latches fastest, at {_with_interval(rate, QUANTITIES['latch_rate'])}.",
        *before,
        f"The pin of joint {worst['peak_force'][0]} is hit hardest: {stated['peak_force']}; {_form(loads)}.",
        f"Within {loads.plan.window:g} s of the last latching joint {worst['impulse'][0]} exchanges most momentum: "
        f"{stated['impulse']}.",
        f"A deployment wears joint {joint} deepest: {stated['wear_depth']}; {negligible}{counted(deployments)} "
        "deployments to 1 micrometre, if every one wears the same place.",
        f"The hub turns by {hub[0]} at most and sees {hub[1]} and {hub[2]} at the peak.",
        _basis(loads),
    ]


def _worst(figures: Sequence[Figure]) -> tuple[int, Figure]:
    """The joint with the greatest mean, counted from 1, and its figure."""
    worst = max(range(len(figures)), key=lambda j: figures[j].mean if math.isfinite(figures[j].mean) else -math.inf)
    return worst + 1, figures[worst]


def _form(loads: Loads) -> str:
    """State the peak pin force with the other contact law."""
    law = f"the contact law of {_other_contact(loads)}"
    if not loads.form:
        return f"model form unknown, for {law} does not take this array"
    joint, figure = _worst(loads.form)
    return (
        f"with {law} joint {joint} has {_with_interval(figure, QUANTITIES['peak_force'])}: so unsure is the model form"
    )


def _other_contact(loads: Loads) -> str:
    return "spheres" if loads.plan.array.parameters.contact_law == CYLINDER else "a cylinder in its bush"


def _stated(figure: Figure, quantity: Quantity) -> str:
    """Mean with its interval, the high quantile and its bound, the model error."""
    parts, (quantile, bound), unit = [_with_interval(figure, quantity)], _quantiles(figure, quantity), quantity.unit
    if quantile != "-":
        parts.append(f"99 % of deployments stay below {quantile} {unit} (with 95 % confidence below {bound} {unit})")
    return ", ".join([*parts, _with_model_error(figure, quantity)])


def _with_interval(figure: Figure, quantity: Quantity) -> str:
    half = quantity.scale * figure.half_width
    spread = f" \u00b1 {rounded(half, half)}" if math.isfinite(half) else ""
    return f"{rounded(quantity.scale * figure.mean, half)}{spread} {quantity.unit}"


def _quantiles(figure: Figure, quantity: Quantity) -> tuple[str, str]:
    """The high quantile and its bound, in the digits that their distance leaves them; "-" if they are not known."""
    quantile, bound = quantity.scale * figure.quantile, quantity.scale * figure.quantile_bound
    return rounded(quantile, bound - quantile), rounded(bound, bound - quantile)


def _with_model_error(figure: Figure, quantity: Quantity) -> str:
    error = _model_error(figure, quantity)
    return "discretisation error unknown" if error == "-" else f"discretisation error {error} {quantity.unit}"


def _model_error(figure: Figure, quantity: Quantity) -> str:
    """The model error with its interval; "-" where it is not known."""
    half = quantity.scale * figure.model_half_width
    if not math.isfinite(half):
        return "-"
    text = rounded(quantity.scale * figure.model_error, half)
    return f"{'' if text.startswith('-') or float(text) == 0.0 else '+'}{text} \u00b1 {rounded(half, half)}"


def _basis(loads: Loads) -> str:
    """State what the figures rest on, and what is missing."""
    plan, (level, finest) = loads.plan, loads.plan.levels
    drawn = ", ".join(plan.array.randomize)
    runs = "1 run" if plan.members == 1 else f"{plan.members} runs"
    text = f"{runs} of each level, released within 0.5 mrad/s of rest; "
    if drawn:
        text += f"drawn: {drawn}."
    else:
        text += (
            "no parameter is drawn, so that intervals and quantiles are those of the release alone, which is assumed: "
            "give tolerances in the file."
        )
    if plan.members >= FEWEST:
        text += " \u00b1 is the 95 % interval of a mean."
    else:
        text += f" Fewer than {FEWEST} runs have no interval and no discretisation error."
    text += (
        f" Level: {level.name}; the discretisation error of every figure is that seen at the finest level, "
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
        text += f" In {times} of {(3 if loads.form else 2) * plan.members} runs: {warning}."
    return text


def tables(loads: Loads) -> list[Table]:
    """A table for each joint, one for the hub, and one of spectra."""
    joints = range(len(loads.plan.array.parameters.joints))
    spectra = {f"force of hinge {j + 1} [N]": loads.hinge_spectrum[..., j] for j in joints}
    spectra["acceleration of the hub [m/s2]"] = loads.hub_spectrum
    rows = [row for name, levels in spectra.items() for row in _spectrum_rows(name, levels)]
    title = "Shock response spectra, Q = 10: mean over runs, and of the finest level"
    return [
        *(Table(f"Joint {j + 1}", COLUMNS, list(_joint_rows(loads, j))) for j in joints),
        Table("Hub", COLUMNS, [_row(QUANTITIES[name], loads.figures[name][0]) for name in HUB_QUANTITIES]),
        Table(title, ("spectrum", *(f"{f:.0f} Hz" for f in FREQUENCIES[_SHOWN])), rows),
    ]


def _joint_rows(loads: Loads, joint: int) -> Iterator[list[str]]:
    """Rows of a joint's figures; below the pin force, that of the other contact law."""
    for name in JOINT_QUANTITIES:
        yield _row(QUANTITIES[name], loads.figures[name][joint])
        if name == "peak_force" and loads.form:
            quantity = QUANTITIES[name]
            *cells, _ = _row(quantity, loads.form[joint])
            yield [f"{quantity.name}, as of {_other_contact(loads)} (model form)", *cells[1:], "-"]


def _row(quantity: Quantity, figure: Figure) -> list[str]:
    half = quantity.scale * figure.half_width
    mean, low, high = (rounded(quantity.scale * x, half) for x in (figure.mean, figure.low, figure.high))
    interval = f"{low} to {high}" if math.isfinite(half) else "-"
    return [quantity.name, quantity.unit, mean, interval, *_quantiles(figure, quantity), _model_error(figure, quantity)]


def _spectrum_rows(name: str, spectra: NDArray[np.float64]) -> Iterator[list[str]]:
    means = spectra.mean(axis=1) if spectra.size else np.zeros((2, 0))
    for label, level in zip((name, "  finest level"), means, strict=True):
        yield [label, *map(shortened, level[_SHOWN])]


def loads_page(loads: Loads, nominal: Deployment, notes: Sequence[str], before: Sequence[str] = ()) -> Page:
    """The page of an ensemble and of a deployment to look at, with notes as its last lines."""
    name = f"Nominal array, {loads.plan.levels[0].name}"
    charts = [*charts_of({name: nominal.trajectory}), *_hub_charts(nominal), *_spectra(loads)]
    motions = [motion_of(nominal.trajectory, name)]
    title = "How hard the hinges and the hub are hit"
    parameters = parameter_table(loads.plan.array.parameters, loads.plan.array.randomize)
    return Page(title, answer(loads, before), motions, charts, [*tables(loads), parameters], notes)


def _hub_charts(nominal: Deployment) -> Iterator[Chart]:
    """Turn of the hub, and the greatest loads on it from each of the moments shown to the next."""
    kept, time = shown_samples(nominal.trajectory), nominal.trajectory.time
    turn = np.degrees(nominal.place[kept, 2] - nominal.place[0, 2])
    line = Line("hub", time[kept], turn, COLOURS[0])
    yield Chart(f"The nominal hub turns by up to {np.abs(turn).max():.3g} degrees", "time [s]", "angle [deg]", [line])
    begins = kept[kept < len(time) - 1]
    greatest = np.maximum.reduceat(nominal.hub_greatest, begins, axis=0)
    for k, (name, unit) in enumerate((("force of the root hinge", "N"), ("torque about its centroid", "N m"))):
        values = greatest[:, k]
        title = f"The nominal hub sees up to {shortened(values.max(), 3)} {unit}"
        yield Chart(title, "time [s]", f"greatest over 50 us [{unit}]", [Line(name, time[begins], values, COLOURS[0])])


def _spectra(loads: Loads) -> Iterator[Chart]:
    """Mean and greatest of the runs, and the mean of the finest level."""
    if not loads.hub_spectrum.size:
        return
    greatest = loads.hinge_spectrum[0].mean(axis=0).max(axis=0)
    worst, hub = int(greatest.argmax()), loads.hub_spectrum[0].mean(axis=0).max()
    hinges = [_spectrum(loads.hinge_spectrum[..., j], f"joint {j + 1}, ", j) for j in range(len(greatest))]
    title = f"hinge forces (Q = 10): up to {greatest[worst]:.3g} N, at hinge {worst + 1}"
    yield _spectrum_chart(title, "force [N]", [line for lines in hinges for line in lines])
    title = f"the hub (Q = 10): up to {hub:.2g} m/s2"
    yield _spectrum_chart(title, "acceleration [m/s2]", _spectrum(loads.hub_spectrum, "", 0))


def _spectrum_chart(what: str, y: str, lines: Sequence[Line]) -> Chart:
    return Chart(f"Shock response of {what}", "natural frequency [Hz]", y, lines, False, "xy")


def _spectrum(spectra: NDArray[np.float64], prefix: str, colour: int) -> list[Line]:
    runs, finest = spectra
    rows = (
        ("mean", runs.mean(axis=0), "solid"),
        ("greatest", runs.max(axis=0), "dot"),
        ("finest level", finest.mean(axis=0), "dash"),
    )
    return [Line(prefix + name, FREQUENCIES, values, COLOURS[colour], dash) for name, values, dash in rows]
