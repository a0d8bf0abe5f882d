"""Verification of the four-bar linkage whose crank turns uniformly: ideal pins over a turn, and one pin with play.

The theory is closed-form kinematics and Newton-Euler inverse dynamics (J. J. Uicker, G. R. Pennock and J. E. Shigley,
Theory of Machines and Mechanisms, Oxford University Press). Complex numbers are vectors of the plane. The closed loop
is differentiated twice. Moments about two pins give the force in the last moving pin, force balances the others.
"""

import cmath
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.integrate import cumulative_simpson

from solar_env.mechanics.arrays.columns import FORCE_X, FORCE_Y
from solar_env.mechanics.integrators.settings import GeneralizedAlpha, Integrator, RungeKutta
from solar_env.mechanics.mechanism.textbook import FOUR_BAR_PINS, STANDARD_GRAVITY, Link, flores_bearing, four_bar
from solar_env.mechanics.running.simulation import Simulation, simulate
from solar_env.mechanics.running.trajectory import Trajectory
from solar_env.verification.checks import Check

# Crank, coupler, rocker, distance of the ground pins [m], rate [rad/s]; the crank's first angle [rad].
FOUR_BAR = (Link.slender(0.10, 0.10), Link(0.35, 0.5, 0.004), Link.slender(0.25, 0.25), 0.40, 2.0 * math.pi)
FOUR_BAR_START = 0.5
RATE = FOUR_BAR[-1]
SAMPLES = 720  # samples per turn, which miss an extreme by at most 5e-6 of its value
NEWTON_EULER = "closed-form kinematics and Newton-Euler inverse dynamics"
GEOMETRY = "play moves a pin by no more than clearance and penetration; closed-form kinematics"
BOOKS = "conservation of energy"


@dataclass(frozen=True)
class LinkageState:
    """Rocker motion, crank moment, pin forces and the effect of play in the linkage at one crank angle."""

    output: float  # rocker's angle [rad]
    output_rate: float  # rocker's rate [rad/s]
    output_acceleration: float  # rocker's angular acceleration [rad/s2]
    crank_moment: float  # moment that keeps the crank turning uniformly [N m]
    pin_forces: tuple[complex, ...]  # force x + i y on the outboard body of each pin, in the mechanism's order [N]
    play_gain: float  # greatest rocker rotation per small displacement of the journal in any single pin [rad/m]


def _moment(arm: complex, force: complex) -> float:
    return (arm.conjugate() * force).imag


def _inertia_moment(link: Link, arm: complex, acceleration: complex, spin_rate: float) -> float:
    """Return the moment [N m], about the point at -`arm` [m] from a link's centroid, that the link's motion requires.

    The `acceleration` is the centroid's minus gravity [m/s2], and `spin_rate` the angular acceleration [rad/s2].
    """
    return link.inertia * spin_rate + _moment(arm, link.mass * acceleration)


def four_bar_state(
    crank: Link, coupler: Link, rocker: Link, ground_length: float, rate: float, angle: float, gravity: float
) -> LinkageState:
    """Return an uncrossed four-bar linkage's rocker motion, crank moment and pin forces at a crank `angle` [rad].

    The crank's `rate` [rad/s] is constant, ground pins are `ground_length` [m] apart, `gravity` [m/s2] acts along -y.
    """
    pin = cmath.rect(crank.length, angle)
    # Freudenstein: the triangle on the diagonal from the rocker's ground pin to the crank pin gives the rocker's angle.
    diagonal = pin - ground_length
    cosine = (rocker.length**2 + abs(diagonal) ** 2 - coupler.length**2) / (2.0 * rocker.length * abs(diagonal))
    rocker_arm = cmath.rect(rocker.length, cmath.phase(diagonal) - math.acos(cosine))
    coupler_arm = ground_length + rocker_arm - pin
    # Loop: crank + coupler - rocker = ground, differentiated once and twice.
    matrix = np.array([[-coupler_arm.imag, rocker_arm.imag], [coupler_arm.real, -rocker_arm.real]])

    def close(vector: complex) -> tuple[float, float]:
        solution = np.linalg.solve(matrix, [-vector.real, -vector.imag])
        return float(solution[0]), float(solution[1])

    coupler_spin, rocker_spin = close(1j * rate * pin)
    pin_acceleration = -(rate**2) * pin
    coupler_spin_rate, rocker_spin_rate = close(
        pin_acceleration - coupler_spin**2 * coupler_arm + rocker_spin**2 * rocker_arm
    )
    # Accelerations minus gravity: weights count as inertia forces.
    up = 1j * gravity
    crank_effective = pin_acceleration / 2.0 + up
    coupler_effective = pin_acceleration + (1j * coupler_spin_rate - coupler_spin**2) * coupler_arm / 2.0 + up
    rocker_effective = (1j * rocker_spin_rate - rocker_spin**2) * rocker_arm / 2.0 + up
    # Moments on the coupler about the crank pin, and on the rocker about its ground pin, give the rocker's pin force.
    moments = [
        -_inertia_moment(coupler, coupler_arm / 2.0, coupler_effective, coupler_spin_rate),
        _inertia_moment(rocker, rocker_arm / 2.0, rocker_effective, rocker_spin_rate),
    ]
    arms = np.array([[-coupler_arm.imag, coupler_arm.real], [-rocker_arm.imag, rocker_arm.real]])
    rocker_force = complex(*np.linalg.solve(arms, moments))
    coupler_force = coupler.mass * coupler_effective + rocker_force
    crank_force = crank.mass * crank_effective + coupler_force
    ground_rocker_force = rocker.mass * rocker_effective - rocker_force
    return LinkageState(
        output=cmath.phase(rocker_arm),
        output_rate=rocker_spin,
        output_acceleration=rocker_spin_rate,
        crank_moment=_moment(pin / 2.0, crank.mass * crank_effective) + _moment(pin, coupler_force),
        pin_forces=(crank_force, coupler_force, rocker_force, ground_rocker_force),
        # Play along the coupler turns the rocker by play / (rocker length * sin(transmission angle)).
        play_gain=coupler.length / abs(_moment(coupler_arm, rocker_arm)),
    )


