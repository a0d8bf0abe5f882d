"""Verification of a panel in large motion: loaded at an end while free or held, spun up or falling about a hinge.

A turning modal panel is compared with beams of ANCF cable elements, which are not limited to small deflections. These
elements use inertial coordinates and another integration method.
"""

import cmath
import math
import warnings
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from solar_env.mechanics.arrays import columns
from solar_env.mechanics.integrators.settings import RungeKutta
from solar_env.mechanics.mechanism import GROUND, PANEL, STANDARD_GRAVITY, Beam, Joint, Mechanism
from solar_env.mechanics.mechanism.beams import BEAM, flexible_pendulum
from solar_env.mechanics.running.diagnosis import SimulationWarning
from solar_env.mechanics.running.simulation import Simulation
from solar_env.verification.beams.fields import flexible_body, tip
from solar_env.verification.beams.theory import FineBeam, deflected_tip
from solar_env.verification.checks import Check
from solar_env.verification.panels.mechanisms import clamp, dead_force, loose, modal, moved, start

SERIES = "4000 exact modes as functions of time, and the static flexibility of the others"
RANGE = "range of the second order: squared slope over 4 below 1 %"
EXTENSIBLE = "extensible elastica, SciPy's solve_bvp"
LEFT_OUT = "range of the second order: what it leaves out is below 1 %"
# The array's panel, with its retardation time [s].
DAMPED = replace(PANEL, damping=1e-5)
ELEMENTS = 16
# Stability bounds the explicit steps: rtol 1e-6 moves the tip by 1e-12 m.
ANCF = f"{ELEMENTS} ANCF cable elements by the explicit method at rtol 1e-4"

Motion = NDArray[np.complex128]
Torque = Callable[[float], float]


def step_responses() -> Iterator[Check]:
    """Check step responses at a free panel's end: deflection under a force of 1 N, slope under a moment of 1 N m."""
    beam, end = DAMPED, (0.0, 0.0)
    theory = FineBeam(beam)
    for load, (name, quantity) in enumerate((("force", "deflection [m]"), ("moment", "slope [rad]"))):
        for modes in (24, 48):
            joints = (loose(end), dead_force(end, 1j)) if load == 0 else (loose(end),)
            simulation = start(Mechanism((modal(beam, modes),), joints), rtol=1e-8)
            simulation.set_motor_torque(0, float(load))
            for time in (1e-4, 1e-3, 1e-2, 5e-2):
                simulation.advance(time)
                place, turn = moved(simulation, 0)
                expected = float(theory.step_response(load, time)[load])
                # Omitted modes ring by no more than their flexibility, and so do their pseudo-modes. The theory
                # ignores that the panel turns by up to 1e-3 rad; steps have their tolerance.
                omega = theory.frequencies[modes]
                ringing = 2.0 * theory.left_out(modes)[load] * math.exp(-0.5 * beam.damping * omega**2 * time)
                tolerance = float(ringing) + 1e-5 * expected
                label = f"{name}, modes = {modes}: {quantity} at t = {time:g} s"
                yield Check(label, expected, (place.imag, turn)[load], tolerance, SERIES)


def bent(load: float, moment: float) -> tuple[float, float, float]:
    """Bend a clamped modal panel; return its largest end slope [rad], and relative errors of tip deflection and angle.

    The slope is relative to the panel's floating frame, and the errors are relative to the extensible elastica. `load`
    is P L^2 / (E I) for a tip load P across the undeformed panel, `moment` is M L / (E I) for a tip moment M.
    """
    # Critical damping brings the panel to rest within seconds.
    beam = replace(PANEL, damping=0.2)
    length, stiffness = beam.length, beam.bending_stiffness
    tip, force = (length, 0.0), 1j * load * stiffness / length**2
    forces = (dead_force(tip, force),) if load else ()
    simulation = start(Mechanism((modal(beam),), (clamp(100.0 * stiffness / length), loose(tip), *forces)), rtol=1e-4)
    simulation.set_motor_torque(1, moment * stiffness / length)
    simulation.advance(4.0)
    simulation.check()
    place, turn = moved(simulation, 1)
    # The clamp turns a little, which the elastica takes into account.
    root = float(simulation.joint_loads()[0, columns.ANGLE])
    way = cmath.exp(1j * root)
    exact, exact_turn = deflected_tip(beam, force / way, moment * stiffness / length)
    slope, _ = simulation.formulation.modal_range(simulation.model, simulation.state)
    return slope, place.imag / (exact * way).imag - 1.0, turn / (exact_turn + root) - 1.0


def large_deflections() -> Iterator[Check]:
    """Check panels bent by up to 0.5 rad against the elastica, and the warning past the modal theory's valid range."""
    for name, load, moment in (
        *((f"P L^2 / (E I) = {load:g}", load, 0.0) for load in (0.1, 0.2, 0.4, 0.8)),
        *((f"M L / (E I) = {moment:g}", 0.0, moment) for moment in (0.1, 0.5)),
    ):
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always", SimulationWarning)
            slope, deflection, turn = bent(load, moment)
        for quantity, error in (("deflection", deflection), ("turn", turn)):
            # Second-order theory neglects 0.0512 of the squared slope, with any number of foreshortening modes.
            label = f"{name}: relative error of the tip's {quantity}"
            yield Check(label, 0.0, error, 0.052 * slope**2 + 1e-6, EXTENSIBLE)
        yield Check(f"{name}: 1 if the run warns, at a slope of {slope:.2g} rad", slope > 0.2, len(told), 0.0, RANGE)


