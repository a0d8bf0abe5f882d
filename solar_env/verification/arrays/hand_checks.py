"""Verification case of results that an engineer works out by hand, for arrays with panels of the default size."""

import cmath
import math
from collections.abc import Iterator
from typing import Any

import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.special import ellipk

from solar_env.array import ArrayParameters, build
from solar_env.array.construction import build_deployed
from solar_env.mechanics.analysis.linearization import natural_frequencies
from solar_env.mechanics.integrators.settings import RungeKutta
from solar_env.mechanics.running.simulation import simulate
from solar_env.mechanics.running.trajectory import Trajectory
from solar_env.verification.arrays.theory import Array, folded_angles, make_chain, spring_torques
from solar_env.verification.checks import Check, compare

MASS, LENGTH, THICKNESS = 6.0, 1.5, 0.02  # kg, m, m
CENTRAL = MASS * (LENGTH**2 + THICKNESS**2) / 12.0  # kg m2, about the centre of mass
INERTIA = CENTRAL + MASS * LENGTH**2 / 4.0  # kg m2, about the hinge
QUARTER, LOCKS = math.pi / 2, np.array([0.5, 1.0, 1.0]) * math.pi  # rad
CONSERVED = "energy and momenta are conserved: quadrature of the reduced inertia over the angle"
OSCILLATION = "harmonic oscillation: t = sqrt(I / k) acos(1 - lock angle / preload angle)"
HERTZ = "free flight; H. Hertz, 1881, for bodies that do not turn while they touch"
ARCHARD = "balance of forces and torques; J. F. Archard, J. Appl. Phys. 24 (1953) 981"
BEAM = "characteristic equation of a beam with a torsion spring at one end and a free other end"
SPIN = "angular momentum about the common centre of mass; force of a pin: sum of m omega^2 r beyond it"
WEIGHT = "moments and forces of the weights; physical pendulum: complete elliptic integral, energy"
ALONE: dict[str, Any] = {"panel_count": 1, "body_fixed": True}
LIGHT: dict[str, Any] = {"body_mass": 12.0, "body_inertia": 3.0}
THREE: dict[str, Any] = {"panel_count": 3, "cable_stiffness": 5e3, "cable_preload_force": 1e4}


def _run(duration: float, model: str = "rigid-ideal", step: float = 0.5, **changes: Any) -> Trajectory:
    """Return the trajectory of the default array with `changes`; `step` [s] is output interval and longest step."""
    method = RungeKutta(rtol=1e-10, max_step=step)
    return simulate(build(ArrayParameters(**changes), model), duration, integrator=method, output_step=step)


def swing_time(inertia: float, stiffness: float, preload: float, lock: float) -> float:
    """Return the time [s] in which a spring, relaxed at `preload`, turns a body from rest at 0 to `lock` [rad]."""
    return math.sqrt(inertia / stiffness) * math.acos(1.0 - lock / preload)


def inertias(p: ArrayParameters, angle: float) -> Array:
    """Return the mass matrix [kg m2, kg m, kg] at a root hinge angle [rad] to which all hinge angles are proportional.

    The coordinates are the root angle and, for a free array, the array's rotation and translation.
    """
    chain, ratios = make_chain(p), [row.sign * row.lock_angle / QUARTER for row in p.joints]
    links, ways = len(chain.links), np.zeros((chain.size, 1 if p.body_fixed else 4))
    ways[links - len(ratios) : links, 0] = np.cumsum(ratios)
    ways[:links, 1:2] = 1.0
    ways[links:, 2:] = np.eye(chain.size - links)
    return np.asarray(ways.T @ chain.mass_matrix(folded_angles(p) + angle * ways[:links, 0]) @ ways)


def spring_work(p: ArrayParameters, angles: Array) -> float:
    """Return the work [J] that the torsion springs do from the folded state to given joint angles [rad]."""
    return float(0.5 * angles @ (spring_torques(p, angles) + spring_torques(p, 0.0 * angles)))


