"""Controllers that do not learn, behind Stable-Baselines3's `predict` interface."""

import json
import math
import warnings
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any, Protocol, TypeVar

import gymnasium
import numpy as np

CONFIGS = Path(__file__).parent / "configs"
FALLBACK_MODEL = "rigid-clearance"  # whose parameters a model without its own gets


class Controller(Protocol):
    """What baselines and Stable-Baselines3 models have in common."""

    def predict(
        self,
        observation: np.ndarray,
        state: tuple[np.ndarray, ...] | None = None,
        episode_start: np.ndarray | None = None,
        deterministic: bool = False,
    ) -> tuple[np.ndarray, tuple[np.ndarray, ...] | None]:
        """Map observations (n_obs,) or (n, n_obs) to actions (1,) or (n, 1) in [-1, 1]."""
        ...


class _TorqueLaw(ABC):
    """A memoryless torque law over named observation entries.

    Args:
        observation_names: Name of every entry of an observation, as `env.unwrapped.observation_names`.
        torque_limit: Motor torque of a unit action [N m].

    Raises:
        ValueError: an entry that the law reads is not observed.
    """

    reads: tuple[str, ...] = ()

    def __init__(self, observation_names: Sequence[str], torque_limit: float) -> None:
        names = list(observation_names)
        missing = [name for name in self.reads if name not in names]
        if missing:
            raise ValueError(
                f"{type(self).__name__} reads {', '.join(missing)}, but the observation has only "
                f"{', '.join(names)}; use an array of at least two panels with the 'drive' observation"
            )
        self._column = {name: names.index(name) for name in self.reads}
        self._latch_columns = [column for column, name in enumerate(names) if name.startswith("latched_")]
        self._torque_limit = torque_limit

    @abstractmethod
    def _torque(self, entries: Mapping[str, np.ndarray], all_latched: np.ndarray) -> np.ndarray:
        """Torque (n,) [N m] from named entries (n,); `all_latched` (n,): where every joint has."""

    def predict(
        self,
        observation: np.ndarray,
        state: tuple[np.ndarray, ...] | None = None,
        episode_start: np.ndarray | None = None,
        deterministic: bool = False,
    ) -> tuple[np.ndarray, tuple[np.ndarray, ...] | None]:
        """Map observations (n_obs,) or (n, n_obs) to actions (1,) or (n, 1), clipped to [-1, 1]."""
        batch = np.atleast_2d(np.asarray(observation, dtype=np.float64))
        entries = {name: batch[:, column] for name, column in self._column.items()}
        all_latched = np.all(batch[:, self._latch_columns] > 0.5, axis=1)
        torque = np.broadcast_to(self._torque(entries, all_latched), len(batch))
        action = np.clip(torque / self._torque_limit, -1.0, 1.0).astype(np.float32)[:, None]
        return (action if np.ndim(observation) == 2 else action[0]), state


class Passive(_TorqueLaw):
    """Zero torque: the springs deploy the array alone."""

    def _torque(self, entries: Mapping[str, np.ndarray], all_latched: np.ndarray) -> np.ndarray:
        return np.zeros(len(all_latched))


def _bounded(default: float, lower: float, upper: float) -> Any:
    return field(default=default, metadata={"bounds": (lower, upper)})


@dataclass(frozen=True)
class BrakeParameters:
    """Parameters of `ConstantBrake`; the field metadata hold the range that tuning searches.

    Attributes:
        torque: Magnitude of the torque against the direction of opening [N m].
        onset: Opening of joint 1, in units of its lock angle, from which the torque acts (0: from the start).
    """

    torque: float = _bounded(0.03, 0.0, 0.5)
    onset: float = _bounded(0.0, 0.0, 1.0)


class ConstantBrake(_TorqueLaw):
    """A constant torque against opening until the last joint has latched, then none."""

    reads = ("theta_1",)

    def __init__(
        self,
        observation_names: Sequence[str],
        torque_limit: float,
        parameters: BrakeParameters = BrakeParameters(),
    ) -> None:
        super().__init__(observation_names, torque_limit)
        self.parameters = parameters

    def _torque(self, entries: Mapping[str, np.ndarray], all_latched: np.ndarray) -> np.ndarray:
        acts = (entries["theta_1"] >= self.parameters.onset) & ~all_latched
        return np.where(acts, -self.parameters.torque, 0.0)


@dataclass(frozen=True)
class ServoParameters:
    """Parameters of `VelocityProfileServo`; the field metadata hold the range that tuning searches.

    Opening is measured in units of the lock angle (0 folded, 1 locked), opening rates in 1/s.

    Attributes:
        cruise_rate: Opening rate of the profile far from latching [1/s].
        latch_rate: Opening rate of the profile at the lock angle [1/s].
        deceleration: Deceleration of the profile ahead of the lock angle [1/s^2].
        gain: Torque per opening-rate error [N m s].
        joint_2_weight: Share of joint 2 in the opening that follows the profile; joint 1 has the rest.
        difference_damping: Torque on joint 1 against the opening-rate difference of the joints, which the
            cable loop makes oscillate [N m s].
        postlock_damping: Torque per rate of joint 1 after the last latch [N m s/rad].
    """

    cruise_rate: float = _bounded(0.08, 0.05, 0.2)
    latch_rate: float = _bounded(0.015, 0.001, 0.06)
    deceleration: float = _bounded(0.004, 0.0005, 0.02)
    gain: float = _bounded(20.0, 1.0, 80.0)
    joint_2_weight: float = _bounded(0.5, 0.0, 1.0)
    difference_damping: float = _bounded(0.0, 0.0, 40.0)
    postlock_damping: float = _bounded(0.0, 0.0, 10.0)


