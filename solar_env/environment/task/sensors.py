"""Sensors that turn exact values into observations, with noise, encoder steps, delay, and memory of past values."""

from collections.abc import Sequence
from copy import deepcopy
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from solar_env.environment.hardware import Hardware
from solar_env.environment.task.features import Feature
from solar_env.environment.task.observations import LOCK_ANGLE, Entry, channels, measured_for


class Memory(NamedTuple):
    """The state of the sensors in one lane (environment of a batch), with a copy of their random number generator."""

    exact: NDArray[np.float32]
    observed: NDArray[np.float32]
    pipeline: NDArray[np.float32]
    past: NDArray[np.float32]
    generator: np.random.Generator


class Sensors:
    """Sensors of all lanes (environments of a batch), which turn exact values into observations.

    Attributes:
        channels: (measured,) records of all quantities that entries of the observation show, at once or with a delay.
        exact: (lanes, measured) float32, values of ideal sensors; callers write these before every measurement.
        observed: (lanes, entries) float32, observations for the controller.
    """

    def __init__(self, lanes: int, lock_angles: Sequence[float], entries: Sequence[Entry], hardware: Hardware) -> None:
        of_entries = [measured_for(entry) for entry in entries]
        measured = list(dict.fromkeys(of_entries))
        rows, columns = [row for row, _ in measured], {pair: k for k, pair in enumerate(measured)}
        self.channels = channels(measured)
        self._low, self._high = self.channels["low"], self.channels["high"]
        self._shown = np.array([columns[pair] for pair in of_entries])
        self._features = [
            (k, entry.observable, lock_angles[entry.joint])
            for k, entry in enumerate(entries)
            if isinstance(entry.observable, Feature)
        ]
        self._age = np.array([entry.age for entry in entries])
        per_unit = np.array([1.0 / lock_angles[j] if row.unit == LOCK_ANGLE else 1.0 for row, j in measured])
        self._noisy = np.flatnonzero([row.noise is not None for row in rows])
        self._noise = np.array([getattr(hardware, row.noise) for row in rows if row.noise]) * per_unit[self._noisy]
        self._in_steps = np.flatnonzero([row.encoder and hardware.encoder_resolution > 0.0 for row in rows])
        self._step = hardware.encoder_resolution * per_unit[self._in_steps]
        self._late = np.flatnonzero([row.delayed for row in rows])
        self._transparent = hardware.ideal_sensors and not self._age.any() and not self._features
        self.exact = np.zeros((lanes, len(measured)), dtype=np.float32)
        self.observed = self.exact if self._transparent else np.zeros((lanes, len(entries)), dtype=np.float32)
        self._pipeline = np.zeros((lanes, hardware.sensor_delay + 1, self._late.size), dtype=np.float32)
        self._past = np.zeros((lanes, self._age.max() + 1, len(measured)), dtype=np.float32)
        self._arrays = (self.exact, self.observed, self._pipeline, self._past)
        self._generators: list[Any] = [None] * lanes  # NumPy generators; None before the first episode
        self._rate_noise = hardware.rate_noise

    def draw_rate_errors(self, lanes: NDArray[np.int64], counts: Sequence[int], errors: NDArray[np.float64]) -> None:
        """Write to `errors` sampled errors [rad/s] of the rates that rate loops measure in environments `lanes` (k,).

        `counts` (all environments,) are samples per step; `errors` is (all environments, greatest count, motors).
        """
        if self._rate_noise > 0.0:
            for lane in lanes:
                mine = errors[lane, : counts[lane]]
                mine[:] = self._rate_noise * self._generators[lane].standard_normal(mine.shape)

    def begin(self, lanes: NDArray[np.int64], generators: Sequence[np.random.Generator]) -> None:
        """Begin episodes of environments `lanes` (k,), each with its random number generator in `generators` for noise.

        Measure `exact` once. Copies of this measurement stand for all earlier ones, which delayed entries would show.
        """
        for lane, generator in zip(lanes, generators, strict=True):
            self._generators[lane] = generator
        if self._transparent:
            return
        measured = self._measured(lanes)[:, np.newaxis]
        self._pipeline[lanes] = measured[:, :, self._late]
        self._past[lanes] = measured
        self._show(lanes)

    def measure(self, lanes: NDArray[np.int64]) -> None:
        """Compute `observed` of environments `lanes` (k,) from `exact`, with noise, encoder steps and delays."""
        if self._transparent:
            return
        measured = self._measured(lanes)
        newest = measured[:, np.newaxis, self._late]
        self._pipeline[lanes] = np.concatenate([newest, self._pipeline[lanes, :-1]], axis=1)
        measured[:, self._late] = self._pipeline[lanes, -1]
        self._past[lanes] = np.concatenate([measured[:, np.newaxis], self._past[lanes, :-1]], axis=1)
        self._show(lanes)

    def _show(self, lanes: NDArray[np.int64]) -> None:
        """Fill `observed` of environments `lanes` with measurements of age `Entry.age`, or with functions of them."""
        past = self._past[lanes]
        observed = past[:, self._age, self._shown]
        for k, feature, lock_angle in self._features:
            values = feature.function(observed[:, k].astype(np.float64), lock_angle)
            observed[:, k] = np.clip(values, feature.low, feature.high)
        self.observed[lanes] = observed

    def memory(self, lane: int) -> Memory:
        """Return a copy of the sensors' state in a lane (environment), with exact and observed values."""
        exact, observed, pipeline, past = (values[lane].copy() for values in self._arrays)
        return Memory(exact, observed, pipeline, past, deepcopy(self._generators[lane]))

    def recall(self, lane: int, memory: Memory) -> None:
        """Copy `memory`, a state that the method `Sensors.memory` returned, to the sensors of a lane (environment)."""
        for mine, theirs in zip(self._arrays, memory[:4], strict=True):
            mine[lane] = theirs
        if self._generators[lane] is None:
            self._generators[lane] = deepcopy(memory.generator)
        else:  # the same object, from which the lane also draws its next parameters
            self._generators[lane].bit_generator.state = memory.generator.bit_generator.state

    def _measured(self, lanes: NDArray[np.int64]) -> NDArray[np.float32]:
        """Return clipped measurements (k, measured) of environments `lanes` (k,), with noise and encoder steps."""
        measured = self.exact[lanes]
        if self._noise.any():
            for row, lane in enumerate(lanes):
                measured[row, self._noisy] += self._noise * self._generators[lane].standard_normal(self._noisy.size)
        measured[:, self._in_steps] = np.rint(measured[:, self._in_steps] / self._step) * self._step
        return np.clip(measured, self._low, self._high)
