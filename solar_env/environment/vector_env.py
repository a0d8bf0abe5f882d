"""The Gymnasium vector environment: many deploying arrays that advance together on all cores."""

import itertools
from collections.abc import Mapping, Sequence
from typing import Any

import gymnasium
import numpy as np
from gymnasium.utils import seeding
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from solar_env.array import ArrayParameters
from solar_env.environment.env import Observation
from solar_env.environment.episodes import Episodes, Info, SavedEpisode, checked_actions
from solar_env.environment.settings import Changes, EnvironmentSettings
from solar_env.mechanics.running.simulation import Simulation
from solar_env.support.values import is_whole_number, plain

Actions = NDArray[np.float32]
Flags = NDArray[np.bool_]
Results = tuple[Observation, NDArray[np.float64], Flags, Flags, Info]


class SolarArrayVectorEnv(VectorEnv[Observation, Actions, NDArray[Any]]):
    """A vector of environments, called lanes; `solar_env.SolarArrayEnv` describes actions, observations and rewards.

    `gymnasium.make_vec("solar_env/Deploy-v2", num_envs=64)` makes a vector. Threads advance the lanes in compiled code,
    without the interpreter lock. Lane i gives the results of a single environment with the same seed and actions to the
    last bit, for any number of lanes and threads. Returned arrays are copies that the caller may change.

    The conventions are `gymnasium.vector.SyncVectorEnv`'s; `info` holds arrays with masks. With autoreset DISABLED,
    `reset(options={"reset_mask": mask})` begins new episodes in some lanes. If a lane's simulation cannot continue, its
    episode is truncated: the reward is 0, the observation is the last one, and `info["failure"]` holds the error.

    Args:
        num_envs: number of lanes.
        max_episode_steps: number of control periods after which an episode is truncated; None never truncates.
        autoreset_mode: a `gymnasium.vector.AutoresetMode`, or its value.
        num_threads: greatest number of threads; by default the number of processors available to this process.
        keywords: see `solar_env.environment.settings.EnvironmentSettings`; `parameters` may also be a sequence with an
            entry for every lane.
    """

    closed = True  # until construction succeeds: Gymnasium also closes a vector whose construction failed

    def __init__(
        self,
        num_envs: int = 1,
        *,
        max_episode_steps: int | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        num_threads: int | None = None,
        **keywords: Any,
    ) -> None:
        """Check the keywords and prepare all environments; see the class, and `SolarArrayEnv` for refused values."""
        counts = {"num_envs": num_envs, "max_episode_steps": max_episode_steps, "num_threads": num_threads}
        for name, number in counts.items():
            if number is not None and not is_whole_number(plain(number), 1):
                raise ValueError(f"{name} = {number!r} must be a whole number, at least 1")
        self.num_envs = int(num_envs)
        lanes = _settings_by_lane(keywords, self.num_envs)
        settings = lanes[0]
        self.render_mode, self.scenario = settings.render_mode, settings.scenario
        if self.render_mode == "human":
            raise ValueError("render_mode 'human' has one window for one array; a vector draws with 'rgb_array' or not")
        self.parameters = [of_lane.array for of_lane in lanes]
        self.model = str(settings.level)
        self.randomize, self.hardware = settings.ranges, settings.devices
        self.task, self.reward, self.observation_names = settings.task, settings.terms, settings.observation_names
        self.autoreset_mode = AutoresetMode(autoreset_mode)
        timing = {"render_fps": settings.frames_per_second, "autoreset_mode": self.autoreset_mode}
        self.metadata = {"render_modes": ["rgb_array"], **timing}
        self.single_observation_space, self.single_action_space = settings.observation_space(), settings.action_space()
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.episodes = Episodes(lanes, num_threads)
        seeded = [seeding.np_random() for _ in range(num_envs)]
        self._generators, self._seeds = [generator for generator, _ in seeded], [seed for _, seed in seeded]
        self._longest = max_episode_steps
        self._all_lanes = np.arange(num_envs)
        self._elapsed = np.zeros(num_envs, dtype=np.int64)
        self._ended = np.zeros(num_envs, dtype=np.bool_)
        self.closed = False

    @property  # type: ignore[misc]
    def np_random(self) -> tuple[np.random.Generator, ...]:  # type: ignore[override]
        """Random number generators of the lanes (environments), in order."""
        return tuple(self._generators)

    @property
    def np_random_seed(self) -> tuple[int, ...]:  # type: ignore[override]
        """Seeds of the random number generators of the lanes (environments), in order."""
        return tuple(self._seeds)

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, Info]:
        """Begin episodes with folded arrays and newly sampled parameters.

        Args:
            seed: seed of lane (environment) 0, seed + i for lane i; or a seed by lane; None continues random sequences.
            options: {"parameters": {name: value}} changes parameters for this episode in all lanes; a sequence of
                mappings changes them by lane. {"reset_mask": (num_envs,) bool} resets only the lanes of the mask.

        Raises:
            ValueError: as `SolarArrayEnv.reset`, or for a wrong mask or number of seeds.
            gymnasium.error.ResetNeeded: if a mask leaves out lanes before the first reset of all lanes.
        """
        given = self.episodes.settings.check_options(options, "parameters", "reset_mask")
        mask = given.get("reset_mask")
        if mask is None:
            mask = np.ones(self.num_envs, dtype=np.bool_)
        if getattr(mask, "dtype", None) != np.bool_ or mask.shape != (self.num_envs,) or not mask.any():
            raise ValueError(
                f"reset_mask = {mask!r} must be an array of bool, of shape ({self.num_envs},), not all False"
            )
        lanes = np.flatnonzero(mask)
        if isinstance(seed, (int, np.integer)):
            seed = range(int(seed), int(seed) + self.num_envs)
        seeds = _by_lane("seed", seed, self.num_envs)
        by_lane = _by_lane("options['parameters']", given.get("parameters", {}), self.num_envs)
        begun = lanes.tolist()
        chosen = [by_lane[lane] for lane in begun]
        with self.episodes.alone():
            self.episodes.check_lanes(lanes)
            for lane, change in zip(begun, chosen, strict=True):
                self.episodes.lanes[lane].check_changes(change)
            seeded = {lane: seeding.np_random(plain(seeds[lane])) for lane in begun if seeds[lane] is not None}
            for lane, (generator, used) in seeded.items():
                self._generators[lane], self._seeds[lane] = generator, used
            self._fold(lanes, chosen)
            infos: Info = {}
            for lane in begun:
                self._add_info(infos, self.episodes.info(lane), lane)
            return self.episodes.observations.copy(), infos

    def _fold(self, lanes: NDArray[np.int64], changes: Sequence[Changes]) -> None:
        self.episodes.reset(lanes, [self._generators[lane] for lane in lanes], changes)
        self._ended[lanes] = False
        self._elapsed[lanes] = 0

    def step(self, actions: Actions) -> Results:
        """Advance all lanes (environments) by one control period with constant actions (num_envs, motors).

        Raises, Warns: as `SolarArrayEnv.step`, but a SimulationError is not raised: it ends its lane's episode. Ended
            episodes raise ResetNeeded only if autoreset is disabled.
        """
        given = checked_actions(actions, (self.num_envs, len(self.task.driven_joints)))
        episodes, lanes = self.episodes, self._all_lanes
        with episodes.alone():
            if self._ended.any():
                folded = np.flatnonzero(self._ended)
                if self.autoreset_mode is AutoresetMode.DISABLED:
                    raise gymnasium.error.ResetNeeded(
                        f"the episodes of lanes {folded.tolist()} have ended: call reset(options={{'reset_mask': ...}})"
                    )
                lanes = np.flatnonzero(~self._ended)
                self._fold(folded, [{}] * folded.size)
            failures = episodes.attempt(lanes, given)
            self._elapsed[lanes] += 1
            terminations = episodes.terminated.copy()
            truncations = np.zeros(self.num_envs, dtype=np.bool_)
            if self._longest is not None:
                np.greater_equal(self._elapsed, self._longest, out=truncations)
            truncations[list(failures)] = True
            np.logical_or(terminations, truncations, out=self._ended)
            rewards, infos = episodes.rewards.copy(), self._infos()
            if self._ended.any():
                last: dict[int, Info]
                last = {lane: {"deployment": episodes.figures(lane)} for lane in np.flatnonzero(terminations).tolist()}
                last |= {lane: {"failure": str(error)} for lane, error in failures.items()}
                self._end_episodes(np.flatnonzero(self._ended), last, infos)
            return episodes.observations.copy(), rewards, terminations, truncations, infos

    def _infos(self) -> Info:
        """Return the `info` arrays of all environments for the latest step, with the masks of `gymnasium.vector`."""
        terms = dict(zip(self.reward.names, self.episodes.terms.T.copy(), strict=True))
        told: Info = {"time_s": self.episodes.times, "reward_terms": terms}
        for values in (told["reward_terms"], told):
            values.update({f"_{name}": np.ones(self.num_envs, dtype=np.bool_) for name in tuple(values)})
        return told

    def _end_episodes(self, lanes: NDArray[np.int64], last: Mapping[int, Info], infos: Info) -> None:
        """Add ended episodes' results `last`, by lane (environment), to `infos`; begin new ones in SAME_STEP mode."""
        episodes = self.episodes
        if self.autoreset_mode is not AutoresetMode.SAME_STEP:
            for lane, told in last.items():
                self._add_info(infos, told, lane)
            return
        for lane in lanes.tolist():
            final = {**episodes.info(lane), **last.get(lane, {})}
            self._add_info(infos, {"final_obs": episodes.observations[lane].copy(), "final_info": final}, lane)
        self._fold(lanes, [{}] * lanes.size)
        for lane in lanes.tolist():
            self._add_info(infos, episodes.info(lane), lane)

    def lane(self, lane: int) -> "Lane":
        """Return a view of one lane (environment) as a single environment."""
        return Lane(self, range(self.num_envs)[lane])

    def render(self) -> tuple[NDArray[np.uint8] | None, ...]:  # type: ignore[override]
        """Draw every environment's present state; each frame is (540, 960, 3) uint8."""
        return tuple(self.episodes.render(lane) for lane in range(self.num_envs))

    def close_extras(self, **kwargs: object) -> None:
        """Stop the threads that advance the environments."""
        self.episodes.close()


