"""Wear carried over: deployments repeated with the worn clearance fed back, as in a campaign of ground tests.

A deployment wears so little that many may pass before the clearance, and with it the motion, has changed: of those that
change no clearance by more than a given share only the first is simulated. Its wear predicts the clearance of the next
one simulated, whose wear corrects it: in between, wear is linear in the number of deployments (Heun's method). What is
fed back is the mean depth round the circumference of bearing and journal together: a clearance of the worn volume,
round as the contact law wants it.
"""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from solar_env.array import ArrayParameters
from solar_env.studies.common.levels import Level
from solar_env.studies.common.tables import Row
from solar_env.support.campaigns import ONE, Workers, each_done

Array = NDArray[np.float64]

FILE = "ground_test.csv"
MODEL = "rigid-clearance"
DURATION = 30.0  # s


@dataclass(frozen=True)
class Deployment:
    """One simulated deployment of the campaign; figures by joint are means over an ensemble.

    Attributes:
        number: of deployments before it.
        clearance: (joints,) [m].
        wear: (joints,) growth of the clearance by this deployment [m].
        wear_error: (joints,) its standard error [m].
        peak_force: (joints,) greatest contact force after the first latching [N].
        peak_force_error: (joints,) its standard error [N].
        repeated: how many deployments this one stands for.
    """

    number: int
    clearance: Array
    wear: Array
    wear_error: Array
    peak_force: Array
    peak_force_error: Array
    repeated: int


def wear_campaign(
    parameters: ArrayParameters, deployments: int, growth: float, members: int, workers: Workers = ONE
) -> Iterator[Deployment]:
    """Simulate a campaign, and yield every simulated deployment.

    Args:
        parameters: of the unworn array.
        deployments: number of deployments in the campaign.
        growth: share of a clearance that may be worn before the next deployment is simulated; 0 simulates every one.
        members: runs of the ensemble that stands for a deployment, 2 or more.
        workers: where the simulations run.

    Raises:
        ValueError: if a number is too small, or `growth` is negative.
        SimulationError: if a run cannot go on.
    """
    if deployments < 1 or members < 2:
        raise ValueError(f"deployments = {deployments} must be at least 1, members = {members} at least 2")
    if not growth >= 0.0:
        raise ValueError(f"growth = {growth!r} must not be negative")
    clearance = np.array(parameters.for_each_joint("clearance"))
    number, repeated, simulated, before = 0, 0, 0, np.zeros_like(clearance)
    while number < deployments:
        worn = replace(parameters, clearance=tuple(clearance.tolist()))
        runs = [(worn, simulated * members + member) for member in range(members)]
        simulated += 1
        done = {own: figure for (_, own), figure in each_done(_deploy, runs, workers)}
        figures = np.array([done[own] for _, own in runs])
        wear, peak_force = figures.mean(axis=0)
        wear_error, force_error = figures.std(axis=0, ddof=1) / math.sqrt(members)
        corrected = clearance + 0.5 * max(repeated - 1, 0) * (wear - before)
        longest = deployments - number
        fastest = float(np.max(wear / clearance))
        repeated = min(longest, max(1, int(growth / fastest))) if fastest > 0.0 else longest
        yield Deployment(number, clearance, wear, wear_error, peak_force, force_error, repeated)
        clearance, before = corrected + repeated * wear, wear
        number += repeated


def clearances_after(campaign: Sequence[Deployment], deployments: int) -> tuple[Array, Array]:
    """(joints,) clearances [m] after a number of deployments, and their standard error from that of the wear [m].

    Raises:
        ValueError: if the campaign is shorter.
    """
    if campaign[-1].number + campaign[-1].repeated < deployments:
        raise ValueError(f"the campaign ends before deployment {deployments}")
    # How often each simulated deployment counts, wear being linear in between.
    weights = np.zeros(len(campaign))
    for k, deployment in enumerate(campaign):
        counted = min(deployment.repeated, max(0, deployments - deployment.number))
        passed_on = 0.5 * counted * (counted - 1) / deployment.repeated if k + 1 < len(campaign) else 0.0
        weights[k] += counted - passed_on
        if passed_on:
            weights[k + 1] += passed_on
    wear = np.array([deployment.wear for deployment in campaign])
    errors = np.array([deployment.wear_error for deployment in campaign])
    return campaign[0].clearance + weights @ wear, np.sqrt(weights**2 @ errors**2)


def as_rows(campaign: Iterable[Deployment], kind: str) -> Iterator[Row]:
    """Rows of a table, joints counted from 1; `kind` tells campaigns apart."""
    for deployment in campaign:
        row: Row = {"kind": kind, "deployment": deployment.number, "repeated": deployment.repeated}
        for joint in range(len(deployment.clearance)):
            row |= {
                f"clearance_{joint + 1}_m": float(deployment.clearance[joint]),
                f"wear_{joint + 1}_m": float(deployment.wear[joint]),
                f"wear_{joint + 1}_m_error": float(deployment.wear_error[joint]),
                f"force_{joint + 1}_N": float(deployment.peak_force[joint]),
                f"force_{joint + 1}_N_error": float(deployment.peak_force_error[joint]),
            }
        yield row


def _deploy(run: tuple[ArrayParameters, int]) -> list[list[float]]:
    """Growth of the clearances [m] and peak forces [N] of one deployment; no two are alike."""
    parameters, number = run
    motion = Level(MODEL).deploy(parameters, number, DURATION, output_step=DURATION)
    growth = motion.wear_bearing.mean(axis=1) + motion.wear_journal.mean(axis=1)
    return [growth.tolist(), motion.postlock_peak_force.tolist()]
