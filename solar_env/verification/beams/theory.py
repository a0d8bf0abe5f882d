"""Theory of slender elastic beams: large static deflections, natural frequencies, steady rotation, sudden end loads.

The beam does not shear. Its moment is E I times the turn per undeformed length, and its axial force is E A times the
strain. A function describes a cantilever along the x axis, clamped at the origin, unless its docstring says otherwise.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import quad, solve_bvp
from scipy.optimize import brentq
from scipy.special import ellipe, ellipeinc, ellipk, ellipkinc

from solar_env.mechanics.mechanism import Beam

Array = NDArray[np.float64]

# Support -> shift of the roots beta L, which lie near (n + shift) pi, and the function that is zero at the roots.
SUPPORTS: dict[str, tuple[float, Callable[[float], float]]] = {
    "clamped-free": (-0.5, lambda x: math.cos(x) + 1.0 / math.cosh(x)),
    "pinned-free": (0.25, lambda x: math.sin(x) - math.tanh(x) * math.cos(x)),
    "free-free": (0.5, lambda x: math.cos(x) - 1.0 / math.cosh(x)),
}

# The falling pendulum of M. Berzeri and A. A. Shabana, J. Sound Vib. 235 (2000) 539, doi:10.1006/jsvi.1999.2935, on
# which two independent methods agreed: time [s] -> tip (x, y) [m], tolerance [m].
FALLING_TIPS = {
    0.2: (1.180, -0.196, 0.005),
    0.4: (0.853, -0.784, 0.005),
    0.6: (-0.335, -1.251, 0.005),
    0.8: (-0.890, -0.817, 0.010),
    1.0: (-1.162, -0.311, 0.010),
}


def tip_load_elastica(load: float) -> tuple[float, float, float]:
    """Compute tip deflection and shortening (per length) and tip angle [rad] under a transverse load P L^2 / (E I).

    The load is dead, and the beam does not extend: K. E. Bisshopp and D. C. Drucker, Q. Appl. Math. 3 (1945) 272.
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


def deflected_tip(beam: Beam, tip_force: complex = 0j, tip_moment: float = 0.0) -> tuple[complex, float]:
    """Solve the extensible elastica under dead tip loads [N, N m]; return the tip x + i y [m] and tip angle [rad]."""

    def slope(_: Array, state: Array) -> Array:
        angle, turn = state[:2]
        local = tip_force * np.exp(-1j * angle)
        stretch = 1.0 + local.real / beam.axial_stiffness
        way = stretch * np.exp(1j * angle)
        return np.array([turn, -stretch * local.imag / beam.bending_stiffness, way.real, way.imag])

    def misfit(root: Array, tip: Array) -> Array:
        return np.array([root[0], root[2], root[3], tip[1] - tip_moment / beam.bending_stiffness])

    s = np.linspace(0.0, beam.length, 100)
    solution = solve_bvp(slope, misfit, s, np.array([0.0 * s, 0.0 * s, s, 0.0 * s]), tol=1e-11, max_nodes=100_000)
    angle, _, x, y = solution.y[:, -1]
    return complex(x, y), float(angle)


def bending_wave_numbers(support: str, count: int) -> Array:
    """Return the lowest (count,) roots beta L of a beam's characteristic equation, ascending, without rigid-body zeros.

    The `support` is "clamped-free", "pinned-free" or "free-free". S. Timoshenko, Vibration Problems in Engineering, 2nd
    ed., 1937, section 54.
    """
    shift, characteristic = SUPPORTS[support]
    x = np.asarray((np.arange(1, count + 1) + shift) * math.pi, dtype=float)
    # Further roots differ from the asymptotic values by less than rounding.
    x[:12] = [brentq(characteristic, near - 0.5, near + 0.5, xtol=1e-14) for near in x[:12]]
    return x


def bending_frequencies(support: str, beam: Beam, count: int) -> Array:
    """Return the lowest (count,) bending frequencies [Hz] of an Euler-Bernoulli beam that is, say, "clamped-free"."""
    wave_numbers = bending_wave_numbers(support, count) / beam.length
    return wave_numbers**2 * math.sqrt(beam.bending_stiffness / beam.linear_density) / (2.0 * math.pi)


def axial_frequencies(support: str, beam: Beam, count: int) -> Array:
    """Return the lowest (count,) axial frequencies [Hz] of a bar, held at one end unless `support` is "free-free"."""
    speed = math.sqrt(beam.axial_stiffness / beam.linear_density)
    quarters = 2.0 * np.arange(1, count + 1) - (0.0 if support == "free-free" else 1.0)
    return np.asarray(quarters * speed / (4.0 * beam.length))


def cubic_element_frequency_error(wave_number: float, element_length: float) -> float:
    """Return the leading relative frequency error of cubic Hermite beam elements with a consistent mass matrix.

    The eigenvalue is too high by a fraction (beta h)^4 / 720: G. Strang and G. Fix, An Analysis of the Finite Element
    Method, 1973, section 6.3.
    """
    return (wave_number * element_length) ** 4 / 1440.0


def spinning_extension(beam: Beam, rate: float) -> float:
    """Return the extension [m] of a straight beam that turns about one end at a constant `rate` [rad/s].

    The position r(s) solves E A r'' = -rho A rate^2 r with r(0) = 0 and r'(length) = 1.
    """
    k = rate * math.sqrt(beam.linear_density / beam.axial_stiffness)
    return math.tan(k * beam.length) / k - beam.length