class VelocityProfileServo(_TorqueLaw):
    """Feedback that makes the opening follow a velocity profile which slows down towards latching.

    The profile is the one of constant deceleration, ``min(cruise, sqrt(latch^2 + 2 deceleration (1 - s)))``
    over the opening ``s``. Joint 2 reaches its lock angle through the cable loop, not with joint 1; a profile
    for joint 1 alone does not lower the impact, so ``s`` mixes both. The torque is zero on the profile.

    Args:
        observation_names: Name of every entry of an observation.
        torque_limit: Motor torque of a unit action [N m].
        parameters: The profile and the gains.
        lock_angles: Lock angles of joints 1 and 2 [rad].
    """

    reads = ("theta_1", "theta_2", "rate_1", "rate_2")

    def __init__(
        self,
        observation_names: Sequence[str],
        torque_limit: float,
        parameters: ServoParameters = ServoParameters(),
        lock_angles: tuple[float, float] = (math.pi / 2, math.pi),
    ) -> None:
        super().__init__(observation_names, torque_limit)
        self.parameters = parameters
        self._lock_angles = lock_angles

    def reference_rate(self, opening: np.ndarray) -> np.ndarray:
        """Opening rate of the profile [1/s] at an opening in units of the lock angle; any shape."""
        p = self.parameters
        to_go = np.maximum(1.0 - opening, 0.0)
        return np.minimum(p.cruise_rate, np.sqrt(p.latch_rate**2 + 2.0 * p.deceleration * to_go))

    def _torque(self, entries: Mapping[str, np.ndarray], all_latched: np.ndarray) -> np.ndarray:
        p = self.parameters
        rate_1, rate_2 = (entries[f"rate_{i + 1}"] / self._lock_angles[i] for i in range(2))
        opening = entries["theta_1"] + p.joint_2_weight * (entries["theta_2"] - entries["theta_1"])
        rate = rate_1 + p.joint_2_weight * (rate_2 - rate_1)
        deploying = p.gain * (self.reference_rate(opening) - rate) - p.difference_damping * (rate_1 - rate_2)
        return np.where(all_latched, -p.postlock_damping * entries["rate_1"], deploying)


Parameters = TypeVar("Parameters", BrakeParameters, ServoParameters)


def load_parameters(cls: type[Parameters], name: str, env_id: str, model: str) -> Parameters:
    """Tuned parameters of the baseline `name` for a model of `env_id` from ``agents/configs/<name>.json``.

    Parameters are tuned for one model and any number of elements. A model that has none gets those of
    `FALLBACK_MODEL`, with a warning: they deploy the array, but are not the best that the baseline can do there.

    Raises:
        ValueError: the file has no entry for `env_id` that would do, or its keys are not those of `cls`.
    """
    path = CONFIGS / f"{name}.json"
    by_model = (json.loads(path.read_text()) if path.exists() else {}).get(env_id, {})
    command = f"python -m agents.tune --controller {name} --env-id {env_id} --model {model}"
    source = model if model in by_model else FALLBACK_MODEL
    if source not in by_model:
        raise ValueError(f"{path.name} holds no parameters for {env_id!r} with model {model!r}; run: {command}")
    if source != model:
        warnings.warn(
            f"no parameters of {name!r} have been tuned for {model}; it gets those for {source}. To tune: {command}",
            stacklevel=2,
        )
    values = by_model[source]["parameters"]
    expected = {f.name for f in fields(cls)}
    if set(values) != expected:
        raise ValueError(
            f"{path.name}, {env_id!r}, {source!r}: the keys are {sorted(values)}; expected {sorted(expected)}"
        )
    return cls(**values)


BASELINES = ("passive", "brake", "servo", "servo-untuned")


def make_baseline(
    name: str, env: gymnasium.Env, parameters: BrakeParameters | ServoParameters | None = None
) -> _TorqueLaw:
    """The baseline `name` for `env`; "brake" and "servo" take `parameters`.

    By default these are the ones tuned for the environment's own model or, with a warning, those for the rigid
    array with clearance where that model has none; see `load_parameters`.

    Raises:
        ValueError: the name is not one of `BASELINES`, or there are no tuned parameters for the environment.
    """
    unwrapped: Any = env.unwrapped
    signals = (unwrapped.observation_names, unwrapped.task.torque_limit)
    tuned_for = (env.spec.id if env.spec else "", unwrapped.model)
    match name:
        case "passive":
            return Passive(*signals)
        case "brake":
            chosen = parameters or load_parameters(BrakeParameters, "brake", *tuned_for)
            return ConstantBrake(*signals, chosen)  # type: ignore[arg-type]
        case "servo":
            chosen = parameters or load_parameters(ServoParameters, "servo", *tuned_for)
            return VelocityProfileServo(*signals, chosen)  # type: ignore[arg-type]
        case "servo-untuned":
            return VelocityProfileServo(*signals)
        case _:
            raise ValueError(f"no baseline {name!r}; available: {', '.join(BASELINES)}")