def opening(p: ArrayParameters) -> tuple[float, float, float]:
    """Return time [s], root hinge rate [rad/s] and hub angle [rad] at latching, if hinge angles stay proportional."""

    def rates(angle: float) -> Array:
        inverse = np.linalg.inv(inertias(p, angle))[:, 0]  # the whole array has zero momenta
        work = spring_work(p, angle / QUARTER * LOCKS[: p.panel_count])
        return np.asarray(inverse * math.sqrt(2.0 * work / inverse[0]))

    # The rate starts as the square root of the angle, so this square root is the variable of integration.
    time, _ = quad(lambda x: 2.0 * x / rates(x * x)[0], 0.0, math.sqrt(QUARTER), epsabs=1e-12, epsrel=1e-12)
    turn, _ = quad(lambda x: rates(x)[-3:][0] / rates(x)[0], 0.0, QUARTER)
    return float(time), float(rates(QUARTER)[0]), float(turn)


def _openings() -> Iterator[Check]:
    """Check latch times of one panel and of three; for one panel also rate, energies, hub rotation and latch torque."""
    names = ("latch time [s]", "rate then [rad/s]", "energy put in [J]", "kinetic energy [J]", "turn of the hub [rad]")
    for name, changes, rows, tolerance in (
        ("one panel, hub held", ALONE, 4, 1e-10),
        ("one panel, light hub", {**LIGHT, "panel_count": 1, "hinge_y": 0.2}, 5, 1e-10),
        ("three panels, hub held", {**THREE, "body_fixed": True}, 1, 1e-4),  # the cables stretch
        ("three panels, light hub", {**THREE, **LIGHT}, 1, 5e-6),
    ):
        p = ArrayParameters(**changes, spring_preload_angle=(2.0, 3.5)[: changes["panel_count"]])
        time, rate, turn = opening(p)
        motion = simulate(build(p, "rigid-ideal"), time + 0.1, integrator=RungeKutta(rtol=1e-10), output_step=time)
        hub = math.atan2(*(motion.coordinates[1, 2:4] - motion.coordinates[1, :2])[::-1])
        energies = motion.energy_put_in, motion.energies["kinetic"][1]
        obtained = motion.latch_times.max(), motion.latch_rates[0], *energies, hub
        expected = time, rate, 0.05 * 2.0**2, spring_work(p, LOCKS[: p.panel_count]), turn
        figures = list(zip(names, expected, obtained, strict=True))[:rows]
        yield from compare(figures, f"{name}: {{}}", tolerance, CONSERVED, relative=True)
    # The spring still does work while the panel crosses the gap, and until the undamped latch has stopped the panel.
    met = QUARTER + 0.01
    angle = brentq(lambda x: 0.05 * x * (5.0 - x) - 500.0 * (x - met) ** 2, met, met + 0.1, xtol=1e-15)
    peak = _run(8.3, step=1e-4, **ALONE, spring_preload_angle=2.5, latch_damping=0.0).peak_latch_torque[0]
    yield Check("undamped latch: peak torque [N m]", 1e3 * (angle - met), peak, 5e-7, CONSERVED, relative=True)


def _hold_downs() -> Iterator[Check]:
    """Yield checks of latch times: of two panels released in turn, and of a light yoke that carries a panel.

    A hold-down keeps the panel 0.1 rad out of line with the yoke, whose own hinge opens and latches.
    """
    times = _run(
        60.0, body_fixed=True, cable_stiffness=0.0, release_time=(3.0, 20.0), release_after=(0, 1), latch_gap=0.0,
        spring_preload_angle=(2.0, 3.5), latch_stiffness=1e5, latch_damping=1e3, latch_ramp_depth=1e-6,
    ).latch_times  # fmt: skip
    first = 3.0 + swing_time(2.0 * INERTIA, 0.1, 2.0, QUARTER)
    second = first + 20.0 + swing_time(INERTIA, 0.075, 3.5, math.pi)
    figures = [("released after 3 s", first, times[0], 5e-7), ("released 20 s after that", second, times[1], 5e-6)]
    for length in (0.1, 0.05, 0.025):
        motion = _run(
            3.0, body_fixed=True, panel_length=(length, LENGTH), panel_width=(5e-3, 1.0), panel_area_mass=(0.05, 4.0),
            spring_stiffness=(2.0, 0.0), spring_preload_angle=QUARTER, fold_angle=(QUARTER, 0.1), cable_stiffness=0.0,
            release_time=(0.0, 9.0), latch_stiffness=1e5, latch_damping=20.0, latch_ramp_depth=1e-7,
        )  # fmt: skip
        inertia = CENTRAL + MASS * abs(length + cmath.rect(LENGTH / 2.0, 0.1)) ** 2 + 2.5e-4 * length**3 / 3.0
        time = swing_time(inertia, 2.0, QUARTER, QUARTER)  # the hold-down yields a little, which adds 1e-5 of the time
        figures.append((f"on a yoke of {length:g} m", time, motion.latch_times[0], 3e-5))
    limit = float(np.dot([obtained for _, _, obtained, _ in figures[2:]], (1.0, -6.0, 8.0))) / 3.0
    figures.append(("extrapolated to no yoke", swing_time(INERTIA, 2.0, QUARTER, QUARTER), limit, 3e-5))
    yield from compare(figures, "panel {}: latch time [s]", None, OSCILLATION, relative=True)


