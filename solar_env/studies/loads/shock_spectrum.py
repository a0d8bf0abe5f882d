"""Shock response spectra by the ramp-invariant filter of D. O. Smallwood, "An improved recursive formula for
calculating shock response spectra", Shock and Vibration Bulletin 51 (1981) 211-217.

A shock response spectrum is the greatest response of an oscillator to a history, as a function of the oscillator's
natural frequency. For a base's acceleration it is the greatest acceleration of a mass mounted on the base; for a force
on the mass, the greatest force that the mount passes on. Both have the same transfer function.
"""

import math

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

Array = NDArray[np.float64]

QUALITY = 10.0  # 5 % of critical damping, as is usual in specifications of shocks


def ramp_invariant_filter(frequency: float, rate: float, quality: float = QUALITY) -> tuple[Array, Array]:
    """Return the numerator and denominator (3,) of the digital filter from a load history to an oscillator's response.

    The response to a base's acceleration is the mass's acceleration; to a force on the mass, the force in its mount.
    The filter is exact for histories that are linear between their samples, `rate` per second. `frequency` [Hz] is
    the undamped natural frequency, `quality` 1 / (2 * damping ratio).
    """
    step, damping, omega = 1.0 / rate, 0.5 / quality, 2.0 * math.pi * frequency
    e = math.exp(-damping * omega * step)
    turn = omega * math.sqrt(1.0 - damping**2) * step
    c, s = e * math.cos(turn), e * math.sin(turn) / turn
    return np.array([1.0 - s, 2.0 * (s - c), e * e - s]), np.array([1.0, -2.0 * c, e * e])


class ShockSpectrum:
    """Greatest responses of oscillators to planar vector histories, one per channel, which `add` takes piece by piece.

    The oscillators start at rest. Their natural frequencies (f,) [Hz] must lie below half the sample rate [1/s].
    """

    def __init__(self, frequencies: Array, rate: float, channels: int, quality: float = QUALITY) -> None:
        self._filters = [ramp_invariant_filter(float(frequency), rate, quality) for frequency in frequencies]
        self._memory = np.zeros((len(frequencies), 2, channels, 2))
        self._periods = [math.ceil(rate / float(frequency)) for frequency in frequencies]
        self.peaks = np.zeros((len(frequencies), channels))

    def add(self, history: Array) -> None:
        """Process n >= 1 more samples (n, channels, 2), x and y of forces or accelerations, and update `peaks`."""
        for k in range(len(self._filters)):
            self._add(k, history)

    def finish(self) -> Array:
        """Let each oscillator ring for a period without load; return greatest magnitudes (frequencies, channels)."""
        for k, period in enumerate(self._periods):
            self._add(k, np.zeros((period, *self.peaks.shape[1:], 2)))
        return self.peaks

    def _add(self, k: int, history: Array) -> None:
        response, self._memory[k] = lfilter(*self._filters[k], history, axis=0, zi=self._memory[k])
        self.peaks[k] = np.maximum(self.peaks[k], np.hypot(response[..., 0], response[..., 1]).max(axis=0))