def _scaled(factor: float, damping: float) -> Beam:
    """Return the default panel with axial and bending stiffness times `factor`, and with the `damping` time [s]."""
    stiffness = (factor * PANEL.axial_stiffness, factor * PANEL.bending_stiffness)
    return replace(PANEL, axial_stiffness=stiffness[0], bending_stiffness=stiffness[1], damping=damping)


def _modal_tip(beam: Beam, times: NDArray[np.float64], gravity: float, torque: Torque) -> tuple[Motion, bool]:
    """Simulate a hinged modal panel; return its tip x + i y [m] at `times` [s], and whether a warning was given.

    The warning tells that bending left the modal theory's range. `torque` [N m] acts at the hinge, gravity along -y.
    """
    hinge = Joint("hinge", GROUND, BEAM, (0.0, 0.0), (0.0, 0.0))
    mechanism = Mechanism((modal(beam),), (hinge, loose((beam.length, 0.0))), gravity=(0.0, -gravity))
    simulation, found = start(mechanism, rtol=1e-5), np.zeros(times.size, complex)
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always", SimulationWarning)
        for k, time in enumerate(times):
            simulation.set_motor_torque(0, torque(simulation.time))
            simulation.advance(float(time))
            place, _ = moved(simulation, 1)
            found[k] = beam.length + place
        simulation.check()
    return found, bool(told)


def _element_tip(beam: Beam, times: NDArray[np.float64], gravity: float, torque: Torque) -> Motion:
    """Simulate a hinged panel of ANCF cable elements; return its tip x + i y [m] at `times` [s]."""
    mechanism = flexible_pendulum(beam, ELEMENTS, gravity=gravity)
    simulation, found = Simulation(mechanism, RungeKutta(rtol=1e-4)), np.zeros(times.size, complex)
    for k, time in enumerate(times):
        simulation.set_motor_torque(0, torque(simulation.time))
        simulation.advance(float(time))
        found[k] = tip(flexible_body(mechanism), simulation.state.q)
    return found


def _rigid(beam: Beam, times: NDArray[np.float64], gravity: float, torque: Torque) -> Motion:
    """Return a hinged rigid panel's tip x + i y [m] at `times` [s]; `torque` is held from one time to the next."""
    inertia, weight = beam.mass * beam.length**2 / 3.0, 0.5 * beam.mass * gravity * beam.length
    state, found, now = np.zeros(2), np.zeros(times.size, complex), 0.0
    for k, time in enumerate(times):
        push = torque(now)

        def slope(_: float, y: NDArray[np.float64], push: float = push) -> tuple[float, float]:
            return float(y[1]), (push - weight * math.cos(y[0])) / inertia

        state = solve_ivp(slope, (now, time), state, "DOP853", rtol=1e-11, atol=1e-12).y[:, -1]
        found[k], now = beam.length * cmath.exp(1j * state[0]), float(time)
    return found


def _turning(
    name: str, beam: Beam, end: float, gravity: float, torque: Torque, error: float, outside: bool = False
) -> Iterator[Check]:
    times = np.linspace(0.0, end, 41)[1:]
    found, told = _modal_tip(beam, times, gravity, torque)
    exact, rigid = (follow(beam, times, gravity, torque) for follow in (_element_tip, _rigid))
    bent = float(np.abs(exact - rigid).max())
    obtained = float(np.abs(found - exact).max()) / bent
    quantity = f"{name}: largest distance of the tip from ANCF's over that from a rigid panel's, {bent * 1e3:.2g} mm"
    yield Check(quantity, 0.0, obtained, error, ANCF)
    yield Check(f"{name}: 1 if the run warns of its range", outside, told, 0.0, LEFT_OUT)


def spin_up() -> Iterator[Check]:
    """Check a spun-up hinged panel's tip path against ANCF elements, and warnings beyond the modal theory's range."""
    inertia, end = PANEL.mass * PANEL.length**2 / 3.0, 0.6
    # The slow spin raises the lowest frequency by up to 1e-3, and its vibration's phase by a few times as much;
    # the fast spin raises the frequency by up to 0.03.
    for rate, error, outside in ((2.0, 1e-2, False), (8.0, 5e-2, True)):

        def torque(time: float, rate: float = rate) -> float:
            return 2.0 * inertia * rate / end * math.sin(math.pi * time / end) ** 2

        yield from _turning(f"spin-up to {rate:g} rad/s", DAMPED, end, 0.0, torque, error, outside)


def falling_pendulum() -> Iterator[Check]:
    """Check tips of falling hinged panels: normal and ten times softer ones against ANCF, a stiff one against rigid."""
    # The spin of up to 4.4 rad/s changes the frequency by up to 5e-3, over four periods.
    yield from _turning("falling panel", DAMPED, 0.5, STANDARD_GRAVITY, lambda _: 0.0, 3e-2)
    soft = _scaled(0.1, DAMPED.damping)
    yield from _turning("falling panel ten times as soft", soft, 0.5, STANDARD_GRAVITY, lambda _: 0.0, 0.1, True)
    fall = (_scaled(1e4, 1e-6), np.linspace(0.0, 1.0, 11)[1:], STANDARD_GRAVITY, lambda _: 0.0)
    obtained = np.abs(_modal_tip(*fall)[0] - _rigid(*fall)).max()
    quantity = "panel ten thousand times as stiff: largest distance of the tip from a rigid one's [m]"
    yield Check(quantity, 0.0, obtained, 1e-4, "SciPy's DOP853 at rtol 1e-11")
