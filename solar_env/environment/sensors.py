"""What is observed of the exact state: noisy, in steps of an encoder, late, and with what was observed before."""

from collections.abc import Sequence
from copy import deepcopy
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solar_env.environment.hardware import Hardware
from solar_env.environment.task import HISTORY, observation_entries


class Memory(NamedTuple):
    """What the sensors of one lane know: see :class:`Sensors`; the generator is a copy."""

    exact: NDArray[np.float32]
    observed: NDArray[np.float32]
    pipeline: NDArray[np.float32]
    generator: np.random.Generator | None


class Sensors:
    """Turns exact observations, lane by lane, into observed ones.

    Args:
        lanes: how many.
        lock_angles: (joints,) [rad], the units in which angles are observed.
        observation: kind of observation, see ``task.observation_entries``.
        hardware: how imperfect the sensors are.

    Attributes:
        low, high: (entries,) bounds of what is observed.
        exact: (lanes, first entries) float32, what ideal sensors see, without a history; to be written before every
            measurement.
        observed: (lanes, entries) float32, what the controller gets.
    """

    def __init__(self, lanes: int, lock_angles: Sequence[float], observation: str, hardware: Hardware) -> None:
        joints = len(lock_angles)
        entries = observation_entries(joints, observation)
        self.low = np.array([entry.low for entry in entries], dtype=np.float32)
        self.high = np.array([entry.high for entry in entries], dtype=np.float32)
        # Angles, rates and latch switches come first, then the torque, the time and the time since latching.
        self._remembered = np.r_[0 : 2 * joints, 3 * joints]
        self._late = np.r_[0 : 3 * joints, 3 * joints + 2]
        self._history = HISTORY if observation == "history" else 0
        self.present = len(entries) - self._history * self._remembered.size
        self.exact = np.zeros((lanes, self.present), dtype=np.float32)
        self._transparent = hardware.ideal_sensors and not self._history
        self.observed = self.exact if self._transparent else np.zeros((lanes, len(entries)), dtype=np.float32)
        per_angle = 1.0 / np.asarray(lock_angles)
        self._noise = np.concatenate([hardware.angle_noise * per_angle, np.full(joints, hardware.rate_noise)])
        self._step = hardware.encoder_resolution * per_angle
        self._pipeline = np.zeros((lanes, hardware.sensor_delay + 1, self._late.size), dtype=np.float32)
        self._generators: list[np.random.Generator | None] = [None] * lanes

    def begin(self, lanes: NDArray[np.int64], generators: Sequence[np.random.Generator]) -> None:
        """Observe the first state of new episodes in some lanes (k,), as if it had lasted.

        Args:
            lanes: which.
            generators: (k,) of the noise, in this and the following measurements.
        """
        if self._transparent:
            return
        for lane, generator in zip(lanes, generators, strict=True):
            self._generators[lane] = generator
        measured = self._measured(lanes)
        self._pipeline[lanes] = measured[:, np.newaxis, self._late]
        self.observed[lanes] = np.hstack([measured, np.tile(measured[:, self._remembered], self._history)])

    def measure(self, lanes: NDArray[np.int64]) -> None:
        """Observe the present state of some lanes (k,)."""
        if self._transparent:
            return
        measured = self._measured(lanes)
        pipeline = np.concatenate([measured[:, np.newaxis, self._late], self._pipeline[lanes, :-1]], axis=1)
        self._pipeline[lanes] = pipeline
        measured[:, self._late] = pipeline[:, -1]
        shown = [measured]
        if self._history:
            before = self.observed[lanes]
            shown += [before[:, self._remembered], before[:, self.present : -self._remembered.size]]
        self.observed[lanes] = np.hstack(shown)

    def memory(self, lane: int) -> Memory:
        """What a lane needs to go on measuring, and what it shows now."""
        generator = deepcopy(self._generators[lane])
        return Memory(self.exact[lane].copy(), self.observed[lane].copy(), self._pipeline[lane].copy(), generator)

    def check(self, memory: Memory) -> None:
        """Check that a memory is one of sensors like these.

        Raises:
            ValueError: otherwise.
        """
        for name, mine, theirs in (
            ("exact entries", self.exact, memory.exact),
            ("observed entries", self.observed, memory.observed),
            ("delayed measurements", self._pipeline, memory.pipeline),
        ):
            if mine.shape[1:] != theirs.shape:
                raise ValueError(
                    f"the saved episode has {name} of shape {theirs.shape}, these sensors {mine.shape[1:]}: go on "
                    "with it where observation and hardware are the same"
                )

    def recall(self, lane: int, memory: Memory) -> None:
        """Go on in a lane from what :meth:`memory` returned, as often as one likes."""
        self.exact[lane], self.observed[lane], self._pipeline[lane] = memory[:3]
        self._generators[lane] = deepcopy(memory.generator)

    def _measured(self, lanes: NDArray[np.int64]) -> NDArray[np.float32]:
        """(k, first entries) what noise and encoder make of the exact values."""
        measured = self.exact[lanes]
        noisy = self._noise.size
        if self._noise.any():
            for row, lane in enumerate(lanes):
                generator = self._generators[lane]
                assert generator is not None
                measured[row, :noisy] += self._noise * generator.standard_normal(noisy)
        if self._step.all():
            angles = measured[:, : self._step.size]
            measured[:, : self._step.size] = np.rint(angles / self._step) * self._step
        return np.clip(measured, self.low[: self.present], self.high[: self.present])
