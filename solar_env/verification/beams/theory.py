"""Slender elastic beams: large static deflections, natural frequencies, a beam in steady rotation.

The beam does not shear; its moment is E I times the turn per undeformed length, its axial force E A times the
stretch. Quantities are of a cantilever along the x axis, clamped at the origin, unless a function says otherwise.
"""

import cmath
import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, newton
from scipy.special import ellipe, ellipeinc, ellipk, ellipkinc

from solar_env.mechanics.mechanism.beams import Beam

Array = NDArray[np.float64]

# Support -> place of the roots beta L near (n + shift) pi.
SUPPORTS = {"clamped-free": -0.5, "pinned-free": 0.25, "free-free": 0.5}

# The falling pendulum of M. Berzeri and A. A. Shabana, J. Sound Vib. 235 (2000) 539, doi:10.1006/jsvi.1999.2935, as two
# independent methods agreed on it: time [s] -> tip (x, y) [m], tolerance [m].
FALLING_TIPS = {
    0.2: (1.180, -0.196, 0.005),
    0.4: (0.853, -0.784, 0.005),
    0.6: (-0.335, -1.251, 0.005),
    0.8: (-0.890, -0.817, 0.010),
    1.0: (-1.162, -0.311, 0.010),
}


def tip_load_elastica(load: float) -> tuple[float, float, float]:
    """Deflection, shortening (of the length 1) and tip angle [rad] under a transverse dead load P L^2 / (E I).

    Without extension: K. E. Bisshopp and D. C. Drucker, Q. Appl. Math. 3 (1945) 272.
    """
    root = math.sqrt(load)

    def mismatch(angle: float) -> float:
        modulus = 0.5 * (1.0 + math.sin(angle))
        return float(ellipk(modulus) - ellipkinc(math.asin(math.sqrt(0.5 / modulus)), modulus)) - root

    # Linear theory, load / 2, overestimates the angle.
    angle = brentq(mismatch, 1e-9 * load, min(0.5 * load + 1e-3 * load, math.pi / 2 - 1e-12), xtol=1e-15)
    modulus = 0.5 * (1.0 + math.sin(angle))
    start = math.asin(math.sqrt(0.5 / modulus))
    deflection = 1.0 - 2.0 * float(ellipe(modulus) - ellipeinc(start, modulus)) / root
    return deflection, 1.0 - math.sqrt(2.0 * math.sin(angle) / load), float(angle)


def tip_moment_circle(angle: float) -> tuple[float, float]:
    """Tip (x, y), for the length 1, of a beam that a tip moment M L / (E I) = `angle` bends to a circular arc."""
    tip = (cmath.exp(1j * angle) - 1.0) / (1j * angle)
    return tip.real, tip.imag


def deflected_tip(
    beam: Beam, tip_force: complex = 0j, line_load: complex = 0j, tip_moment: float = 0.0
) -> tuple[complex, float]:
    """Tip x + i y [m] and tip angle [rad] of the extensible elastica under dead loads, by shooting.

    The loads are x + i y of a force [N] and of a force per undeformed length [N/m], and a moment [N m].
    """

    def march(root_turn: float, share: float) -> Array:
        def slope(s: float, state: Array) -> tuple[float, ...]:
            angle, turn = state[0], state[1]
            local = share * (tip_force + line_load * (beam.length - s)) * cmath.exp(-1j * angle)
            stretch = 1.0 + local.real / beam.axial_stiffness
            way = stretch * cmath.exp(1j * angle)
            return turn, -stretch * local.imag / beam.bending_stiffness, way.real, way.imag

        start = (0.0, root_turn, 0.0, 0.0)
        return solve_ivp(slope, (0.0, beam.length), start, "DOP853", rtol=1e-12, atol=1e-13).y[:, -1]

    turn = 0.0
    for share in np.linspace(0.1, 1.0, 10):

        def mismatch(root_turn: float, share: float = float(share)) -> float:
            return float(march(root_turn, share)[1]) - share * tip_moment / beam.bending_stiffness

        turn = float(newton(mismatch, turn, x1=turn + 0.1 / beam.length, tol=1e-13, maxiter=100))
    angle, _, x, y = march(turn, 1.0)
    return complex(x, y), float(angle)


def bending_wave_numbers(support: str, count: int) -> Array:
    """(count,) roots beta L of the characteristic equation, ascending, without the rigid-body zeros.

    S. Timoshenko, Vibration Problems in Engineering, 2nd ed., 1937, section 54.

    Raises:
        ValueError: if the support is none of SUPPORTS.
    """
    if support not in SUPPORTS:
        raise ValueError(f"support {support!r} is unknown; choose from {', '.join(SUPPORTS)}")

    x = (np.arange(1, count + 1) + SUPPORTS[support]) * math.pi
    side = 1.0 if support == "clamped-free" else -1.0
    for _ in range(8):  # of Newton's method, down to rounding
        sine, cosine, tanh, sech = np.sin(x), np.cos(x), np.tanh(x), 2.0 * np.exp(-x) / (1.0 + np.exp(-2.0 * x))
        if support == "pinned-free":
            x = x - (sine - tanh * cosine) / (tanh * (sine + tanh * cosine))
        else:
            x = x + (cosine + side * sech) / (sine + side * sech * tanh)
    return np.asarray(x, dtype=float)


def bending_frequencies(support: str, beam: Beam, count: int) -> Array:
    """(count,) natural frequencies [Hz] of an Euler-Bernoulli beam without rotary inertia."""
    wave_numbers = bending_wave_numbers(support, count) / beam.length
    return wave_numbers**2 * math.sqrt(beam.bending_stiffness / beam.linear_density) / (2.0 * math.pi)


