"""Ranges of the parameters: each parameter over eight decades, with the outcome and the library's messages."""

import warnings
from collections.abc import Callable, Iterable
from dataclasses import replace
from pathlib import Path
from textwrap import shorten
from typing import Any

from solar_env.array import ArrayParameters, build, default_integrator
from solar_env.array.parameters.checks import UnitWarning
from solar_env.mechanics.running.diagnosis import LARGEST_ENERGY_SHARE
from solar_env.mechanics.running.simulation import Simulation
from solar_env.studies.common.tables import Row, Table, provenance, write_table
from solar_env.studies.stability.maps import Finding, Kind, Said, listen
from solar_env.support.markdown import markdown_table

FACTORS = tuple(10.0**decade for decade in range(-4, 5))
MODELS = ("rigid-clearance", "flexible-clearance")
DURATION = 15.0  # s; the default array latches after 12.3 s
MAX_STEPS = 500_000
LONGEST = 140  # greatest number of characters of a message on the page; the table has the whole message
# Values from which the decades are counted where the default is zero [m, rad/s] or follows from others, as the torque
# ratio of the cable follows from its wheels.
COUNTED_FROM = {"hinge_y": 0.5, "initial_spin": 0.01, "initial_rate": 0.01, "cable_torque_ratio": 1.0}
NAMES = tuple(name for name in vars(ArrayParameters()) if name in ArrayParameters.CONTINUOUS)
# Parameters that are counts, names and switches.
NO_QUANTITIES = tuple(name for name in vars(ArrayParameters()) if name not in ArrayParameters.CONTINUOUS)
FINE, WARNED, STOPPED, REFUSED, SILENT = "fine", "warned", "stopped", "refused", "silent failure"


def scaled(name: str, factor: float = 1.0) -> tuple[float, ...]:
    """Return `factor` times the value that a parameter's decades are counted from, by joint where it has several."""
    value: Any = COUNTED_FROM.get(name, getattr(ArrayParameters(), name))
    return tuple(factor * entry for entry in (value if isinstance(value, tuple) else (float(value),)))


def trial(name: str, factor: float, model: str, duration: float = DURATION) -> Row:
    """Deploy the array with one parameter changed; return a row with the outcome and the library's message."""
    values = scaled(name, factor)
    change: dict[str, Any] = {name: values if len(values) > 1 else values[0]}

    def deployed() -> Simulation:
        # This study wants unusual values.
        warnings.simplefilter("ignore", UnitWarning)
        method = replace(default_integrator(model), max_steps=MAX_STEPS)
        simulation = Simulation(build(ArrayParameters(**change), model), method)
        simulation.advance(duration)
        simulation.check()
        return simulation

    def judge(simulation: Simulation) -> Finding:
        residual, turnover = simulation.energy_book()
        return Finding(Kind.FINE if abs(residual) <= LARGEST_ENERGY_SHARE * turnover else Kind.WRONG, residual)

    cell = listen(deployed, judge)
    ends = {Said.ERROR: STOPPED, Said.WARNING: WARNED, Said.SILENT: FINE if cell.kind == Kind.FINE else SILENT}
    ended = REFUSED if cell.kind == Kind.REFUSED else ends[cell.said]
    row: Row = {"parameter": name, "model": model, "factor": factor, "value": values[0]}
    return {**row, "class": ended, "message": " ".join(cell.message.split())}


def measure(path: Path, tick: Callable[[], object]) -> None:
    """Try all parameters, and write the table."""
    rows = []
    for name in NAMES:
        for model in MODELS:
            for factor in FACTORS:
                rows.append(trial(name, factor, model))
                tick()
    write_table(path, rows, provenance("solar-env study stability --only parameters", duration_s=DURATION))


def page(table: Table) -> str:
    """Format the page of the ranges in Markdown."""
    silent = len(table.where(**{"class": SILENT}).rows)
    rows = [_line(str(name), table.where(parameter=name)) for name in table.values("parameter")]
    columns = ("parameter", "counted from", *(f"fine, {model}" for model in MODELS), "elsewhere, at times that")
    return f"""# Ranges of the parameters

{len(table.rows)} runs, {silent} failures without a word: a parameter far from its default is fine, or the library says
what is wrong, as quoted. Fine is a run that ends with its energy book closed within {LARGEST_ENERGY_SHARE:.0%} of the
energy turned over.

Each parameter goes from a ten thousandth to ten thousand times its default, all others as they are, over
{DURATION:g} s of {" and ".join(f"`{model}`" for model in MODELS)}. Values by joint are changed together; the table
has those of the first. Where the default is zero, or follows from others, another value is in its place
({_words(COUNTED_FROM)}). `solar-env parameters` tells of those that are no quantities
({_words(NO_QUANTITIES)}). Written by `solar-env study stability --only parameters --out solar_env/studies/stability`.

{markdown_table(columns, rows)}
"""


def _words(names: Iterable[str]) -> str:
    return ", ".join(f"`{name}`" for name in names)


def _line(name: str, table: Table) -> list[str]:
    """Return a row of the page: values at which a parameter is fine, and the library's messages elsewhere.

    Messages that differ only in numbers stand there once, with all their factors.
    """
    fine, said = [], dict[str, tuple[str, list[str]]]()
    for model in MODELS:
        values = table.where(model=model, **{"class": FINE}).column("value")
        fine.append(f"{values.min():.3g} to {values.max():.3g}" if len(values) else "-")
    for row in table.rows:
        if row["class"] != FINE:
            what = f"{row['class']}: {shorten(str(row['message']), LONGEST, placeholder=' ...')}".replace("|", "/")
            words = " ".join(word for word in what.split() if not any(map(str.isdigit, word)))
            said.setdefault(words, (what, []))[1].append(f"{row['factor']:g}")
    elsewhere = "; ".join(f"{', '.join(dict.fromkeys(factors))}: {what}" for what, factors in said.values())
    return [f"`{name}`", f"{scaled(name)[0]:g}", *fine, elsewhere or "-"]
