"""Episodes of the control task, lane by lane, of a single environment and of a vector of them."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple, Self

import gymnasium
import numpy as np
from numpy.typing import NDArray

from solar_env.array import ArrayParameters
from solar_env.array.compilation import announce_compilation, mark_compiled
from solar_env.environment.figures import episode_figures
from solar_env.environment.settings import Changes, EnvironmentSettings
from solar_env.environment.showing.film import Film
from solar_env.environment.starts import Starts, run_approaches
from solar_env.environment.task.periods import begin_periods, begin_samples, end_periods, observe_lanes
from solar_env.environment.task.sensors import Memory
from solar_env.mechanics.running.batch import Batch
from solar_env.mechanics.running.errors import SimulationError


class SavedEpisode(NamedTuple):
    """An episode between two of its steps: see `Episodes.save`.

    Attributes:
        parameters: of the episode.
        state: of the simulation, mid-contact included.
        charged: (terms, 2) figures charged so far, and their latest readings.
        terms: (terms,) of the latest reward.
        names: of the terms.
        sensors: their memory, the state of their noise included.
        loop_torque: that the drive's rate loop asks of the motor [N m].
    """

    parameters: ArrayParameters
    state: Any
    charged: NDArray[np.float64]
    terms: NDArray[np.float64]
    names: tuple[str, ...]
    sensors: Memory
    loop_torque: float


class Episodes:
    """One episode after another in each of several lanes.

    Attributes:
        settings: of the environment.
        designs: parameters by lane, before anything is drawn.
        parameters: by lane, of the present episode.
        observations: (lanes, entries) float32, the latest, as the sensors show them.
        terms: (lanes, terms) of the latest reward, in the order of `settings.terms.names`.
        rewards: (lanes,) their sums.
        terminated: (lanes,) whether the present episode has ended.
        starts_from: least opening of the starts that the next episodes begin at; a curriculum lowers it.
        starts_folded: share of the next episodes that begin folded.
    """

    def __init__(
        self, settings: EnvironmentSettings, designs: Sequence[ArrayParameters], threads: int | None = None
    ) -> None:
        """Without episodes yet: they begin with `reset`.

        Args:
            settings: of the environment; with a render mode, force peaks are kept for frames.
            designs: parameters by lane, before anything is drawn.
            threads: see `Batch`.
        """
        self.settings, self.designs, self.parameters = settings, tuple(designs), list(designs)
        lanes, terms = len(designs), len(settings.terms.names)
        self._sensors = settings.sensors(lanes)
        self.observations = self._sensors.observed
        self.terms, self._charged = np.zeros((lanes, terms)), np.zeros((lanes, terms, 2))
        self.rewards, self._end_times, self._sample_ends = np.zeros(lanes), np.zeros(lanes), np.zeros(lanes)
        self.terminated, self._loop_torques = np.zeros(lanes, dtype=np.bool_), np.zeros(lanes)
        self._numbers, self._samples = settings.task.numbers(settings.drive), settings.task.samples(settings.drive)
        self._threads = threads
        self._approaches: list[tuple[float, SavedEpisode]] | None = None
        self.starts_from, self.starts_folded = 0.0, settings.beginnings.folded if settings.beginnings else 1.0
        self._batch: Batch | None = None
        self._films: list[Film] | None = [Film(settings) for _ in range(lanes)] if settings.render_mode else None

    @property
    def batch(self) -> Batch:
        """The simulations.

        Raises:
            gymnasium.error.ResetNeeded: before the first reset.
        """
        if self._batch is None:
            raise gymnasium.error.ResetNeeded("call reset() before using the simulation")
        return self._batch

    @property
    def times(self) -> NDArray[np.float64]:
        """(lanes,) time of each episode [s]; a copy."""
        return np.array(self.batch.states.clock["time"][:, 0])

    def check_changes(self, lanes: NDArray[np.int64], changes: Sequence[Changes]) -> None:
        """Check changes of the parameters of episodes in some lanes, before anything is seeded or drawn.

        Raises:
            ValueError: for unknown parameters, refused values, or values that change the mechanism's structure.
        """
        for lane, change in zip(lanes, changes, strict=True):
            self.settings.check_changes(self.designs[lane], change)

    def reset(
        self, lanes: NDArray[np.int64], generators: Sequence[np.random.Generator], changes: Sequence[Changes]
    ) -> None:
        """Begin episodes: folded, with parameters that are drawn, or at one of the settings' starts.

        Args:
            lanes: (k,) which; the first time all, in order.
            generators: (k,) of random numbers.
            changes: (k,) of parameters, after the draw; an episode with changes begins folded.

        Raises:
            gymnasium.error.ResetNeeded: if not all lanes have begun an episode yet.
            ValueError: for unknown parameters or refused values, see `check_changes`; or if the lanes' designs
                differ in structure.
        """
        if self._batch is None and lanes.size < len(self.parameters):
            raise gymnasium.error.ResetNeeded("the first reset must be one of all lanes")
        announce_compilation(self.settings.integrator.name)
        begun = [self._start(generator, change) for generator, change in zip(generators, changes, strict=True)]
        drawn = [
            start.parameters if start else self.settings.draw(self.designs[lane], generator, change)
            for start, lane, generator, change in zip(begun, lanes, generators, changes, strict=True)
        ]
        simulations = [self.settings.simulation(parameters) for parameters in drawn]
        for start, simulation in zip(begun, simulations, strict=True):
            if start:
                simulation.restore(start.state)
        if self._batch is None:
            self._batch = Batch(simulations, self._threads)
        else:
            for lane, simulation in zip(lanes, simulations, strict=True):
                self._batch.replace(int(lane), simulation)
        for lane, parameters in zip(lanes, drawn, strict=True):
            self.parameters[lane] = parameters
            if self._films is not None:
                self._films[lane] = Film(self.settings)
        self.terminated[lanes] = False
        self.terms[lanes], self.rewards[lanes] = 0.0, 0.0
        for lane, start in zip(lanes, begun, strict=True):
            self._charged[lane] = start.charged if start else 0.0
            self._loop_torques[lane] = start.loop_torque if start else 0.0
        self._observe(lanes)
        self._sensors.begin(lanes, generators)

    def _start(self, generator: np.random.Generator, changes: Changes) -> SavedEpisode | None:
        """Where an episode begins; None: folded."""
        if self.settings.beginnings is None or changes:
            return None
        if self._approaches is None:
            self._approaches = self._run_approaches(self.settings.beginnings)
        if generator.random() < self.starts_folded:
            return None
        late = [start for opening, start in self._approaches if opening >= self.starts_from]
        return late[generator.integers(len(late))] if late else self._approaches[-1][1]

    def _run_approaches(self, starts: Starts) -> list[tuple[float, SavedEpisode]]:
        exact = self.settings.drive.with_ideal_sensors()
        settings = replace(
            self.settings, hardware=exact, observation="drive", action="rate", starts=None, render_mode=None
        )
        designs = (self.designs * starts.count)[: starts.count]
        return run_approaches(type(self)(settings, designs, self._threads), starts)

    def _observe(self, lanes: NDArray[np.int64]) -> None:
        """Observe the present states with ideal sensors."""
        states, sensors = self.batch.states, self._sensors
        observe_lanes(self.batch.models, states, self._numbers, sensors.channels, lanes, sensors.exact)

    def step(self, lanes: NDArray[np.int64], actions: NDArray[np.float64]) -> None:
        """Hold actions for one control period.

        Args:
            lanes: (k,) which.
            actions: (lanes,) see `Task.action`; clipped to [-1, 1].

        Raises, Warns: as `Batch.advance`.
        """
        begin_periods(self.batch.states, self._numbers, lanes, self._end_times)
        for _ in range(self._samples):
            self.hold(lanes, actions)
            self.batch.advance(lanes, self._sample_ends)
        self.end(lanes)
        mark_compiled(self.settings.integrator.name)

    def attempt(self, lanes: NDArray[np.int64], actions: NDArray[np.float64]) -> dict[int, SimulationError]:
        """`step` that hands back failures, lane -> why its simulation cannot go on; mostly there are none.

        A lane that fails keeps what it observed last, and earns nothing.
        """
        begin_periods(self.batch.states, self._numbers, lanes, self._end_times)
        failures: dict[int, SimulationError] = {}
        for _ in range(self._samples):
            self.hold(lanes, actions)
            failures |= self.batch.attempt(lanes, self._sample_ends)
            lanes = np.setdiff1d(lanes, list(failures)) if failures else lanes
        failed = list(failures)
        self.terms[failed], self.rewards[failed] = 0.0, 0.0
        self.end(lanes)
        mark_compiled(self.settings.integrator.name)
        return failures

    def hold(self, lanes: NDArray[np.int64], actions: NDArray[np.float64]) -> None:
        """Set the motor torques until the drive's next sample."""
        batch, errors, ends = self.batch, self._sensors.rate_errors(lanes), (self._end_times, self._sample_ends)
        begin_samples(batch.models, batch.states, self._numbers, lanes, actions, errors, self._loop_torques, *ends)

    def end(self, lanes: NDArray[np.int64]) -> None:
        """Charge and observe a control period."""
        batch, sensors = self.batch, self._sensors
        end_periods(
            batch.models, batch.states, self._numbers, sensors.channels, self.settings.terms.charges, lanes,
            self._charged, self.terms, self.rewards, sensors.exact, self.terminated,
        )  # fmt: skip
        sensors.measure(lanes)
        if self._films is not None:
            for lane in lanes:
                self._films[lane].add(batch.simulations[lane].state)

    def save(self, lane: int) -> SavedEpisode:
        """The present episode of a lane, to be gone on with later, in any lane of episodes with the same settings.

        Raises:
            gymnasium.error.ResetNeeded: before the first reset.
        """
        state = self.batch.simulations[lane].snapshot()
        charged, terms = self._charged[lane].copy(), self.terms[lane].copy()
        names, sensors = self.settings.terms.names, self._sensors.memory(lane)
        loop_torque = float(self._loop_torques[lane])
        return SavedEpisode(self.parameters[lane], state, charged, terms, names, sensors, loop_torque)

    def restore(self, lane: int, saved: SavedEpisode) -> None:
        """Go on with a saved episode: the same actions lead to the same bits. Frames begin their force history anew.

        Raises:
            gymnasium.error.ResetNeeded: before the first reset.
            ValueError: if the episode's structure is not that of these settings, or other entries were observed or
                other terms charged; the present episode goes on then.
        """
        if saved.names != self.settings.terms.names:
            raise ValueError(
                f"the saved episode was charged for {', '.join(saved.names)}, this one for "
                f"{', '.join(self.settings.terms.names)}: go on with it where the same terms are charged"
            )
        self._sensors.check(saved.sensors)
        simulation = self.settings.simulation(saved.parameters)
        simulation.restore(saved.state)
        self.batch.replace(lane, simulation)
        self._recall(lane, saved)
        if self._films is not None:
            self._films[lane] = Film(self.settings)

    def _recall(self, lane: int, saved: SavedEpisode) -> None:
        """Take over what a saved episode has beside the state of its simulation."""
        self.parameters[lane] = saved.parameters
        self._charged[lane], self.terms[lane], self.terminated[lane] = saved.charged, saved.terms, False
        self.rewards[lane], self._loop_torques[lane] = saved.terms.sum(), saved.loop_torque
        self._sensors.recall(lane, saved.sensors)

    def futures(self, lane: int, count: int, threads: int | None = None) -> Self:
        """Copies of the present episode of a lane, which go on without touching it.

        Each has the original's whole state, mid-contact included, its parameters, its charges so far, its motor and its
        sensors with the noise that is to come, and goes on to the same bits under the same actions.

        Args:
            lane: of the original.
            count: number of copies, the lanes of what is returned.
            threads: most threads that advance them; by default as many as there are processors for this process.

        Raises:
            gymnasium.error.ResetNeeded: before the first reset.
            ValueError: if `count` or `threads` is not positive.
        """
        saved = self.save(lane)
        simulations = [self.settings.simulation(saved.parameters) for _ in range(count)]
        copies = type(self)(replace(self.settings, render_mode=None), [saved.parameters] * count, threads)
        for k, simulation in enumerate(simulations):
            simulation.restore(saved.state)
            copies._recall(k, saved)
        copies._batch = Batch(simulations, threads)
        copies.rewards[:], copies.terminated[:] = self.rewards[lane], self.terminated[lane]
        return copies

    def info(self, lane: int) -> dict[str, Any]:
        """Information of every step: time [s] and terms of the reward."""
        terms = dict(zip(self.settings.terms.names, self.terms[lane].tolist(), strict=True))
        return {"time_s": self.batch.simulations[lane].time, "reward_terms": terms}

    def figures(self, lane: int) -> dict[str, Any]:
        """The physical figures of an episode; see `figures.episode_figures`."""
        return episode_figures(self.batch.simulations[lane], self.settings.task.driven_joint)

    def draw_from(self, lane: int, generator: np.random.Generator) -> None:
        """Let a generator draw the noise of a lane's sensors from now on."""
        self._sensors.draw_from(lane, generator)

    def close(self) -> None:
        """End the threads."""
        if self._batch is not None:
            self._batch.close()

    def render(self, lane: int) -> NDArray[np.uint8] | None:
        """Draw the present state; (540, 960, 3) uint8, or None with a warning if the settings have no render mode."""
        if self._films is None:
            gymnasium.logger.warn(
                'render() does nothing without a render mode; make the environment with render_mode="rgb_array"'
            )
            return None
        return self._films[lane].draw(self.batch.simulations[lane], self.parameters[lane])