def spin_up_angle(time: float, rate: float, ramp_time: float) -> tuple[float, float, float]:
    """Return angle, rate and acceleration [rad, rad/s, rad/s2] of a spin-up from rest to `rate`, lasting `ramp_time`.

    J. C. Simo and L. Vu-Quoc, J. Appl. Mech. 53 (1986) 855.
    """
    if time >= ramp_time:
        return rate * (time - 0.5 * ramp_time), rate, 0.0
    phase = 2.0 * math.pi / ramp_time
    scale = rate / ramp_time
    angle = scale * (0.5 * time**2 + (math.cos(phase * time) - 1.0) / phase**2)
    return angle, scale * (time - math.sin(phase * time) / phase), scale * (1.0 - math.cos(phase * time))


def element_deflection_error(load: float, slenderness: float, elements: int) -> float:
    """Compute the leading error (computed - exact) of a cantilever's tip deflection, divided by its length.

    The cantilever has cubic elements and a transverse tip load P. The elements minimize the potential over a smaller
    space. To first order this adds the energy of the fields that they cannot represent. The missing deflection is the
    derivative of this energy with respect to P.

    Let s be the arc length from an element's middle, r(s) the position, kappa the curvature, h the element length.
    Bending: elements have a linear r'', so that the normal component (kappa'' - kappa^3) s^2 / 2 loses its part
    orthogonal to linear functions. The energy per length is E I h^4 / 1440 (kappa'' - kappa^3)^2. Membrane locking: r'
    is quadratic and continuous, so that the stretch kappa kappa' s^3 / 2 keeps a part that vanishes at the nodes. The
    energy per length is E A h^6 / 6720 (kappa kappa')^2.

    Args:
        load: P L^2 / (E I).
        slenderness: E A L^2 / (E I).
        elements: number of elements.
    """

    def energy(load: float) -> float:
        _, _, tip_angle = tip_load_elastica(load)

        def per_angle(angle: float) -> float:
            # kappa' = -load cos(angle), and ds = d(angle) / kappa.
            square = max(2.0 * load * (math.sin(tip_angle) - math.sin(angle)), 0.0)
            bending = (load * math.sin(angle) - square) ** 2 / (1440.0 * elements**4)
            return math.sqrt(square) * (bending + slenderness * (load * math.cos(angle)) ** 2 / (6720.0 * elements**6))

        return float(quad(per_angle, 0.0, tip_angle, epsabs=0.0, epsrel=1e-10)[0])

    step = 1e-3 * load
    return (energy(load - step) - energy(load + step)) / (2.0 * step)


@dataclass(frozen=True)
class FineBeam:
    """A free beam, represented by thousands of bending modes whose motion has a closed form.

    Attributes:
        beam: data of the beam, whose stretch is neglected.
        modes: number of bending modes.
    """

    beam: Beam
    modes: int = 4000

    @property
    def frequencies(self) -> Array:
        """Natural angular frequencies (modes,) of bending [rad/s]."""
        return 2.0 * math.pi * bending_frequencies("free-free", self.beam, self.modes)

    @property
    def first_end(self) -> Array:
        """Deflection and slope (2, modes) of the first end per unit amplitude of the mass-normalised modes."""
        x = bending_wave_numbers("free-free", self.modes)
        low = x[:12]
        sigma = np.ones(self.modes)
        sigma[:12] = (np.cosh(low) - np.cos(low)) / (np.sinh(low) - np.sin(low))
        return np.array([np.full(self.modes, 2.0), -2.0 * sigma * x / self.beam.length]) / math.sqrt(self.beam.mass)

    @property
    def flexibility(self) -> Array:
        """Deflection and slope (2, 2) of the first end under a unit end force and end moment, in the mean-axis frame.

        They follow from E I w'''' = p, where inertia forces of the rigid beam balance the loads.
        """
        scale = np.array([self.beam.length, 1.0])
        unit = np.array([[1.0 / 105.0, -11.0 / 210.0], [-11.0 / 210.0, 13.0 / 35.0]])
        return unit * np.outer(scale, scale) * self.beam.length / self.beam.bending_stiffness

    def step_response(self, load: int, time: float) -> Array:
        """Return the first end's deflection and slope at `time` [s] under unit force (`load` 0) or moment (1) there."""
        omega, ends = self.frequencies, self.first_end
        decay = 0.5 * self.beam.damping * omega**2
        root = np.sqrt((omega**2 - decay**2).astype(complex))
        # Sum and difference of exponentials do not overflow if the mode is overdamped.
        plus, minus = np.exp((-decay + 1j * root) * time), np.exp((-decay - 1j * root) * time)
        ringing = (0.5 * (plus + minus) + decay * (plus - minus) / (2j * root)).real / omega**2
        arm = np.array([-0.5 * self.beam.length, 1.0])
        rigid = arm * arm[load] * 12.0 / (self.beam.mass * self.beam.length**2)
        rigid[0] += (load == 0) / self.beam.mass
        return rigid * 0.5 * time**2 + self.flexibility[:, load] - ends @ (ends[load] * ringing)

    def left_out(self, kept: int) -> Array:
        """Return (2,) deflection per force and slope per moment at the first end, by all modes but the first `kept`."""
        return np.sum((self.first_end[:, kept:] / self.frequencies[kept:]) ** 2, axis=1)
