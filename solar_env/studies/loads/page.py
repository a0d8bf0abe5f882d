"""The page of an ensemble: the answer, the nominal array in motion, plots, spectra and tables."""

from collections.abc import Sequence

import numpy as np

from solar_env.pictures.page.content import Chart, Line, Page
from solar_env.pictures.style import COLOURS
from solar_env.studies.common.deployment_page import charts_of, motion_of, parameter_table, shown_samples
from solar_env.studies.loads.ensemble import Loads
from solar_env.studies.loads.report import answer, tables
from solar_env.studies.loads.runs import FREQUENCIES, Deployment
from solar_env.studies.loads.statistics import shortened


def loads_page(loads: Loads, nominal: Deployment, wear_limit: float, notes: Sequence[str]) -> Page:
    """The page.

    Args:
        loads: the ensemble.
        nominal: the deployment to look at.
        wear_limit: depth to which deployments are counted [m].
        notes: last lines.
    """
    name = f"Nominal array, {loads.plan.levels[0].name}"
    charts = charts_of({name: nominal.trajectory}) + _hub_charts(nominal) + _spectra(loads)
    motions = [motion_of(nominal.trajectory, name)]
    title = "How hard the hinges and the hub are hit"
    array = parameter_table(loads.plan.array.parameters, loads.plan.array.randomize)
    return Page(title, answer(loads, wear_limit), motions, charts, [*tables(loads), array], notes)


def _hub_charts(nominal: Deployment) -> list[Chart]:
    """Turn of the hub, and the greatest loads on it from each of the moments shown to the next."""
    kept = shown_samples(nominal.trajectory)
    time = nominal.trajectory.time
    turn = np.degrees(nominal.place[kept, 2] - nominal.place[0, 2])
    begins = kept[kept < len(time) - 1]
    greatest = np.maximum.reduceat(nominal.hub_greatest, begins, axis=0)
    return [
        Chart(
            f"The nominal hub turns by up to {np.abs(turn).max():.3g} degrees",
            "time [s]",
            "angle [deg]",
            [Line("hub", time[kept], turn, COLOURS[0])],
        ),
        *(
            Chart(
                f"The nominal hub sees up to {shortened(values.max(), 3)} {unit}",
                "time [s]",
                f"greatest over 50 us [{unit}]",
                [Line(name, time[begins], values, COLOURS[0])],
            )
            for name, unit, values in zip(
                ("force of the root hinge", "torque about its centroid"), ("N", "N m"), greatest.T, strict=True
            )
        ),
    ]


def _spectra(loads: Loads) -> list[Chart]:
    """Mean and greatest of the runs, and the mean of the next finer level."""
    if not loads.hub_spectrum.size:
        return []
    joints = loads.hinge_spectrum.shape[-1]
    hinge = [line for j in range(joints) for line in _spectrum(loads.hinge_spectrum[..., j], f"joint {j + 1}, ", j)]
    greatest = loads.hinge_spectrum[0].mean(axis=0).max(axis=0)
    worst = int(greatest.argmax())
    return [
        Chart(
            f"Shock response of hinge forces (Q = 10): up to {greatest[worst]:.3g} N, at hinge {worst + 1}",
            "natural frequency [Hz]",
            "force [N]",
            hinge,
            False,
            "xy",
        ),
        Chart(
            f"Shock response of the hub (Q = 10): up to {loads.hub_spectrum[0].mean(axis=0).max():.2g} m/s2",
            "natural frequency [Hz]",
            "acceleration [m/s2]",
            _spectrum(loads.hub_spectrum, "", 0),
            False,
            "xy",
        ),
    ]


def _spectrum(spectra: np.ndarray, prefix: str, colour: int) -> list[Line]:
    runs, finer = spectra
    rows = (
        ("mean", runs.mean(axis=0), "solid"),
        ("greatest", runs.max(axis=0), "dot"),
        ("finer level", finer.mean(axis=0), "dash"),
    )
    return [Line(prefix + name, FREQUENCIES, values, COLOURS[colour], dash) for name, values, dash in rows]