def _settings_by_lane(keywords: Mapping[str, Any], lanes: int) -> list[EnvironmentSettings]:
    """Return the settings of each of `lanes` environments, from the keyword arguments of their vector environment.

    Raise a ValueError if a structural parameter, such as the number of panels, is not the same in all of them.
    """
    given = _by_lane("parameters", keywords.get("parameters"), lanes)
    found = {id(entry): EnvironmentSettings.of({**keywords, "parameters": entry}) for entry in given}
    settings = [found[id(entry)] for entry in given]
    for lane, (name, one) in itertools.product(range(lanes), settings[0].structure.items()):
        if (other := settings[lane].structure[name]) != one:
            raise ValueError(f"{name} is {one!r} in lane 0 and {other!r} in lane {lane}; make it the same in all lanes")
    return settings


def _by_lane(name: str, given: object, lanes: int) -> list[Any]:
    """Return a list with an entry per lane (environment): entries of a given sequence, or a given value repeated."""
    entries = list(given) if isinstance(given, (Sequence, np.ndarray)) else [given] * lanes
    if len(entries) != lanes:
        raise ValueError(f"{name} has {len(entries)} entries for num_envs = {lanes} lanes; give one for each")
    return entries


class Lane:
    """A view of one lane (environment) as a single environment; attributes that it lacks come from the vector."""

    def __init__(self, env: SolarArrayVectorEnv, index: int) -> None:
        self._env, self._index = env, index

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            # Copying looks up such names before the attribute `_env` exists.
            raise AttributeError(f"a lane has no {name!r}")
        if name in ("observation_space", "action_space"):
            return getattr(self._env, f"single_{name}")
        if name in ("task", "randomize"):
            of_lane = self._env.episodes.lanes[self._index]
            return of_lane.task if name == "task" else of_lane.ranges
        value = getattr(self._env, name)
        return value[self._index] if name in ("parameters", "np_random", "np_random_seed") else value

    @property
    def simulation(self) -> Simulation:
        """Simulation of this lane's (environment's) present episode."""
        return self._env.episodes.batch.simulations[self._index]

    @property
    def episode_parameters(self) -> ArrayParameters:
        """Array parameters of this environment's episode, after random sampling and the changes by reset options."""
        return self._env.episodes.parameters[self._index]

    def save_episode(self) -> SavedEpisode:
        """Return a copy of this lane's (environment's) episode, for `restore_episode` of a lane with equal settings."""
        if self._env.episodes.terminated[self._index]:
            raise gymnasium.error.ResetNeeded(f"the episode of lane {self._index} has ended")
        return self._env.episodes.save(self._index)

    def restore_episode(self, saved: SavedEpisode) -> NDArray[np.float32]:
        """Continue a saved episode in this lane (environment); return the last observation (entries,) before saving."""
        env, lane = self._env, self._index
        env.episodes.restore(lane, saved)
        env._ended[lane] = False
        env._elapsed[lane] = round(env.episodes.times[lane] / env.task.control_period)
        return env.episodes.observations[lane].copy()

    def render(self) -> NDArray[np.uint8] | None:
        """Draw this environment's present state as a frame (540, 960, 3) uint8."""
        return self._env.episodes.render(self._index)
