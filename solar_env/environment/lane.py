"""One lane of a vector environment, seen as a single environment."""

from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from solar_env.array import ArrayParameters
from solar_env.environment.episodes import SavedEpisode
from solar_env.mechanics.running.simulation import Simulation


class Lane:
    """One lane as the single environment that it stands for: its own attributes, and those of the whole vector.

    Args:
        env: the `SolarArrayVectorEnv`, which imports this module.
        index: of the lane.
    """

    def __init__(self, env: Any, index: int) -> None:
        self._env, self._index = env, index

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            # Copies ask for such names before there is a vector.
            raise AttributeError(f"a lane has no {name!r}")
        if name in ("observation_space", "action_space"):
            return getattr(self._env, f"single_{name}")
        value = getattr(self._env, name)
        return value[self._index] if name in ("parameters", "np_random", "np_random_seed") else value

    @property
    def simulation(self) -> Simulation:
        """As that of a single environment."""
        return self._env.episodes.batch.simulations[self._index]

    @property
    def episode_parameters(self) -> ArrayParameters:
        """Parameters of the present episode."""
        return self._env.episodes.parameters[self._index]

    def save_episode(self) -> SavedEpisode:
        """The present episode, to be gone on with by `restore_episode`, here or in a lane of an equal vector.

        Raises:
            gymnasium.error.ResetNeeded: before the first reset, and where the episode has ended.
        """
        if self._env.episodes.terminated[self._index]:
            raise gymnasium.error.ResetNeeded(f"the episode of lane {self._index} has ended")
        return self._env.episodes.save(self._index)

    def restore_episode(self, saved: SavedEpisode) -> NDArray[np.float32]:
        """Go on with a saved episode, see `Episodes.restore`; returns what was observed last (entries,)."""
        self._env.restore(self._index, saved)
        return self._env.episodes.observations[self._index].copy()

    def render(self) -> NDArray[np.uint8] | None:
        """Draw the present state; (540, 960, 3) uint8."""
        return self._env.episodes.render(self._index)
