"""Landings: training episodes that begin where a torque law has brought the array near the latches."""

import warnings
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from stable_baselines3.common.vec_env import VecEnv
from stable_baselines3.common.vec_env.base_vec_env import VecEnvObs, VecEnvStepReturn

from agents.learning.features import APPROACH_BEGINS
from agents.learning.vec_env import LAW_REWARD, NativeVecEnv
from solar_env.environment.episodes import SavedEpisode


class Landing(NamedTuple):
    """An episode that a law has brought near the latches, and its rewards (periods,) from then on, float32."""

    episode: SavedEpisode
    rewards: np.ndarray


def record(venv: VecEnv) -> tuple[list[Landing], np.ndarray]:
    """Record a landing of the law alone in every lane, and all observations (n, entries) of these episodes.

    In the lanes of `venv` an action of zero adds nothing to the law, and rewards are the environment's own.

    Raises:
        ValueError: The law never brings the array near the latches.

    Warns:
        UserWarning: It does not in some of the lanes.
    """
    lanes = venv.num_envs
    driven = venv.get_attr("task", 0)[0].driven_joint
    opening = venv.get_attr("observation_names", 0)[0].index(f"theta_{driven + 1}")
    episodes: list[SavedEpisode | None] = [None] * lanes
    rewards: list[list[float]] = [[] for _ in range(lanes)]
    seen, goes_on = [], np.ones(lanes, dtype=bool)
    observations: Any = venv.reset()
    nothing = np.zeros((lanes, *venv.action_space.shape), dtype=np.float32)  # type: ignore[misc]
    while goes_on.any():
        seen.append(observations[goes_on])
        for lane in np.flatnonzero(goes_on & (observations[:, opening] >= APPROACH_BEGINS)):
            if episodes[lane] is None:
                episodes[lane] = venv.env_method("save_episode", indices=int(lane))[0]
        observations, rewarded, dones, _ = venv.step(nothing)
        for lane in np.flatnonzero(goes_on):
            if episodes[lane] is not None:
                rewards[lane].append(rewarded[lane])
        goes_on &= ~dones
    pairs = zip(episodes, rewards, strict=True)
    found = [Landing(episode, np.array(series, dtype=np.float32)) for episode, series in pairs if episode is not None]
    if not found:
        raise ValueError("the law that the agent adds to does not bring the array near the latches; tune it first")
    if len(found) < lanes:
        warnings.warn(
            f"the law that the agent adds to brings the array near the latches in {len(found)} of {lanes} episodes; "
            "the agent trains on these alone",
            stacklevel=2,
        )
    return found, np.concatenate(seen)


class LandingVecEnv(NativeVecEnv):
    """Episodes that begin with a recorded landing: all of them in a random order, then all again in another.

    An agent that adds to a law only near the latches and beyond has nothing to learn before, which takes half the time
    of a simulation. Episodes go on to their end: the softer an array lands, the more of its cost comes seconds later.

    Landings differ in difficulty: with `LAW_REWARD` in the info of every period the agent can be rewarded by its
    difference from the law in the same landing. As this baseline does not depend on the agent's actions, it makes
    gradients less noisy without a bias (E. Greensmith, P. L. Bartlett, J. Baxter, Variance Reduction Techniques for
    Gradient Estimates in Reinforcement Learning, J. Mach. Learn. Res. 5 (2004) 1471-1530).

    The `landings` were recorded with equal keywords of the environment.
    """

    def __init__(self, num_envs: int, env_id: str, env_kwargs: Mapping[str, Any], landings: Sequence[Landing]) -> None:
        super().__init__(num_envs, env_id, env_kwargs)
        self._landings = landings
        self._generator = np.random.default_rng(0)
        self._order: list[int] = []
        self._present = [landings[0]] * num_envs
        self._periods = np.zeros(num_envs, dtype=np.int64)

    def seed(self, seed: int | None = None) -> Sequence[int | None]:
        """Seed the lanes and the order of the landings."""
        self._generator, self._order = np.random.default_rng(seed), []
        return super().seed(seed)

    def reset(self) -> VecEnvObs:
        """Begin with landings in all lanes."""
        observations: Any = super().reset()
        for lane in range(self.num_envs):
            observations[lane] = self._begin(lane)
        return observations

    def _begin(self, lane: int) -> np.ndarray:
        """Begin the next landing in a lane; returns its observation."""
        if not self._order:
            self._order = self._generator.permutation(len(self._landings)).tolist()
        self._present[lane] = self._landings[self._order.pop()]
        self._periods[lane] = 0
        return self.env.unwrapped.lane(lane).restore_episode(self._present[lane].episode)

    def step_wait(self) -> VecEnvStepReturn:
        """Return the step of the environment, with the next landing where an episode has ended.

        If an episode ends before that of the law did, the rest of the law's rewards is given in its last period.
        """
        observations: Any
        observations, rewards, dones, infos = super().step_wait()
        for lane in range(self.num_envs):
            period, of_law = self._periods[lane], self._present[lane].rewards
            infos[lane][LAW_REWARD] = float(of_law[period : None if dones[lane] else period + 1].sum())
            self._periods[lane] += 1
            if dones[lane]:
                observations[lane] = self._begin(lane)
        return observations, rewards, dones, infos
