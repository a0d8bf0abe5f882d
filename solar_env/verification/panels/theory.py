"""A free uniform beam whose first end is loaded, by thousands of exact modes and exact functions of time."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.mechanism import Beam
from solar_env.verification.beams.theory import bending_frequencies, bending_wave_numbers

Array = NDArray[np.float64]


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

    @property
    def flexibility(self) -> Array:
        """(2, 2) deflection and slope of the first end by a unit force and moment there, in the mean-axis frame.

        E I w'''' = p, where the inertia of the rigid beam holds the loads.
        """
        scale = np.array([self.beam.length, 1.0])
        unit = np.array([[1.0 / 105.0, -11.0 / 210.0], [-11.0 / 210.0, 13.0 / 35.0]])
        return unit * np.outer(scale, scale) * self.beam.length / self.beam.bending_stiffness

    def step_response(self, load: int, time: float) -> Array:
        """Deflection and slope of the first end a time [s] after a unit force (0) or moment (1) began there."""
        omega, ends = self.frequencies, self.first_end
        decay = 0.5 * self.beam.damping * omega**2
        root = np.sqrt((omega**2 - decay**2).astype(complex))
        # Of the sum and the difference of exponentials, which do not overflow where the mode does not oscillate.
        plus, minus = np.exp((-decay + 1j * root) * time), np.exp((-decay - 1j * root) * time)
        ringing = (0.5 * (plus + minus) + decay * (plus - minus) / (2j * root)).real / omega**2
        arm = np.array([-0.5 * self.beam.length, 1.0])
        rigid = arm * arm[load] * 12.0 / (self.beam.mass * self.beam.length**2)
        rigid[0] += (load == 0) / self.beam.mass
        return rigid * 0.5 * time**2 + self.flexibility[:, load] - ends @ (ends[load] * ringing)

    def left_out(self, kept: int) -> Array:
        """(2,) flexibility of the first end to a force and to a moment there, of the modes above the first `kept`."""
        return np.sum((self.first_end[:, kept:] / self.frequencies[kept:]) ** 2, axis=1)