def rocker_state(turned: float) -> LinkageState:
    """Return the `LinkageState` (rocker motion, crank moment, pin forces) at a crank rotation of `turned` [rad]."""
    return four_bar_state(*FOUR_BAR, FOUR_BAR_START + turned, STANDARD_GRAVITY)


def _figures(simulation: Simulation) -> dict[str, Any]:
    """Return a simulation's present rocker motion, crank moment and pin forces, by name."""
    state, model = simulation.state, simulation.model
    q, v, a = (complex(x[10] - x[8], x[11] - x[9]) for x in state[:3])
    # The drive constrains the component, across the prescribed direction, of a vector of the crank's length.
    moment = -float(state.multipliers[model.drives[0]["row"]] * FOUR_BAR[0].length)
    return {
        "rocker angle": cmath.phase(q),
        "rocker rate": (v / q).imag,
        "rocker angular acceleration": (a / q - (v / q) ** 2).imag,
        "crank moment": moment,
        "pin forces, all components": simulation.joint_loads()[:, [FORCE_X, FORCE_Y]].ravel(),
    }


def four_bar_cycle() -> Iterator[Check]:
    """Check motion and forces of a crank-rocker with ideal pins and gravity, at crank turns of 180 to 540 degrees."""
    step = 2.0 * math.pi / RATE / (8 * SAMPLES)
    # Tolerances: the local tolerance, and ten times (rate * step)^2.
    choices: tuple[tuple[Integrator, float], ...] = (
        (RungeKutta(rtol=1e-9), 1e-9),
        (GeneralizedAlpha(step=step), 10.0 * (RATE * step) ** 2),
    )
    turned = math.pi + 2.0 * math.pi * np.arange(1, SAMPLES + 1) / SAMPLES
    states = [rocker_state(angle) for angle in turned]
    exact = [
        [s.output for s in states],
        [s.output_rate for s in states],
        [s.output_acceleration for s in states],
        [s.crank_moment for s in states],
        [[part for force in s.pin_forces for part in (force.real, force.imag)] for s in states],
    ]
    for integrator, tolerance in choices:
        simulation = Simulation(four_bar(*FOUR_BAR, FOUR_BAR_START), integrator)
        rows = []
        for angle in turned:
            simulation.advance(angle / RATE)
            rows.append(_figures(simulation))
        for name, expected in zip(rows[0], map(np.array, exact), strict=True):
            difference = np.abs(np.array([row[name] for row in rows]) - expected).max() / np.abs(expected).max()
            quantity = f"{name}: greatest difference over the amplitude, {integrator.name}"
            yield Check(quantity, 0.0, difference, tolerance, NEWTON_EULER)


def _work_error(motion: Trajectory, ideal: list[LinkageState]) -> float:
    """Compare the crank's work in each twentieth of the last turn with the work in a linkage without play.

    `ideal` has this linkage's states at the times of `motion`. Return the greatest error divided by the greatest work.
    """
    power = RATE * np.array([state.crank_moment for state in ideal])
    exact = cumulative_simpson(power, x=motion.time, initial=0.0)
    last = slice(len(motion.time) - 1 - SAMPLES, None, SAMPLES // 20)
    expected, obtained = np.diff(exact[last]), np.diff(motion.energies["external_work"][last])
    return float(np.abs(obtained - expected).max() / np.abs(expected).max())


def four_bar_clearance() -> Iterator[Check]:
    """Yield checks of a crank-rocker with play in one pin at a time; the links' weights keep the pins in contact.

    The rocker's angle and the crank's work are compared with a linkage without play; energy must be conserved.
    """
    turn = 2.0 * math.pi / RATE
    for joint, pin in enumerate(FOUR_BAR_PINS):
        for clearance in (1e-4, 1e-5):
            bearings = {pin: replace(flores_bearing(clearance), friction_coefficient=0.0)}
            mechanism = four_bar(*FOUR_BAR, FOUR_BAR_START, clearances=bearings)
            motion = simulate(mechanism, 1.5 * turn, integrator=RungeKutta(rtol=1e-6), output_step=turn / SAMPLES)
            ideal, q = [rocker_state(RATE * time) for time in motion.time], motion.coordinates
            angle = np.arctan2(q[:, 11] - q[:, 9], q[:, 10] - q[:, 8])
            reach = clearance + np.maximum(motion.penetration[:, joint], 0.0).max()
            allowed = reach * np.array([state.play_gain for state in ideal])
            # The allowed deviation is of first order in the play.
            excess = float((np.abs(angle - [state.output for state in ideal]) / allowed).max()) - 1.0
            label = f"pin {pin}, c = {1e3 * clearance:g} mm"
            quantity = f"{label}: excess of the rocker's deviation over what the play allows, relative"
            yield Check(quantity, 0.0, max(excess, 0.0), 0.01, GEOMETRY)
            residual = motion.energy_residual / float(np.abs(motion.energies["external_work"]).max())
            yield Check(f"{label}: energy residual over the crank's greatest work", 0.0, residual, 1e-5, BOOKS)
        # The play is 1e-4 of the crank; without friction, nothing stops the journal from swinging in the play.
        quantity = f"{label}: crank's work in twentieths of a turn"
        yield Check(quantity, 0.0, _work_error(motion, ideal), 0.02, NEWTON_EULER)
