"""Adapter that gives the native vector environment the interface of Stable-Baselines3."""

from collections.abc import Mapping, Sequence
from typing import Any

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode
from gymnasium.wrappers.vector import DictInfoToList
from stable_baselines3.common.vec_env import VecEnv
from stable_baselines3.common.vec_env.base_vec_env import VecEnvIndices, VecEnvObs, VecEnvStepReturn

from solar_env.environment.episodes import Info
from solar_env.environment.registration import DEPLOY


class NativeVecEnv(VecEnv):
    """A vector environment for Stable-Baselines3 in one process; its threads advance the environments in compiled code.

    The end of an episode is reported as by `DummyVecEnv`: the episode's last info has `terminal_observation` and
    `TimeLimit.truncated`, and the returned observation is already the first of the next episode. With equal episodes,
    seeds and actions, all returned values equal `DummyVecEnv`'s results bit for bit.

    Args:
        num_envs: Number of environments, here called lanes.
        env_id: Environment id.
        env_kwargs: Keywords of the vector environment, such as `num_threads`, and of the single environment.
        first_seed: Seed of lane 0 at every reset; lane i gets first_seed + i. Every reset then begins the same
            episodes. With None, resets use the seeds that the algorithm has set.
    """

    def __init__(
        self,
        num_envs: int,
        env_id: str = DEPLOY,
        env_kwargs: Mapping[str, object] | None = None,
        first_seed: int | None = None,
    ) -> None:
        self._first_seed = first_seed
        keywords: dict[str, Any] = {**(env_kwargs or {}), "autoreset_mode": AutoresetMode.SAME_STEP}
        self.env: Any = gymnasium.make_vec(env_id, num_envs, **keywords)
        self._with_lists = DictInfoToList(self.env)
        self._actions: np.ndarray | None = None
        super().__init__(num_envs, self.env.single_observation_space, self.env.single_action_space)
        self.spec = self.env.spec

    def reset(self) -> VecEnvObs:
        """Begin an episode in every lane (environment), with the seeds and options set since the last reset.

        With the constructor's `first_seed`, lane i instead has the seed first_seed + i at every reset.
        """
        if self._first_seed is not None:
            self.seed(self._first_seed)
        seeds: Any = self._seeds
        for given in self._options:
            self.env.unwrapped.episodes.settings.check_options(given, "parameters")
        changes = [given.get("parameters", {}) for given in self._options]
        observations, infos = self._with_lists.reset(seed=seeds, options={"parameters": changes})
        self.reset_infos = list(infos)
        self._reset_seeds()
        self._reset_options()
        return observations

    def step_async(self, actions: np.ndarray) -> None:
        """Store the actions (num_envs, motors) that the next `step_wait` applies."""
        self._actions = actions

    def step_wait(self) -> VecEnvStepReturn:
        """Advance all environments by one control period; return (observations, rewards as float32, dones, infos)."""
        observations, rewards, terminations, truncations, infos = self._with_lists.step(self._actions)
        dones = terminations | truncations
        told: list[Info] = list(infos)
        for lane in np.flatnonzero(dones):
            last = told[lane]
            self.reset_infos[lane] = {key: last[key] for key in last if key not in ("final_obs", "final_info")}
            told[lane] = {**last["final_info"], "terminal_observation": last["final_obs"]}
        for info, terminated, truncated in zip(told, terminations.tolist(), truncations.tolist(), strict=True):
            info["TimeLimit.truncated"] = truncated and not terminated
        return observations, rewards.astype(np.float32), dones, told

    def close(self) -> None:
        """Stop the threads of the vector environment."""
        self.env.close()

    def get_images(self) -> Sequence[np.ndarray | None]:
        """Render a frame of every lane (environment)."""
        return self.env.render()

    def get_attr(self, attr_name: str, indices: VecEnvIndices = None) -> list[Any]:
        """Return an attribute of each lane (environment) in `indices`, or the vector environment's if lanes lack it."""
        return [getattr(self.env.unwrapped.lane(lane), attr_name) for lane in self._get_indices(indices)]

    def set_attr(self, attr_name: str, value: object, indices: VecEnvIndices = None) -> None:
        """Raise an AttributeError that says what to do instead: attributes of lanes (environments) cannot be set."""
        raise AttributeError(
            f"{attr_name!r} cannot be set in a lane; pass keywords when the environment is made, or reset options"
        )

    def env_method(
        self, method_name: str, *method_args: object, indices: VecEnvIndices = None, **kwargs: object
    ) -> list[Any]:
        """Call each lane's (environment's) method, or the vector environment's if lanes lack it; return the results."""
        lanes = [self.env.unwrapped.lane(lane) for lane in self._get_indices(indices)]
        return [getattr(lane, method_name)(*method_args, **kwargs) for lane in lanes]

    def env_is_wrapped(self, wrapper_class: type[gymnasium.Wrapper], indices: VecEnvIndices = None) -> list[bool]:
        """Return False for every lane (environment): lanes have no wrappers."""
        return [False for _ in self._get_indices(indices)]
