"""Cases of a panel that turns far: spun up, falling, spinning freely; beside beam elements, which leave out nothing.

The elements are ANCF's, 24 of them: another formulation, in inertial coordinates, by another method.
"""

import cmath
import math
import warnings
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

from solar_env.mechanics.integrators.settings import RungeKutta
from solar_env.mechanics.mechanism.beams import PANEL, Beam, flexible_pendulum, free_beam
from solar_env.mechanics.mechanism.description import GROUND, Joint, Mechanism
from solar_env.mechanics.mechanism.textbook import STANDARD_GRAVITY
from solar_env.mechanics.running.diagnosis import SimulationWarning
from solar_env.mechanics.running.simulation import Simulation
from solar_env.verification.beams.fields import flexible_body, nodes
from solar_env.verification.beams.theory import bending_frequencies
from solar_env.verification.checks import Check
from solar_env.verification.panels.mechanisms import BEAM, loose, modal, moved, start
from solar_env.verification.panels.theory import spin_stiffening

RANGE = "range of the second order: what it leaves out is below 1 %"
RIGID = "SciPy's DOP853 at rtol 1e-11"
RAYLEIGH = "Rayleigh's quotient of the centrifugal tension and of the inertia of the frame"
# Retardation time of the array's panels [s].
HINGED = replace(PANEL, damping=1e-5)
ELEMENTS = 24
# Stability bounds its steps: rtol 1e-6 moves the tip by 1e-12 m.
ANCF = f"{ELEMENTS} ANCF cable elements by the explicit method at rtol 1e-4"

Motion = NDArray[np.complex128]
Torque = Callable[[float], float]


def softened(times: float) -> Beam:
    """The array's panel with an elasticity so many times less."""
    stiffness = (PANEL.axial_stiffness / times, PANEL.bending_stiffness / times)
    return replace(PANEL, axial_stiffness=stiffness[0], bending_stiffness=stiffness[1])


def _modal_tip(beam: Beam, times: NDArray[np.float64], gravity: float, torque: Torque) -> tuple[Motion, bool]:
    """Tip x + i y [m] of a hinged modal panel in its hinge's tangent, and whether the run warned of its range."""
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
    """Tip of the same panel of beam elements."""
    mechanism = flexible_pendulum(beam, ELEMENTS, gravity=gravity)
    simulation, found = Simulation(mechanism, RungeKutta(rtol=1e-4)), np.zeros(times.size, complex)
    for k, time in enumerate(times):
        simulation.set_motor_torque(0, torque(simulation.time))
        simulation.advance(float(time))
        found[k] = nodes(flexible_body(mechanism), simulation.state.q)[0][-1]
    return found


def _rigid(beam: Beam, times: NDArray[np.float64], gravity: float, torque: Torque) -> Motion:
    """Tip of a rigid panel under the same torques, by SciPy."""
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
    yield Check(f"{name}: 1 if the run warns of its range", outside, told, 0.0, RANGE)


def spin_up() -> Iterator[Check]:
    """A hinged panel that a torque turns: bent by the torque, shortened, pulled straight; in its range and outside."""
    inertia, end = PANEL.mass * PANEL.length**2 / 3.0, 0.6
    # The spin raises the lowest frequency by up to 1e-3, and the phase of its vibration by a few times that; the faster
    # one by up to 0.03.
    for rate, error, outside in ((2.0, 1e-2, False), (8.0, 5e-2, True)):

        def torque(time: float, rate: float = rate) -> float:
            return 2.0 * inertia * rate / end * math.sin(math.pi * time / end) ** 2

        yield from _turning(f"spin-up to {rate:g} rad/s", HINGED, end, 0.0, torque, error, outside)


