"""Free uniform beams and bars whose ends are loaded: flexibility in closed form, fine series, spin.

Nothing here shares code with the engine: series have thousands of exact modes and exact functions of time.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import NDArray

from solar_env.mechanics.mechanism.beams import Beam
from solar_env.verification.beams.theory import bending_frequencies, bending_wave_numbers

Array = NDArray[np.float64]


def bending_flexibility(length: float, stiffness: float) -> Array:
    """(4, 4) deflection [m] and slope [rad] at both ends by a unit force and moment at each, in the mean-axis frame.

    The loads are held by the inertia of a uniform beam: E I w'''' = -rho A (a + alpha s), w free of mean and mean turn.

    Args:
        length: [m].
        stiffness: E I [N m2].
    """
    x = Polynomial([0.0, 1.0])

    def deflection(shear: float, moment: float, inertia: Polynomial) -> Polynomial:
        w = inertia.integ(4) + shear * x**3 / 6.0 + moment * x**2 / 2.0
        for weight in (Polynomial([1.0]), x - 0.5):
            product, square = (w * weight).integ(), (weight * weight).integ()
            w = w - weight * (product(1.0) - product(0.0)) / (square(1.0) - square(0.0))
        return w

    # Of a beam of length 1 with E I = 1, loaded at x = 0.
    by_force = deflection(1.0, 0.0, -(4.0 - 6.0 * x))
    by_moment = deflection(0.0, -1.0, -12.0 * (x - 0.5))
    columns = []
    for w, other in ((by_force, 1.0), (by_moment, -1.0)):
        own = [w(0.0), w.deriv()(0.0), w(1.0), w.deriv()(1.0)]
        # The same load at the other end is the mirror image; slopes change sign, and moments do.
        mirrored = [w(1.0), -w.deriv()(1.0), w(0.0), -w.deriv()(0.0)]
        columns += [own, [other * value for value in mirrored]]
    unit = np.array([columns[0], columns[2], columns[1], columns[3]]).T
    scale = np.array([length, 1.0, length, 1.0])
    return unit * np.outer(scale, scale) * length / stiffness


def axial_flexibility(length: float, stiffness: float) -> Array:
    """(2, 2) displacement [m] of both ends of a free bar by a unit force at each, about the centre of mass.

    Args:
        length: [m].
        stiffness: E A [N].
    """
    return np.array([[1.0 / 3.0, -1.0 / 6.0], [-1.0 / 6.0, 1.0 / 3.0]]) * length / stiffness


@dataclass(frozen=True)
class FineBeam:
    """A free beam by thousands of modes, each a function of time in closed form.

    Attributes:
        beam: its data; it does not stretch.
        modes: number of bending modes.
    """

    beam: Beam
    modes: int = 4000

    @property
    def frequencies(self) -> Array:
        """(modes,) natural frequencies of bending [rad/s]."""
        return 2.0 * math.pi * bending_frequencies("free-free", self.beam, self.modes)

    @property
    def first_end(self) -> Array:
        """(2, modes) deflection and slope of the first end by the unit amplitude of mass-normalised modes."""
        x = bending_wave_numbers("free-free", self.modes)
        low = x[:12]
        sigma = np.ones(self.modes)
        sigma[:12] = (np.cosh(low) - np.cos(low)) / (np.sinh(low) - np.sin(low))
        return np.array([np.full(self.modes, 2.0), -2.0 * sigma * x / self.beam.length]) / math.sqrt(self.beam.mass)

    def step_response(self, load: int, time: float) -> tuple[Array, Array]:
        """Deflection and slope of the first end, and their rates, at a time [s] after a unit load began to act there.

        Args:
            load: 0 for the force, 1 for the moment.
            time: [s].
        """
        omega, ends = self.frequencies, self.first_end
        decay = 0.5 * self.beam.damping * omega**2
        root = np.sqrt((omega**2 - decay**2).astype(complex))
        # Of the sum and the difference of exponentials, which do not overflow where the mode does not oscillate.
        plus, minus = np.exp((-decay + 1j * root) * time), np.exp((-decay - 1j * root) * time)
        sine = ((plus - minus) / (2j * root)).real
        ringing = ((0.5 * (plus + minus)).real + decay * sine) / omega**2
        still = bending_flexibility(self.beam.length, self.beam.bending_stiffness)[:2, load]
        inertia = self.beam.mass * self.beam.length**2 / 12.0
        arm = np.array([-0.5 * self.beam.length, 1.0])
        rigid = np.array([1.0 if load == 0 else 0.0, 0.0]) / self.beam.mass + arm * arm[load] / inertia
        return rigid * 0.5 * time**2 + still - ends @ (ends[load] * ringing), rigid * time + ends @ (ends[load] * sine)

    def left_out(self, kept: int) -> Array:
        """(2,) flexibility of the first end to a force and to a moment there, of the modes above the first `kept`."""
        return np.sum((self.first_end[:, kept:] / self.frequencies[kept:]) ** 2, axis=1)


def spin_stiffening() -> float:
    """Share c by which a steady spin raises the squared frequency of a free beam's lowest mode, c spin^2.

    Rayleigh's quotient of the centrifugal tension rho A spin^2 (L^2 / 4 - s^2) / 2 on the slopes, less one for the
    inertia of the turning frame.
    """
    x = float(bending_wave_numbers("free-free", 1)[0])
    # The mode is even about its middle: cosh(x/2) cos(x s) + cos(x/2) cosh(x s), -1/2 < s < 1/2.
    s, weights = np.polynomial.legendre.leggauss(60)
    s, weights = 0.5 * s, 0.5 * weights
    shape = math.cosh(0.5 * x) * np.cos(x * s) + math.cos(0.5 * x) * np.cosh(x * s)
    slope = x * (-math.cosh(0.5 * x) * np.sin(x * s) + math.cos(0.5 * x) * np.sinh(x * s))
    return float(weights @ (0.5 * (0.25 - s**2) * slope**2) / (weights @ shape**2)) - 1.0
