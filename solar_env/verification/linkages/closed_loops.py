"""Cases of closed loops with a prescribed crank and ideal pins: slider-crank and four-bar."""

import cmath
import math
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.arrays.columns import FORCE_X, FORCE_Y
from solar_env.mechanics.integrators.settings import GeneralizedAlpha, Integrator, RungeKutta
from solar_env.mechanics.mechanism.description import Mechanism
from solar_env.mechanics.mechanism.textbook import STANDARD_GRAVITY, Link, four_bar, slider_crank
from solar_env.mechanics.running.simulation import Simulation
from solar_env.verification.checks import Check, compare
from solar_env.verification.linkages.linkage_theory import LinkageState, four_bar_state, slider_crank_state

CRANK, ROD, SLIDER_MASS = Link(0.05, 0.30, 1e-4), Link(0.12, 0.21, 2.5e-4), 0.14
RATE = 5000.0 * 2.0 * math.pi / 60.0  # rad/s
# Crank, coupler, rocker, distance of the ground pins [m], rate [rad/s]; the crank's first angle [rad].
FOUR_BAR = (Link.slender(0.10, 0.10), Link(0.35, 0.5, 0.004), Link.slender(0.25, 0.25), 0.40, 2.0 * math.pi)
FOUR_BAR_START = 0.5
SAMPLES = 720  # per turn; an extreme is missed by at most 5e-6 of its value
NEWTON_EULER = "closed-form kinematics and Newton-Euler inverse dynamics"
FLORES = "closed form for the data of P. Flores, Nonlinear Dyn. 61 (2010) 633, to the digits given"

CRANK_MOMENT, PIN_FORCES = "crank moment", "pin forces, all components"
SLIDER_NAMES = ("slider position", "slider speed", "slider acceleration")
ROCKER_NAMES = ("rocker angle", "rocker rate", "rocker angular acceleration")

# name -> (SAMPLES,) or (SAMPLES, components)
Figures = dict[str, NDArray[np.float64]]


def drive_moment(simulation: Simulation) -> float:
    """Moment of the first drive on its body [N m], from its multiplier."""
    drive = simulation.model.drives[0]
    # The constraint is the component across the prescribed direction, of a vector of the body's length.
    length = simulation.model.bodies[simulation.model.markers[drive["marker"]]["body"]]["length"]
    return -float(simulation.state.multipliers[drive["row"]] * length)


def _turn(
    mechanism: Mechanism, integrator: Integrator, rate: float, read: Callable[[Simulation], dict[str, Any]]
) -> tuple[NDArray[np.float64], Figures]:
    """Crank angles turned through (SAMPLES,) and figures there, over one turn after a first half turn."""
    simulation = Simulation(mechanism, integrator)
    turned = math.pi + 2.0 * math.pi * np.arange(1, SAMPLES + 1) / SAMPLES
    rows = []
    for angle in turned:
        simulation.advance(angle / rate)
        figures = read(simulation) | {CRANK_MOMENT: drive_moment(simulation)}
        figures[PIN_FORCES] = simulation.joint_loads()[:, [FORCE_X, FORCE_Y]].ravel()
        rows.append(figures)
    return turned, {name: np.array([row[name] for row in rows]) for name in rows[0]}


def _compare(
    states: list[LinkageState], names: tuple[str, str, str], figures: Figures, integrator: Integrator, tolerance: float
) -> Iterator[Check]:
    """Greatest difference of every figure over the turn, relative to its greatest magnitude."""
    motion = ([s.output for s in states], [s.output_rate for s in states], [s.output_acceleration for s in states])
    exact: dict[str, Any] = dict(zip(names, motion, strict=True))
    exact[CRANK_MOMENT] = [s.crank_moment for s in states]
    exact[PIN_FORCES] = [[part for force in s.pin_forces for part in (force.real, force.imag)] for s in states]
    for name, obtained in figures.items():
        expected = np.array(exact[name])
        difference = np.abs(obtained - expected).max() / np.abs(expected).max()
        quantity = f"{name}: greatest difference over the amplitude, {integrator.name}"
        yield Check(quantity, 0.0, difference, tolerance, NEWTON_EULER)


def _slider(simulation: Simulation) -> dict[str, Any]:
    state = simulation.state
    return dict(zip(SLIDER_NAMES, (float(x[8]) for x in (state.q, state.v, state.a)), strict=True))


def _rocker(simulation: Simulation) -> dict[str, Any]:
    q, v, a = (complex(x[10] - x[8], x[11] - x[9]) for x in simulation.state[:3])
    # Angle of the rocker's direction and its derivatives.
    spin = (v / q).imag
    return dict(zip(ROCKER_NAMES, (cmath.phase(q), spin, (a / q - (v / q) ** 2).imag), strict=True))


def _integrators(rate: float) -> tuple[tuple[Integrator, float], ...]:
    """Integrators with their tolerances: the local one, and the tenfold of (rate * step)^2."""
    step = 2.0 * math.pi / rate / (8 * SAMPLES)
    return (RungeKutta(rtol=1e-9), 1e-9), (GeneralizedAlpha(step=step), 10.0 * (rate * step) ** 2)


def slider_crank_cycle() -> Iterator[Check]:
    """Flores' slider-crank at 5000 rpm with ideal pins over one turn."""
    for integrator, tolerance in _integrators(RATE):
        turned, figures = _turn(slider_crank(), integrator, RATE, _slider)
        speed, acceleration = figures[SLIDER_NAMES[1]], figures[SLIDER_NAMES[2]]
        moment, axial = figures[CRANK_MOMENT], figures[PIN_FORCES][:, -2]  # x component in the last pin
        extremes = (
            ("least slider acceleration [m/s2]", -19419.4, acceleration.min(), 0.05),
            ("greatest slider acceleration [m/s2]", 9695.9, acceleration.max(), 0.05),
            ("greatest slider speed [m/s]", 28.411, np.abs(speed).max(), 0.0005),
            ("greatest crank moment [N m]", 138.52, moment.max(), 0.005),
            ("least crank moment [N m]", -138.52, moment.min(), 0.005),
            ("greatest axial force between rod and slider [N]", 2718.7, np.abs(axial).max(), 0.05),
        )
        yield from compare(extremes, f"{{}}, {integrator.name}", None, FLORES)
        states = [slider_crank_state(CRANK, ROD, SLIDER_MASS, RATE, angle) for angle in turned]
        yield from _compare(states, SLIDER_NAMES, figures, integrator, tolerance)


def rocker_state(turned: float) -> LinkageState:
    """State of the ideal crank-rocker when its crank has turned by an angle [rad]."""
    return four_bar_state(*FOUR_BAR, FOUR_BAR_START + turned, STANDARD_GRAVITY)


def four_bar_cycle() -> Iterator[Check]:
    """Crank-rocker under gravity with ideal pins over one turn."""
    rate = FOUR_BAR[-1]
    for integrator, tolerance in _integrators(rate):
        turned, figures = _turn(four_bar(*FOUR_BAR, FOUR_BAR_START), integrator, rate, _rocker)
        states = [rocker_state(angle) for angle in turned]
        yield from _compare(states, ROCKER_NAMES, figures, integrator, tolerance)
