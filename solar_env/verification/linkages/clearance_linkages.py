"""Cases of linkages with one clearance pin: its play bounds the deviation from the ideal linkage."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import cumulative_simpson

from solar_env.mechanics.integrators.settings import RungeKutta
from solar_env.mechanics.mechanism import textbook
from solar_env.mechanics.mechanism.description import Mechanism
from solar_env.mechanics.running.simulation import simulate
from solar_env.mechanics.running.trajectory import Trajectory
from solar_env.verification.checks import Check
from solar_env.verification.linkages.closed_loops import (
    CRANK,
    FOUR_BAR,
    FOUR_BAR_START,
    RATE,
    ROD,
    SLIDER_MASS,
    rocker_state,
)
from solar_env.verification.linkages.linkage_theory import LinkageState, slider_crank_state

INVERSE_DYNAMICS = "Newton-Euler inverse dynamics of the ideal linkage"
SAMPLES = 720  # per turn
GEOMETRY = "play moves a pin by no more than clearance and penetration; closed-form kinematics"
BOOKS = "conservation of energy"


def _turns(mechanism: Mechanism, rate: float, turns: float) -> Trajectory:
    turn = 2.0 * math.pi / rate
    return simulate(mechanism, turns * turn, integrator=RungeKutta(rtol=1e-6), output_step=turn / SAMPLES)


def _play_used(motion: Trajectory, output: NDArray[np.float64], ideal: Sequence[LinkageState], joint: int) -> float:
    """Greatest deviation of the output in units of what the play of the joint allows at that moment."""
    reach = motion.clearance[joint] + np.maximum(motion.penetration[:, joint], 0.0).max()
    deviation = np.abs(output - np.array([state.output for state in ideal]))
    return float((deviation / (reach * np.array([state.play_gain for state in ideal]))).max())


def _checks(
    name: str, motion: Trajectory, output: NDArray[np.float64], ideal: Sequence[LinkageState], joint: int
) -> Iterator[Check]:
    label = f"{name}, c = {1e3 * motion.clearance[joint]:g} mm"
    # The allowance is of first order in the play
    obtained = max(_play_used(motion, output, ideal, joint) - 1.0, 0.0)
    yield Check(
        f"{label}: excess of the output's deviation over what the play allows, relative", 0.0, obtained, 0.01, GEOMETRY
    )
    obtained = motion.energy_residual / float(np.abs(motion.energies["external_work"]).max())
    yield Check(f"{label}: energy residual over the crank's greatest work", 0.0, obtained, 1e-5, BOOKS)


def slider_crank_clearance() -> Iterator[Check]:
    """Flores' slider-crank at 5000 rpm, each pin in turn with play; impacts all along."""
    for joint, pin in enumerate(textbook.SLIDER_CRANK_PINS):
        for clearance in (5e-4, 5e-5):
            motion = _turns(textbook.slider_crank(clearances={pin: textbook.flores_bearing(clearance)}), RATE, 2.0)
            ideal = [slider_crank_state(CRANK, ROD, SLIDER_MASS, RATE, RATE * time) for time in motion.time]
            yield from _checks(f"pin {pin}", motion, motion.coordinates[:, 8], ideal, joint)


def _work_error(motion: Trajectory, ideal: Sequence[LinkageState], rate: float) -> float:
    """Greatest difference of the crank's work in a twentieth of the last turn, relative to the greatest work.

    Work, since forces ring on in a contact that is hardly damped.
    """
    power = rate * np.array([state.crank_moment for state in ideal])
    exact = cumulative_simpson(power, x=motion.time, initial=0.0)
    last = slice(len(motion.time) - 1 - SAMPLES, None, SAMPLES // 20)
    expected, obtained = np.diff(exact[last]), np.diff(motion.energies["external_work"][last])
    return float(np.abs(obtained - expected).max() / np.abs(expected).max())


def four_bar_clearance() -> Iterator[Check]:
    """Crank-rocker under gravity, each pin in turn with play; the weights keep every pin in contact."""
    rate = FOUR_BAR[-1]
    for joint, pin in enumerate(textbook.FOUR_BAR_PINS):
        for clearance in (1e-4, 1e-5):
            bearings = {pin: replace(textbook.flores_bearing(clearance), friction_coefficient=0.0)}
            mechanism = textbook.four_bar(*FOUR_BAR, FOUR_BAR_START, clearances=bearings)
            motion = _turns(mechanism, rate, 1.5)
            ideal = [rocker_state(rate * time) for time in motion.time]
            q = motion.coordinates
            angle = np.arctan2(q[:, 11] - q[:, 9], q[:, 10] - q[:, 8])
            yield from _checks(f"pin {pin}", motion, angle, ideal, joint)
        # The play is 1e-4 of the crank; the journal keeps swinging in it, for without friction nothing stops it.
        obtained = _work_error(motion, ideal, rate)
        quantity = f"pin {pin}, c = {1e3 * clearance:g} mm: crank's work in twentieths of a turn"
        yield Check(quantity, 0.0, obtained, 0.02, INVERSE_DYNAMICS)
