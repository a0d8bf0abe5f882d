"""Cases of lasting contact: friction creep and wear of a loaded journal, calculated by hand.

A journal pressed by the weight W turns in a fixed bearing. Contact force and weight balance, so that normal force N and
friction T satisfy N^2 + T^2 = W^2; the journal's centre rests at the angle arctan(T / N) off the bottom.
"""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from solar_env.mechanics.arrays.columns import NORMAL, RATE, TANGENTIAL
from solar_env.mechanics.integrators.settings import GeneralizedAlpha, Integrator, RungeKutta
from solar_env.mechanics.joints.laws import PowerLaw, lankarani_damping
from solar_env.mechanics.mechanism.description import Bearing, Body
from solar_env.mechanics.mechanism.textbook import loaded_journal
from solar_env.mechanics.running.simulation import Simulation, simulate
from solar_env.mechanics.running.trajectory import Trajectory
from solar_env.verification.checks import Check, compare

FREE_SPIN = "exact: the centres do not slide, so that the torque accelerates the journal freely"
LOAD, RADIUS, CLEARANCE, STIFFNESS = 10.0, 0.01, 2e-4, 7.39e10  # N, m, m, N/m^1.5
FRICTION = 0.15
SPEED_ZERO, SPEED_FULL = 1e-4, 1e-3
WEAR, WIDTH, BINS = 1e-13, 0.05, 360
STATICS = "balance of forces and moments"
ARCHARD = "J. F. Archard, J. Appl. Phys. 24 (1953) 981: volume = k * force * sliding distance"
RATE_OF_TURNING, TURNS = 20.0, 2  # rad/s, -


def _bearing(sliding: str = "material") -> Bearing:
    return Bearing(
        CLEARANCE,
        RADIUS,
        contact=PowerLaw(STIFFNESS, damping=lankarani_damping(0.5)),
        friction_coefficient=FRICTION,
        friction_speeds=(SPEED_ZERO, SPEED_FULL),
        sliding=sliding,
        wear_coefficient=WEAR,
        width=WIDTH,
    )


def friction_creep() -> Iterator[Check]:
    """A journal turned by a torque below the friction limit creeps where the friction law balances it."""
    integrators: tuple[Integrator, ...] = (RungeKutta(rtol=1e-8), GeneralizedAlpha(step=1e-4))
    for integrator in integrators:
        for share in (0.3, 0.9):
            speed = SPEED_ZERO + (SPEED_FULL - SPEED_ZERO) * share
            # Torque balance: T R = torque; share = T / (cf N).
            normal = LOAD / math.hypot(1.0, share * FRICTION)
            friction = share * FRICTION * normal
            simulation = Simulation(loaded_journal(_bearing(), LOAD), integrator)
            simulation.set_motor_torque(0, friction * RADIUS)
            simulation.advance(3.0)
            loads = simulation.joint_loads()[0]
            figures = (
                ("sliding speed [m/s]", speed, loads[RATE] * RADIUS),
                ("normal force [N]", normal, loads[NORMAL]),
                ("friction force [N]", friction, abs(loads[TANGENTIAL])),
            )
            quantity = f"Ft = {share:g} cf Fn: {{}}, {integrator.name}"
            yield from compare(figures, quantity, 1e-5, f"exact: v0 + (v1 - v0) Ft / (cf Fn); {STATICS}", relative=True)


def sliding_speed_readings() -> Iterator[Check]:
    """With the sliding speed of the joint centres, a journal that spins in its place meets no friction."""
    torque, duration = 0.5 * FRICTION * LOAD * RADIUS, 0.05
    mechanism = loaded_journal(_bearing(sliding="centres"), LOAD)
    simulation = Simulation(mechanism, RungeKutta(rtol=1e-8))
    simulation.set_motor_torque(0, torque)
    simulation.advance(duration)
    journal = mechanism.bodies[0]
    assert isinstance(journal, Body)
    inertia = journal.inertia
    # That of the integrator, whose treatment of a lasting contact measures a rate of change
    obtained = simulation.joint_loads()[0][RATE]
    quantity = "speed of centres: spin after 0.05 s, without friction [rad/s]"
    yield Check(quantity, torque * duration / inertia, obtained, 1e-8, FREE_SPIN, relative=True)