def falling_pendulum() -> Iterator[Check]:
    """A panel that falls about a hinge, from level: beside elements, a soft one too, and a stiff one by a rigid one."""
    # Up to 5e-3 of the frequency, at 4.4 rad/s, over four periods.
    yield from _turning("falling panel", HINGED, 0.5, STANDARD_GRAVITY, lambda _: 0.0, 3e-2)
    soft = replace(softened(10.0), damping=HINGED.damping)
    yield from _turning("falling panel ten times as soft", soft, 0.5, STANDARD_GRAVITY, lambda _: 0.0, 0.1, True)
    stiff, times = replace(softened(1e-4), damping=1e-6), np.linspace(0.0, 1.0, 11)[1:]
    found, _ = _modal_tip(stiff, times, STANDARD_GRAVITY, lambda _: 0.0)
    obtained = np.abs(found - _rigid(stiff, times, STANDARD_GRAVITY, lambda _: 0.0)).max()
    quantity = "panel ten thousand times as stiff: largest distance of the tip from a rigid one's [m]"
    yield Check(quantity, 0.0, obtained, 1e-4, RIGID)


def spinning_frequency(beam: Beam, spin: float, elements: int = ELEMENTS) -> float:
    """Angular frequency [rad/s] of the lowest bending mode of a panel of ANCF elements that spins freely [rad/s].

    It starts straight, with the velocities of that mode; its middle crosses the chord of its ends twice a period.
    """
    mechanism = free_beam(beam, elements, (0.0, -0.5 * spin * beam.length), spin)
    simulation, body = Simulation(mechanism, RungeKutta(rtol=1e-7)), flexible_body(mechanism)
    omega = 2.0 * math.pi * float(bending_frequencies("free-free", beam, 1)[0])
    x = 4.730040744862704
    z, sigma = x * np.linspace(0.0, 1.0, elements + 1), (math.cosh(x) - math.cos(x)) / (math.sinh(x) - math.sin(x))
    speed = 1e-3 * beam.length * omega
    v = simulation.state.v[: 4 * elements + 4].reshape(-1, 4)
    v[:, 1] += speed * (np.cosh(z) + np.cos(z) - sigma * (np.sinh(z) + np.sin(z)))
    v[:, 3] += speed * x / beam.length * (np.sinh(z) - np.sin(z) - sigma * (np.cosh(z) + np.cos(z)))
    simulation.state.clock["acceleration_current"] = 0
    simulation.state.clock["initial_energy"] = simulation.stored_energies().sum()
    times, heights = np.linspace(0.0, 1.2 * 2.0 * math.pi / omega, 150), []
    for time in times:
        simulation.advance(float(time))
        places, _ = nodes(body, simulation.state.q)
        chord = complex(places[-1] - places[0])
        middle = complex(places[elements // 2] - 0.5 * (places[0] + places[-1]))
        heights.append((middle * chord.conjugate()).imag / abs(chord))
    zeros = CubicSpline(times, heights).roots(extrapolate=False)
    zeros = zeros[zeros > 0.1 * math.pi / omega]
    return 2.0 * math.pi / float(zeros[1])


def turning_frame() -> Iterator[Check]:
    """Modal panels leave out the inertia of their turning frame: the frequency that elements have, and they lack."""
    omega = 2.0 * math.pi * float(bending_frequencies("free-free", PANEL, 1)[0])
    stiffening = spin_stiffening()
    for ratio in (0.1, 0.3, 1.0):
        obtained = ((spinning_frequency(PANEL, ratio * omega) / omega) ** 2 - 1.0) / ratio**2
        quantity = f"((frequency of elements / that at rest)^2 - 1) / (spin / frequency)^2 at {ratio:g}"
        yield Check(quantity, stiffening, obtained, 0.01, RAYLEIGH, relative=True)
    for ratio in (0.03, 0.1):
        simulation = start(Mechanism((modal(PANEL, spin=ratio * omega),)))
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always", SimulationWarning)
            simulation.check()
        left_out = stiffening * ratio**2
        obtained = bool(told)
        quantity = f"1 if the run warns where spin leaves out {100.0 * left_out:.2g} % of the stiffness"
        yield Check(quantity, left_out > 0.01, obtained, 0.0, RANGE)