def axial_frequencies(support: str, beam: Beam, count: int) -> Array:
    """(count,) natural frequencies [Hz] of a bar that is held at no end (free-free) or at one."""
    speed = math.sqrt(beam.axial_stiffness / beam.linear_density)
    quarters = 2.0 * np.arange(1, count + 1) - (0.0 if support == "free-free" else 1.0)
    return np.asarray(quarters * speed / (4.0 * beam.length))


def cubic_element_frequency_error(wave_number: float, element_length: float) -> float:
    """Leading term of the relative frequency error of cubic Hermite beam elements with a consistent mass matrix.

    The eigenvalue is too high by (beta h)^4 / 720: G. Strang and G. Fix, An Analysis of the Finite Element
    Method, 1973, section 6.3.
    """
    return (wave_number * element_length) ** 4 / 1440.0


def spinning_extension(beam: Beam, rate: float) -> float:
    """How much longer a straight beam is [m] that turns steadily [rad/s] about one end.

    E A r'' = -rho A rate^2 r with r(0) = 0 and r'(length) = 1.
    """
    k = rate * math.sqrt(beam.linear_density / beam.axial_stiffness)
    return math.tan(k * beam.length) / k - beam.length


def spin_up_angle(time: float, rate: float, ramp_time: float) -> tuple[float, float, float]:
    """Angle, rate and acceleration [rad, rad/s, rad/s2] of a smooth spin-up from rest that ends at `ramp_time`.

    J. C. Simo and L. Vu-Quoc, J. Appl. Mech. 53 (1986) 855.
    """
    if time >= ramp_time:
        return rate * (time - 0.5 * ramp_time), rate, 0.0
    phase = 2.0 * math.pi / ramp_time
    scale = rate / ramp_time
    angle = scale * (0.5 * time**2 + (math.cos(phase * time) - 1.0) / phase**2)
    return angle, scale * (time - math.sin(phase * time) / phase), scale * (1.0 - math.cos(phase * time))


def modal_decay_rate(frequency: float, damping: float) -> float:
    """Decay rate [1/s] of a mode of `frequency` [Hz] if the stress has a part modulus * damping * strain rate.

    From m (x'' + damping omega^2 x' + omega^2 x) = 0.
    """
    return 0.5 * damping * (2.0 * math.pi * frequency) ** 2


def spinning_free_beam(beam: Beam, spin: float) -> tuple[float, float]:
    """Steady rate [rad/s] and length [m] of a free beam, set spinning unstretched at `spin`, after its stretch has
    been damped out: its angular momentum is conserved.
    """
    half = 0.5 * beam.length

    def lost(rate: float) -> float:
        k = rate * math.sqrt(beam.linear_density / beam.axial_stiffness)
        # r = sin(k s) / (k cos(k half)); twice the integral of r^2 over a half.
        second = (half - math.sin(2.0 * k * half) / (2.0 * k)) / (k * math.cos(k * half)) ** 2
        return rate * second - spin * beam.length**3 / 12.0

    rate = float(brentq(lost, 0.1 * spin, spin, xtol=1e-13))
    return rate, beam.length + 2.0 * spinning_extension(replace(beam, length=half), rate)


def pinned_lead(length: float, bending_stiffness: float, torque: float) -> float:
    """How far the root of a pinned uniform beam leads [rad] a rigid one under a constant torque on it [N m].

    A uniform angular acceleration a bends it by E I w'' = -rho A a (L^3 / 3 - L^2 s / 2 + s^3 / 6); equal moments of
    momentum turn the root ahead by -integral(rho A s w) / J = (33 / 140) torque L / (E I).
    """
    return 33.0 / 140.0 * torque * length / bending_stiffness


def element_deflection_error(load: float, slenderness: float, elements: int) -> float:
    """Leading error of the tip's deflection w / L of a cantilever of cubic elements under P L^2 / (E I) = `load`.

    The elements minimize the potential over a smaller space. To first order this adds to it the energy of what they
    cannot represent, and the derivative of that by P is the missing deflection. In an element of length h, r'' is
    linear: (kappa'' - kappa^3) s^2 / 2, its normal part, leaves what is orthogonal to linear functions and an energy of
    E I h^4 / 1440 (kappa'' - kappa^3)^2 per length. r' is quadratic and continuous: of the stretch
    kappa kappa' s^3 / 2 it leaves what vanishes at the nodes, E A h^6 / 6720 (kappa kappa')^2: membrane locking.

    Args:
        load: P L^2 / (E I).
        slenderness: E A L^2 / (E I).
        elements: number of elements.
    """

    def energy(load: float) -> float:
        _, _, tip_angle = tip_load_elastica(load)

        def slope(_: float, state: Array) -> tuple[float, float, float]:
            angle, turn, _ = state
            change = -load * math.cos(angle)
            second = load * math.sin(angle) * turn
            bending = (second - turn**3) ** 2 / (1440.0 * elements**4)
            return turn, change, bending + slenderness * (turn * change) ** 2 / (6720.0 * elements**6)

        start = (0.0, math.sqrt(2.0 * load * math.sin(tip_angle)), 0.0)
        return float(solve_ivp(slope, (0.0, 1.0), start, method="DOP853", rtol=1e-11, atol=1e-18).y[2, -1])

    step = 1e-3 * load
    return (energy(load - step) - energy(load + step)) / (2.0 * step)
