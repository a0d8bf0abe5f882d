"""Campaigns of repeated deployments, in which wear enlarges the clearances of later deployments.

Wear is so small that many deployments pass before it changes the clearance and the motion. Successive deployments that
together change no clearance by more than a given fraction form a group, and only the group's first is simulated. Its
wear, times the group's size, predicts the clearance for the next group's first. The wear found there corrects the
clearance: within a group, wear per deployment is taken as linear in the deployment's number (Heun's method). The
clearance grows by the sum of mean wear depths round bearing and journal, and stays round as the contact law requires.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from rich.console import Console

from solar_env.array import ArrayParameters
from solar_env.studies.common.motion import Level
from solar_env.studies.common.tables import Row
from solar_env.support.campaigns import each_done
from solar_env.support.progress import counting_bar

Array = NDArray[np.float64]

FILE = "repeated.csv"
DEPLOYMENTS = 100
MODEL = "rigid-clearance"
DURATION = 30.0  # s
# Archard's k [m2/N]: ten deployments wear like 1e9 deployments at the array's default of 1e-14.
WEAR_COEFFICIENT = 1e-6
GROWTH = 0.05  # fraction of a clearance that may be worn before the next deployment is simulated
MEMBERS = 4  # runs of the ensemble that represents a deployment


@dataclass(frozen=True)
class Deployment:
    """Deployment, simulated by an ensemble of runs. Arrays hold a value per joint; wear and force are mean values."""

    number: int  # number of deployments before this one
    repeated: int  # number of successive deployments that this one represents, itself included
    clearance: Array  # clearance in this deployment [m]
    wear: Array  # growth of the clearance by this deployment [m]
    wear_error: Array  # standard error [m]
    force: Array  # greatest contact force after the first latching [N]
    force_error: Array  # standard error [N]


def measure_repeated(deployments: int, workers: int, console: Console) -> list[Row]:
    """Simulate a campaign of repeated deployments of the default array; return a table row per simulated deployment."""
    parameters, rows = replace(ArrayParameters(), wear_coefficient=WEAR_COEFFICIENT), []
    with counting_bar(console) as bar:
        task = bar.add_task("deployments", total=deployments)
        for deployment in wear_campaign(parameters, deployments, GROWTH, MEMBERS, workers):
            rows.append(row_of(deployment))
            bar.advance(task, deployment.repeated)
    return rows


def wear_campaign(
    parameters: ArrayParameters, deployments: int, growth: float, members: int, workers: int = 1
) -> Iterator[Deployment]:
    """Simulate repeated deployments whose wear enlarges the clearances; yield a `Deployment` for each simulated one.

    It holds the clearances, and means and standard errors of wear and peak force over an ensemble of runs.

    Args:
        parameters: parameters of the unworn array.
        deployments: number of deployments in the campaign.
        growth: fraction of a clearance that may be worn before the next deployment is simulated; 0 simulates every one.
        members: number of runs in the ensemble that represents a deployment, 2 or more.
        workers: number of processes that simulate.
    """
    clearance = np.array(parameters.for_each_joint("clearance"))
    number, repeated, simulated, before = 0, 0, 0, np.zeros_like(clearance)
    while number < deployments:
        worn = replace(parameters, clearance=tuple(clearance.tolist()))
        runs = [(worn, simulated * members + member) for member in range(members)]
        simulated += 1
        done = {drawn: figure for (_, drawn), figure in each_done(_deploy, runs, workers)}
        figures = np.array([done[drawn] for _, drawn in runs])
        wear, force = figures.mean(axis=0)
        wear_error, force_error = figures.std(axis=0, ddof=1) / math.sqrt(members)
        corrected = clearance + 0.5 * max(repeated - 1, 0) * (wear - before)
        repeated, fastest = deployments - number, float(np.max(wear / clearance))
        if fastest > 0.0:
            repeated = min(repeated, max(1, int(growth / fastest)))
        yield Deployment(number, repeated, clearance, wear, wear_error, force, force_error)
        clearance, before = corrected + repeated * wear, wear
        number += repeated


def row_of(deployment: Deployment) -> Row:
    """Return a simulated deployment's table row; column names count joints from 1."""
    row: Row = {"deployment": deployment.number, "repeated": deployment.repeated}
    for joint, clearance in enumerate(deployment.clearance, start=1):
        row[f"clearance_{joint}_m"] = float(clearance)
        for name, unit in (("wear", "m"), ("force", "N")):
            row[f"{name}_{joint}_{unit}"] = float(getattr(deployment, name)[joint - 1])
            row[f"{name}_{joint}_{unit}_error"] = float(getattr(deployment, f"{name}_error")[joint - 1])
    return row


def _deploy(run: tuple[ArrayParameters, int]) -> list[list[float]]:
    """Simulate a run (parameters, ensemble member); return clearance growths [m] and peak forces [N] by joint."""
    parameters, number = run
    motion = Level(MODEL).deploy(parameters, number, DURATION, DURATION)
    growth = motion.wear_bearing.mean(axis=1) + motion.wear_journal.mean(axis=1)
    return [growth.tolist(), motion.postlock_peak_force.tolist()]