def _impact() -> Iterator[Check]:
    """Check the first impact in the hinge between a free hub and a free panel: time, speed, peak force and impulse."""
    # Complex vectors: from the hub's centre of mass to the hinge, and from the panel's end to its centre of mass.
    places, spins, gap = np.array([0.5 + 0.2j, -0.5j * LENGTH]), np.array([3e-3, 7e-3]), 1e-3
    contact = _run(
        9.0, "rigid-clearance", **LIGHT, panel_count=1, hinge_y=0.2, spring_stiffness=0.0, initial_spin=spins[0],
        initial_rate=spins[1] - spins[0], clearance=gap, contact_law="hertz", friction_coefficient=0.0,
    ).contacts[0]  # fmt: skip
    start = brentq(lambda t: abs(places @ (1.0 + 1j * spins * t - np.exp(1j * spins * t))) - gap, 1.0, 20.0, xtol=1e-14)
    turned = places * np.exp(1j * spins * start)
    normal = (places * (1.0 + 1j * spins * start) - turned).sum() / gap
    speed = (normal.conjugate() * 1j * spins * (places - turned)).sum().real
    mass = 1.0 / (1.0 / np.array([12.0, MASS]) + (turned.conj() * normal).imag ** 2 / np.array([3.0, CENTRAL])).sum()
    figures = (
        ("time [s]", start, contact["start_s"], 1e-11),
        ("approach speed [m/s]", speed, contact["impact_speed"], 1e-11),
        ("peak force [N]", 7.39e10 * (1.25 * mass * speed**2 / 7.39e10) ** 0.6, contact["peak_force"], 3e-4),
        ("impulse [N s]", 2.0 * mass * speed, contact["impulse"], 3e-4),
    )
    yield from compare(figures, "first impact in the hinge: {}", None, HERTZ, relative=True)


def _wear() -> Iterator[Check]:
    """Check friction, sliding work and wear in a hinge that a constant torque turns steadily against a damper."""
    motion = _run(
        5.0, "rigid-clearance", **ALONE, spring_stiffness=0.0, spring_torque=((0.0, 20.0),), hinge_damping=20.0,
        initial_rate=1.0, fold_angle=5.9, wear_coefficient=1e-13,
    )  # fmt: skip
    radius, arc, work = 0.0102, 2.0 * math.pi / 360.0, motion.sliding_work[:, 0]
    normal = MASS * abs(LENGTH / 2.0 + cmath.rect(2e-4, math.atan(0.15))) / math.hypot(1.0, 0.15)  # N s2
    rate = brentq(lambda x: 20.0 - 20.0 * x - 0.15 * normal * x * x * radius, 0.5, 1.0)
    figures = (
        ("rate [rad/s]", rate, motion.rates[-1, 0], 1e-8),
        ("normal force [N]", normal * rate**2, motion.normal_force[-1, 0], 1e-6),
        ("sliding work of a second, hard surfaces [J]", normal * rate**3 * radius, work[-1] - work[-3], 5e-5),
        ("worn volume of the journal [m3]", 1e-13 * work[-1], motion.wear_journal.sum() * 0.01 * arc, 1e-14),
        ("worn volume of the bearing [m3]", 1e-13 * work[-1], motion.wear_bearing.sum() * radius * arc, 1e-14),
    )
    yield from compare(figures, "hinge that turns steadily: {}", None, ARCHARD, relative=True)