def _worn(housing_angle: float | None = None) -> Trajectory:
    """Motion of a journal that turns at a constant rate, in the ground or in a fixed housing at an angle [rad]."""
    mechanism = loaded_journal(_bearing(), LOAD, math.atan(FRICTION), RATE_OF_TURNING, wear_bins=BINS)
    if housing_angle is not None:
        housing = Body("housing", 1.0, 1.0, 1.0, (0.0, 0.0), angle=housing_angle, fixed=True)
        joint = replace(mechanism.joints[0], inboard=housing.name)
        mechanism = replace(mechanism, bodies=(housing, *mechanism.bodies), joints=(joint,))
    return simulate(mechanism, TURNS * 2.0 * math.pi / RATE_OF_TURNING, integrator=RungeKutta(rtol=1e-8))


def archard_wear() -> Iterator[Check]:
    """Wear of a journal that turns at a constant rate: volumes, depths over the arc of contact, and its place."""
    rate, motion = RATE_OF_TURNING, _worn()
    duration = TURNS * 2.0 * math.pi / rate
    # Steady sliding, beyond the ramp: T = cf N.
    normal = LOAD / math.hypot(1.0, FRICTION)
    volume = WEAR * normal * RADIUS * rate * duration
    bin_arc = 2.0 * math.pi / BINS
    bearing_radius = RADIUS + CLEARANCE
    depth = (normal / STIFFNESS) ** (2.0 / 3.0)
    half_arc = math.acos(CLEARANCE / (CLEARANCE + depth))
    # The arc of contact stays in its place on the bearing: the bin which it covers most wears deepest.
    low = 1.5 * math.pi - math.atan(FRICTION) - half_arc
    high = low + 2.0 * half_arc
    edges = np.arange(BINS + 1) * bin_arc
    covered = np.clip(np.minimum(high, edges[1:]) - np.maximum(low, edges[:-1]), 0.0, None)
    deepest = volume / (WIDTH * bearing_radius * bin_arc) * covered.max() / (2.0 * half_arc)
    figures = (
        ("worn volume of the journal [m3]", volume, motion.wear_journal.sum() * RADIUS * bin_arc * WIDTH, 1e-6),
        ("worn volume of the bearing [m3]", volume, motion.wear_bearing.sum() * bearing_radius * bin_arc * WIDTH, 1e-6),
        ("mean depth on the journal [m]", volume / (2.0 * math.pi * RADIUS * WIDTH), motion.wear_journal.mean(), 1e-6),
        ("deepest bin of the bearing [m]", deepest, motion.wear_bearing.max(), 1e-3),
        ("normal force [N]", normal, motion.normal_force[-1, 0], 1e-5),
        ("sliding work [J]", normal * RADIUS * rate * duration, motion.sliding_work[-1, 0], 1e-6),
        (
            "friction heat [J]",
            FRICTION * normal * RADIUS * rate * duration,
            motion.energies["friction_dissipation"][-1],
            1e-6,
        ),
    )
    yield from compare(figures, "{}", None, ARCHARD, relative=True)
    yield from _places_of_wear("bearing", motion, 0.0, half_arc)
    yield from _places_of_wear("bearing turned by 1 rad", _worn(1.0), 1.0, half_arc)


def _places_of_wear(name: str, motion: Trajectory, angle: float, half_arc: float) -> Iterator[Check]:
    """Where wear falls in the frames of a bearing at `angle` [rad] and of a journal that turns in it."""
    worn, bin_arc = motion.wear_bearing[0], 2.0 * math.pi / BINS
    middles = (np.arange(BINS) + 0.5) * bin_arc
    place = 1.5 * math.pi - math.atan(FRICTION) - angle
    # The two bins that the arc covers in part count at their middles
    obtained = worn @ middles / worn.sum()
    quantity = f"{name}: centroid of its wear [rad]"
    tolerance = bin_arc**2 / (16.0 * half_arc)
    yield Check(quantity, place, obtained, tolerance, f"exact: the line of centres leans by arctan(T / N); {STATICS}")
    obtained = worn[np.abs(middles - place) > half_arc + bin_arc].max()
    yield Check(f"{name}: deepest wear beside the arc of contact [m]", 0.0, obtained, 0.0, "no contact there")
    # A step wears an arc at once
    obtained = motion.wear_journal.max() / motion.wear_journal.mean()
    quantity = f"{name}: deepest over mean wear of the journal that turns in it"
    yield Check(quantity, 1.0, obtained, 0.03, f"every point of it passes the arc of contact {TURNS} times")
