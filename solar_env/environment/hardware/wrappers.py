"""Sensors and motors as wrappers for any Gymnasium environment: noise, encoder, delay, lag of the actuator.

They do to single entries what the keyword `hardware` does to all entries of this package's environments (see
`Hardware`). Wrapped in the order of the table `WRAPPERS`, they give the same.
"""

import math
from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Sequence
from typing import Any

import gymnasium
import numpy as np
from gymnasium.utils import RecordConstructorArgs
from numpy.typing import NDArray

from solar_env.environment.actions import as_floats
from solar_env.support.numbers import is_whole_number

Values = NDArray[np.floating]


class _Sensor(gymnasium.ObservationWrapper, RecordConstructorArgs, ABC):
    """Base of the wrappers: changes some entries of a box of floats, and clips them to its bounds."""

    def __init__(self, env: gymnasium.Env, entries: Sequence[int] | None, **given: Any) -> None:
        RecordConstructorArgs.__init__(self, entries=entries, **given)
        super().__init__(env)
        self._box = _box(env.observation_space, "observation")
        size = int(np.prod(self._box.shape))
        self._entries = np.arange(size) if entries is None else np.array(entries, dtype=np.int64).reshape(-1)
        if not np.isin(self._entries, np.arange(size)).all():
            raise ValueError(f"entries = {entries!r} must be indices of the {size} entries of an observation")

    def observation(self, observation: Any) -> Any:
        """The observation as the sensor shows it."""
        shown = np.array(observation)
        shown.reshape(-1)[self._entries] = self._shown(shown.reshape(-1)[self._entries])
        return np.clip(shown, self._box.low, self._box.high)

    @abstractmethod
    def _shown(self, values: Values) -> Values:
        """The entries as the sensor shows them."""


class NoisyObservation(_Sensor):
    """Adds normally distributed noise to observations, drawn from the environment's generator.

    Args:
        env: observes a box of floats.
        deviation: standard deviation in the units of the entries; one for all or one for each.
        entries: indices of the entries, of the flattened observation; None: all.

    Raises:
        ValueError: on construction, for another space, an entry that is not there, or a negative deviation.
    """

    def __init__(
        self, env: gymnasium.Env, deviation: float | Sequence[float], entries: Sequence[int] | None = None
    ) -> None:
        super().__init__(env, entries, deviation=deviation)
        self._deviation = _not_negative("deviation", deviation, self._entries.size)

    def _shown(self, values: Values) -> Values:
        return values + self._deviation * self.np_random.standard_normal(values.size)


class QuantizedObservation(_Sensor):
    """Rounds observations to steps, as an encoder does.

    Args:
        env: observes a box of floats.
        resolution: step in the units of the entries, 0 for none; one for all or one for each.
        entries: indices of the entries, of the flattened observation; None: all.

    Raises:
        ValueError: on construction, for another space, an entry that is not there, or a negative resolution.
    """

    def __init__(
        self, env: gymnasium.Env, resolution: float | Sequence[float], entries: Sequence[int] | None = None
    ) -> None:
        super().__init__(env, entries, resolution=resolution)
        self._resolution = _not_negative("resolution", resolution, self._entries.size)

    def _shown(self, values: Values) -> Values:
        step = np.where(self._resolution > 0.0, self._resolution, 1.0)
        return np.where(self._resolution > 0.0, np.rint(values / step) * step, values)


class LateObservation(_Sensor):
    """Shows observations some steps late; at the beginning of an episode the first one, as if it had lasted.

    Args:
        env: observes a box of floats.
        delay: steps from a measurement to the observation that shows it.
        entries: indices of the entries, of the flattened observation; None: all.

    Raises:
        ValueError: on construction, for another space, an entry that is not there, or a delay that is no whole number.
    """

    def __init__(self, env: gymnasium.Env, delay: int, entries: Sequence[int] | None = None) -> None:
        super().__init__(env, entries, delay=delay)
        if not is_whole_number(delay, 0):
            raise ValueError(f"delay = {delay!r} must be a whole number of steps, at least 0")
        self._line: deque[Values] = deque(maxlen=delay + 1)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Any, dict[str, Any]]:
        """Begin an episode with nothing remembered."""
        self._line.clear()
        return super().reset(seed=seed, options=options)

    def _shown(self, values: Values) -> Values:
        self._line.append(values)
        return self._line[0]


class LaggedAction(gymnasium.ActionWrapper, RecordConstructorArgs):
    """Lets the environment's action follow that of the agent with a lag and a limited rate, as a motor does.

    The lag is of first order. Episodes begin with the action 0, or the one closest to it.

    Args:
        env: acts in a box of floats.
        lag: time constant in steps of the environment, 0 for none.
        largest_change: of the action from one step to the next, in its units.

    Raises:
        ValueError: on construction, for another space, or a value out of range.
    """

    def __init__(self, env: gymnasium.Env, lag: float = 0.0, largest_change: float = math.inf) -> None:
        RecordConstructorArgs.__init__(self, lag=lag, largest_change=largest_change)
        super().__init__(env)
        self._box = _box(env.action_space, "action")
        self._response = -math.expm1(-1.0 / lag) if _not_negative("lag", lag, 1)[0] > 0.0 else 1.0
        if not largest_change > 0.0:
            raise ValueError(f"largest_change = {largest_change!r} must be positive")
        self._change = largest_change
        self._reached = self._at_rest()

    def _at_rest(self) -> Values:
        return np.clip(np.zeros(self._box.shape), self._box.low, self._box.high)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Any, dict[str, Any]]:
        """Begin an episode with a motor at rest."""
        self._reached = self._at_rest()
        return super().reset(seed=seed, options=options)

    def action(self, action: Any) -> Any:
        """The action that the motor reaches within the step."""
        asked = np.clip(as_floats(action), self._box.low, self._box.high)
        change = self._response * (asked - self._reached)
        self._reached = self._reached + np.clip(change, -self._change, self._change)
        return self._reached.astype(self._box.dtype)


# What it models -> wrapper, from the innermost to the outermost.
WRAPPERS: dict[str, type[gymnasium.Wrapper]] = {
    "actuator": LaggedAction,
    "noise": NoisyObservation,
    "encoder": QuantizedObservation,
    "delay": LateObservation,
}


def _box(space: gymnasium.Space[Any], kind: str) -> gymnasium.spaces.Box:
    if not isinstance(space, gymnasium.spaces.Box) or not np.issubdtype(space.dtype, np.floating):
        raise ValueError(f"the {kind} space is {space}; sensors and motors need a Box of floats")
    return space


def _not_negative(name: str, value: float | Sequence[float], size: int) -> Values:
    values = np.asarray(value, dtype=np.float64).reshape(-1)
    if values.size not in (1, size) or not (np.isfinite(values).all() and (values >= 0.0).all()):
        raise ValueError(f"{name} = {value!r} must be finite and not negative, one number or {size}")
    return values