def _deployed() -> Iterator[Check]:
    """Check frequencies of a flexible panel on its latch, and final spin and pin forces of a spinning array."""
    found = natural_frequencies(build_deployed(ArrayParameters(**ALONE), "flexible-ideal:24 elements"))
    bending = 280e6 * THICKNESS**3 / 12.0  # N m2

    def defect(x: float) -> float:
        bent, sheared = math.cos(x) + 1.0 / math.cosh(x), math.sin(x) - math.cos(x) * math.tanh(x)
        return 1e3 * LENGTH / bending * bent - x * sheared

    roots = [brentq(defect, low, low + 3.0, xtol=1e-14) for low in (0.1, 3.1, 6.1)]
    expected = np.square(roots) / (2.0 * math.pi) * math.sqrt(bending / (MASS * LENGTH**3))
    modes = zip("123", expected, found, (1e-7, 3e-6, 3e-5), strict=False)
    yield from compare(modes, "panel on its latch: frequency {} [Hz]", None, BEAM, relative=True)
    changes: dict[str, Any] = {**LIGHT, "hinge_damping": 1.0, "initial_spin": 0.5}
    motion, p = _run(150.0, **changes, latch_gap=0.0, latch_damping=500.0), ArrayParameters(**changes)
    folded, deployed = (1.0 / np.linalg.inv(inertias(p, angle)[1:, 1:])[0, 0] for angle in (0.0, QUARTER))
    spin, places = 0.5 * folded / deployed, np.array([0.5, 1.5]) * LENGTH + 0.5
    pulls = MASS * spin**2 * (places - MASS * places.sum() / (12.0 + 2.0 * MASS))
    side, speed = (complex(*(x[2:4] - x[:2])) for x in (motion.coordinates[-1], motion.velocities[-1]))
    obtained = ((speed / side).imag, *motion.normal_force[-1])
    figures = zip(("spin [rad/s]", "pin 1 [N]", "pin 2 [N]"), (spin, pulls.sum(), pulls[1]), obtained, strict=True)
    yield from compare(figures, "deployed and spinning: {}", 1e-11, SPIN, relative=True)


def _gravity() -> Iterator[Check]:
    """Check one and two panels at rest on latches under lunar gravity, and a panel that swings without a spring."""
    for count in (1, 2):
        motion = _run(
            60.0, panel_count=count, body_fixed=True, gravity=1.62, spring_stiffness=20.0, hinge_damping=10.0,
            spring_preload_angle=(3.5, math.pi)[:count], latch_damping=500.0, cable_stiffness=0.0,
        )  # fmt: skip
        signs, beyond = np.array([1.0, -1.0])[:count], np.arange(count, 0, -1)
        level = np.cos(np.cumsum(signs * (motion.angles[-1] - LOCKS[:count])))
        moments = signs * np.cumsum((1.62 * MASS * LENGTH * level * (beyond - 0.5))[::-1])[::-1]
        figures = zip("12", moments, motion.joint_torque[-1], strict=False)
        yield from compare(figures, f"wing of {count} at rest: hinge {{}} [N m]", 5e-10, WEIGHT, relative=True)
        figures = zip("12", 1.62 * MASS * beyond, motion.normal_force[-1], strict=False)
        yield from compare(figures, f"wing of {count} at rest: pin {{}} [N]", 5e-10, WEIGHT, relative=True)
    swing, moment = 1.5, 9.81 * MASS * LENGTH / 2.0
    period = 4.0 * math.sqrt(INERTIA / moment) * float(ellipk(math.sin(swing / 2.0) ** 2))
    changes = {**ALONE, "spring_stiffness": 0.0, "gravity": 9.81, "gravity_angle": 0.0}
    motion = _run(1.25 * period, **changes, fold_angle=swing, lock_angle=5.0)
    rate = math.sqrt(2.0 * moment * (1.0 - math.cos(swing)) / INERTIA)
    bottom = motion.time[-1] + (swing - motion.angles[-1, 0]) / motion.rates[-1, 0]
    expected = period, rate, MASS * (9.81 + rate**2 * LENGTH / 2.0)
    obtained = bottom / 1.25, motion.rates[-1, 0], motion.normal_force[-1, 0]
    figures = zip(("period [s]", "rate at the bottom [rad/s]", "pin force there [N]"), expected, obtained, strict=True)
    yield from compare(figures, "panel as a pendulum: {}", 5e-11, WEIGHT, relative=True)


def hand_checks() -> Iterator[Check]:
    """Yield all checks of this module, subject by subject."""
    for part in (_openings, _hold_downs, _impact, _wear, _deployed, _gravity):
        yield from part()
