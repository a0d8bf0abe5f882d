"""Episodes of the control task in the environments of a batch, called lanes; a single environment is one lane."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from typing import Any, NamedTuple, Self

import gymnasium
import numpy as np
from numpy.typing import NDArray

from solar_env.array import ArrayParameters, announce_compilation, mark_compiled
from solar_env.environment.settings import Changes, EnvironmentSettings
from solar_env.environment.showing.film import Film
from solar_env.environment.task.drive import task_numbers
from solar_env.environment.task.periods import error_count, hold_lanes, make_periods, observe_lanes
from solar_env.environment.task.reward import Told, v1_return
from solar_env.environment.task.sensors import Memory
from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.running.batch import Batch
from solar_env.mechanics.running.errors import SimulationError
from solar_env.mechanics.running.simulation import Simulation
from solar_env.support.values import is_whole_number, plain

Info = dict[str, Any]  # Gymnasium's `info` of a step, or the figures of a deployment


class SavedEpisode(NamedTuple):
    """A copy of an episode between two steps: array parameters, settings, simulation state (contacts included), latest
    reward terms, physical quantities that the reward has counted so far, and the states of drives and sensors.
    """

    parameters: ArrayParameters
    conditions: Mapping[str, object]
    state: Any
    terms: NDArray[np.float64]
    account: NDArray[np.float64]
    drives: NDArray[np.float64]
    sensors: Memory


class Episodes:
    """Episodes in the lanes (environments) of a batch; each lane runs one episode after another.

    Attributes:
        lanes: settings by lane; lanes differ only in the parameters of the array.
        settings: settings of the first lane.
        parameters: array parameters of the present episode, by lane.
        observations: (lanes, entries) float32, the latest observations, with all sensor effects.
        terms: (lanes, terms) latest reward terms, in the order of `settings.terms.names`.
        rewards: (lanes,) latest rewards, the sums of the terms.
        terminated: (lanes,) whether the present episode has ended.
    """

    def __init__(self, lanes: Sequence[EnvironmentSettings], threads: int | None = None) -> None:
        """Allocate arrays of all lanes (environments), for at most `threads` threads; `reset` begins the episodes."""
        self.lanes, self.settings = tuple(lanes), lanes[0]
        self.parameters, settings = [of_lane.array for of_lane in lanes], self.settings
        self._sensors = settings.sensors(len(lanes))
        numbers = [task_numbers(each.task, each.devices, each.array) for each in lanes]
        self._error_counts = [error_count(of_lane) for of_lane in numbers]
        self._numbers = numbers[0]._replace(
            sample_period=np.array([of_lane.sample_period for of_lane in numbers]),
            motors=np.stack([of_lane.motors for of_lane in numbers]),
        )
        about = len(lanes), len(numbers[0].motors), max(self._error_counts), settings.terms.rows.size
        self._periods = make_periods(*about, self._sensors.exact)
        self.observations, self.terminated = self._sensors.observed, self._periods.terminated
        self.rewards, own = self._periods.rewards, settings.terms.function is not None
        self.terms = self.rewards[:, np.newaxis] if own else self._periods.terms
        self._batch: Batch | None = None
        self._films = [Film(each) for each in lanes]
        self._threads, self._busy = threads, False

    @contextmanager
    def alone(self) -> Iterator[None]:
        """Claim the episodes for a `with` block; a RuntimeError is raised if another block has claimed them."""
        if self._busy:
            raise RuntimeError(
                "this environment is in another call just now: give every thread an environment of its own, or take a "
                "vector environment, which has threads inside"
            )
        self._busy = True
        try:
            yield
        finally:
            self._busy = False

    @property
    def batch(self) -> Batch:
        """Batch of all environments' simulations; reading this property before the first reset raises ResetNeeded."""
        if self._batch is None:
            raise gymnasium.error.ResetNeeded("call reset() before using the simulation")
        return self._batch

    @property
    def times(self) -> NDArray[np.float64]:
        """(lanes,) copy of the simulated time [s] in the episode of each lane (environment of the batch)."""
        return np.array(self.batch.states.clock["time"][:, 0])

    def check_lanes(self, lanes: NDArray[np.int64]) -> None:
        """Raise ResetNeeded if this is the first reset and `lanes` (k,), the environments to reset, leave any out."""
        if self._batch is None and lanes.size < len(self.parameters):
            raise gymnasium.error.ResetNeeded("the first reset must be one of all lanes")

    def reset(
        self, lanes: NDArray[np.int64], generators: Sequence[np.random.Generator], changes: Sequence[Changes]
    ) -> None:
        """Begin episodes in `lanes` (k,), numbers of environments, with folded arrays and sampled parameters.

        The first call must name all lanes. `generators` (k,) are their random generators. Each of `changes` (k,) maps
        names of parameters to values that replace sampled values, checked by `EnvironmentSettings.check_changes`.
        """
        announce_compilation(self.settings.integrator.name)
        drawn = [
            self.lanes[lane].draw(generator, change)
            for lane, generator, change in zip(lanes, generators, changes, strict=True)
        ]
        simulations = [self.settings.simulation(parameters) for parameters in drawn]
        if self._batch is None:
            self._batch = Batch(simulations, self._threads)
        for lane, simulation, parameters in zip(lanes.tolist(), simulations, drawn, strict=True):
            if self._batch.simulations[lane] is not simulation:
                self._batch.replace(lane, simulation)
            self.parameters[lane] = parameters
            self._films[lane] = Film(self.lanes[lane])
        self.terminated[lanes] = False
        for values in (self.terms, self.rewards, self._periods.accounts, self._periods.drives):
            values[lanes] = 0.0
        observe_lanes(
            *self._batch.handles,
            self._numbers,
            self._sensors.channels,
            self._periods.drives,
            lanes,
            self._sensors.exact,
        )
        self._sensors.begin(lanes, generators)

    def step(self, lanes: NDArray[np.int64], actions: NDArray[np.float64]) -> None:
        """Advance environments `lanes` (k,) by a control period; `actions` (all environments, motors) stay constant.

        Raises:
            SimulationError: if a simulation cannot continue: the error of the lowest such lane (environment).
            ValueError: if the actions have a wrong shape, are no numbers, or are not finite.
        """
        raise_first(self.attempt(lanes, checked_actions(actions, self._periods.actions.shape)))

    def attempt(self, lanes: NDArray[np.int64], actions: NDArray[np.float64]) -> dict[int, SimulationError]:
        """Advance lanes (environments) by a control period with constant actions; return errors of failed simulations.

        Args:
            lanes: (k,) indices of the lanes that advance.
            actions: (all lanes, motors) see `Task.action`; clipped to [-1, 1]. Rows of other lanes are ignored.

        Returns:
            Mapping from lane to error for simulations that cannot continue; usually empty. A failed lane keeps its last
            observation, and its reward is 0.

        Raises, Warns: as `Batch.attempt`.
        """
        batch, sensors, periods = self.batch, self._sensors, self._periods
        periods.actions[:] = actions
        sensors.draw_rate_errors(lanes, self._error_counts, periods.rate_errors)
        before = self._told(lanes) if self.settings.terms.function else {}
        failures = batch.run(
            hold_lanes, lanes, batch.address, self._numbers, sensors.channels, self.settings.terms.rows, periods
        )
        mark_compiled(self.settings.integrator.name)
        if failures:
            failed = list(failures)
            self.terms[failed], self.rewards[failed] = 0.0, 0.0
            lanes = np.setdiff1d(lanes, failed)
        for lane, now in (self._told(lanes) if before else {}).items():
            self.rewards[lane] = self.settings.terms.own(before[lane], now)
        sensors.measure(lanes)
        if self.settings.render_mode:
            for lane in lanes:
                self._films[lane].add(batch.simulations[lane].state)
        return failures

    def _told(self, lanes: NDArray[np.int64]) -> dict[int, Told]:
        """Map each environment in `lanes` to a dictionary for the user's reward function.

        It holds "time_s" [s], the simulated time, and under each reward term's name, its physical quantity so far.
        """
        times, told = self.times.tolist(), self.settings.terms.told
        return {lane: told(times[lane], self._periods.accounts[lane]) for lane in lanes.tolist()}

    def save(self, lane: int) -> SavedEpisode:
        """Return a copy of a lane's (environment's) episode; `restore` continues it in any lane with equal settings."""
        state, sensors = self.batch.simulations[lane].snapshot(), self._sensors.memory(lane)
        account, terms, drives = (
            values[lane].copy() for values in (self._periods.accounts, self.terms, self._periods.drives)
        )
        return SavedEpisode(self.parameters[lane], self.lanes[lane].conditions, state, terms, account, drives, sensors)

    def restore(self, lane: int, saved: SavedEpisode) -> None:
        """Continue a saved episode in a lane (environment of the batch); equal actions give bitwise equal results.

        Rendered frames then plot the peak forces only from the restored state on.

        Raises:
            ValueError: if model, task, hardware, structure, observation or reward differ; the lane's present episode
                then continues.
        """
        if not isinstance(saved, SavedEpisode):
            raise ValueError(f"{str(saved)[:100]} is no saved episode; give what save() returned")
        for name, value in self.lanes[lane].conditions.items():
            if (other := saved.conditions[name]) != value:
                raise ValueError(
                    f"the saved episode had {name} = {other!r}, this environment has {value!r}: go on with it in an "
                    "equal one"
                )
        self.batch.replace(lane, self._simulation(saved))
        self._recall(lane, saved)
        self._films[lane] = Film(self.lanes[lane])

    def _simulation(self, saved: SavedEpisode) -> Simulation:
        simulation = self.settings.simulation(saved.parameters)
        simulation.restore(saved.state)
        return simulation

    def _recall(self, lane: int, saved: SavedEpisode) -> None:
        """Copy a saved episode into a lane (environment of the batch), except the state of its simulation."""
        self.parameters[lane], self.terminated[lane] = saved.parameters, False
        self._periods.accounts[lane], self._periods.drives[lane] = saved.account, saved.drives
        self.terms[lane], self.rewards[lane] = saved.terms, saved.terms.sum()
        self._sensors.recall(lane, saved.sensors)

    def futures(self, lane: int, count: int, threads: int | None = None) -> Self:
        """Return new `Episodes` of `count` lanes (environments), which continue copies of a lane's present episode.

        Each copy has everything that `save` keeps, and samples the same future noise. Equal actions thus give bitwise
        equal results. The copies run on at most `threads` threads; the present episode stays unchanged.
        """
        if not is_whole_number(plain(count), 1):
            raise ValueError(f"lanes = {count!r} must be a whole number, at least 1")
        saved = self.save(lane)
        copies = type(self)([replace(self.lanes[lane], render_mode=None)] * count, threads)
        copies._batch = Batch([self._simulation(saved) for _ in range(count)], threads)
        for k in range(count):
            copies._recall(k, saved)
        copies.rewards[:], copies.terminated[:] = self.rewards[lane], self.terminated[lane]
        return copies

    def info(self, lane: int) -> Info:
        """Return the `info` of a lane's (environment's) latest step: the simulated time [s] and the reward terms."""
        terms = dict(zip(self.settings.terms.names, self.terms[lane].tolist(), strict=True))
        return {"time_s": self.batch.simulations[lane].time, "reward_terms": terms}

    def figures(self, lane: int) -> Info:
        """Return an environment's physical results so far, by names like "duration_s", for `info["deployment"]`.

        Warns:
            SimulationWarning: if the simulation may be inaccurate, see `Simulation.check`.
        """
        simulation, driven_joints = self.batch.simulations[lane], list(self.settings.task.driven_joints)
        simulation.check()
        state, joints = simulation.state, simulation.state.joints
        by_joint = m.joint_integrals(state.integrals)
        locked = float(state.clock["latched_joints"][0] > 0)
        latches = zip(joints["latch_time"], joints["latched"], strict=True)
        figures: Info = {
            "latched": bool(joints["latched"].all()),
            "latch_times_s": [float(time) if latched else None for time, latched in latches],
            "peak_latch_torque_Nm": joints["peak_latch_torque"].tolist(),
            "peak_prelatch_force_N": joints["lock_peak_force" if locked else "peak_force"].tolist(),
            "peak_postlock_force_N": joints["postlock_peak_force"].tolist(),
            "sliding_work_J": by_joint[:, m.SLIDING_WORK].tolist(),
            "postlock_impulse_Ns": ((by_joint[:, m.IMPULSE] - joints["lock_impulse"]) * locked).tolist(),
            "postlock_sliding_work_J": ((by_joint[:, m.SLIDING_WORK] - joints["lock_sliding_work"]) * locked).tolist(),
            "wear_depth_max_m": np.maximum(state.wear_journal.max(axis=1), state.wear_bearing.max(axis=1)).tolist(),
            "contact_starts": joints["contact_starts"].tolist(),
            "motor_work_J": float(by_joint[driven_joints, m.MOTOR_WORK].sum()),
            "energy_residual_J": simulation.energy_residual(),
            "duration_s": simulation.time,
        }
        return {**figures, "v1_return": v1_return(figures)}

    def close(self) -> None:
        """Stop the threads that advance the environments of the batch."""
        if self._batch is not None:
            self._batch.close()

    def render(self, lane: int) -> NDArray[np.uint8] | None:
        """Draw an environment's state as a frame (540, 960, 3) uint8; without a render mode, warn and return None."""
        if not self.settings.render_mode:
            gymnasium.logger.warn(
                'render() does nothing without a render mode; make the environment with render_mode="rgb_array"'
            )
            return None
        return self._films[lane].draw(self.batch.simulations[lane], self.parameters[lane])


def raise_first(failures: Mapping[int, SimulationError]) -> None:
    """Raise the first failure, if any, with a note that names its lane (environment) and the other failed lanes."""
    if failures:
        lane, *others = failures
        failures[lane].add_note(f"in lane {lane} of the batch{f', and others in {others}' if others else ''}")
        raise failures[lane]


def checked_actions(given: object, shape: tuple[int, ...]) -> NDArray[np.float64]:
    """Return `given` as float64 actions of this shape: (motors,), or (environments, motors) for a batch.

    Raises:
        ValueError: if the actions have another shape, are no numbers, or are not finite.
    """
    try:
        actions = np.array(given, dtype=np.float64)
    except (ValueError, TypeError, OverflowError) as error:  # Python's int may exceed a float's range
        raise ValueError(f"action = {str(given)[:99]} is no array of finite numbers; give some of -1 to 1") from error
    if actions.shape != shape:
        raise ValueError(f"the action has shape {actions.shape}, expected {shape}")
    if not np.isfinite(actions).all():
        where = "" if actions.ndim == 1 else f" of lane {np.argmin(np.isfinite(actions).all(axis=1))}"
        raise ValueError(f"action{where} is not finite; give numbers from -1 to 1")
    return actions
