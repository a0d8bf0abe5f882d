"""Episodes of the control task, lane by lane: what a single environment and a vector of them have in common."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import copy
from typing import Any, NamedTuple

import gymnasium
import numpy as np
from numpy.typing import NDArray

from .array import DEFAULT_ELEMENTS, ArrayParameters, build, check_elements, check_model, main_body_corners
from .hardware import Hardware
from .integrators import default_integrator
from .ladder import DEFAULT_QUESTION, DEFAULT_TOLERANCE, cheapest, read_answers
from .mechanics import model as m
from .mechanics.batch import Batch
from .mechanics.geometry import centreline
from .mechanics.joint import ECCENTRICITY_X, ECCENTRICITY_Y, NORMAL
from .mechanics.simulation import Simulation
from .render import Renderer, Scene
from .scenarios import Bound, Ranges, scenario_named
from .sensors import Memory, Sensors
from .task import REWARD_TERMS, Task, begin_periods, end_periods, observation_entries, observe_lanes, wear_depths

Changes = Mapping[str, Any]


class Setup:
    """What all episodes share: model, parameters and their ranges, the task, what is observed.

    Attributes:
        model, elements: of the array; "auto" has been replaced by what it stands for.
        scenario: its name.
        parameters: before anything is drawn.
        randomize: parameter -> (low, high), by joint where the parameter is.
        hardware: sensors and motor.
        task: limits, durations and prices.
        observation: kind of observation.
    """

    def __init__(
        self,
        model: str,
        parameters: ArrayParameters | Changes | None,
        elements: int,
        question: str | None,
        tolerance: float | None,
        task: Task,
        observation: str,
        scenario: str,
        randomize: Ranges | None,
        hardware: Hardware | Changes | None,
    ) -> None:
        """Check everything; for the arguments see ``env.SolarArrayEnv``.

        Raises:
            ValueError: for an unknown name or a refused value; the message says which.
        """
        self.model, self.elements = _level(model, elements, question, tolerance)
        self.scenario, named = scenario, scenario_named(scenario)
        self.parameters = named.design(parameters)
        self.task = task
        self.randomize = _checked_ranges(self.parameters, named.randomize if randomize is None else randomize)
        self.hardware = named.drive(hardware)
        self.observation = observation

    @property
    def observation_names(self) -> tuple[str, ...]:
        """Names of the entries of an observation, in order.

        Raises:
            ValueError: if the kind of observation is unknown.
        """
        return tuple(entry.name for entry in observation_entries(self.parameters.panel_count, self.observation))

    def sensors(self, lanes: int) -> Sensors:
        """The sensors of several arrays."""
        joints = range(self.parameters.panel_count)
        return Sensors(lanes, [self.parameters.lock_angle(j) for j in joints], self.observation, self.hardware)

    def observation_space(self) -> gymnasium.Space[Any]:
        """Space of one observation."""
        sensors = self.sensors(0)
        return gymnasium.spaces.Box(sensors.low, sensors.high, dtype=np.float32)

    def action_space(self) -> gymnasium.Space[Any]:
        """Space of one action."""
        return gymnasium.spaces.Box(-1.0, 1.0, (1,), dtype=np.float32)

    def with_exact_observations(self) -> Setup:
        """The same with perfect sensors that show the entries of the observation "drive"; the motor stays as it is."""
        exact = copy(self)
        exact.hardware = Hardware(motor_lag=self.hardware.motor_lag, torque_rate_limit=self.hardware.torque_rate_limit)
        exact.observation = "drive"
        return exact

    def draw(self, design: ArrayParameters, generator: np.random.Generator, changes: Changes) -> ArrayParameters:
        """Parameters of one episode: those of a design, with some drawn from the ranges, then some changed.

        Raises:
            ValueError: for unknown parameters or refused values.
        """
        drawn: dict[str, Any] = {}
        for name, (low, high) in self.randomize.items():
            if name in ArrayParameters.BY_JOINT:
                drawn[name] = tuple(generator.uniform(low, high).tolist())
            else:
                drawn[name] = float(generator.uniform(low, high))
        changed = design.with_changes({**drawn, **changes})
        if changed.panel_count != self.parameters.panel_count:
            raise ValueError("panel_count shapes the observation space; set it when the environment is made")
        return changed

    def simulation(self, parameters: ArrayParameters) -> Simulation:
        """A folded array at rest."""
        return Simulation(build(parameters, self.model, self.elements), default_integrator(self.model))


class SavedEpisode(NamedTuple):
    """An episode between two of its steps: see :meth:`Episodes.save`.

    Attributes:
        parameters: of the episode.
        state: of the simulation, mid-contact included.
        charged: (2,) for peak forces and for wear so far.
        terms: (3,) of the latest reward.
        sensors: their memory, the state of their noise included.
    """

    parameters: ArrayParameters
    state: m.State
    charged: NDArray[np.float64]
    terms: NDArray[np.float64]
    sensors: Memory


class Episodes:
    """One episode after another in each of several lanes.

    Attributes:
        setup: what they share.
        designs: parameters by lane, before anything is drawn.
        parameters: by lane, of the present episode.
        observations: (lanes, entries) float32, the latest, as the sensors show them.
        terms: (lanes, 3) of the latest reward, in the order of REWARD_TERMS.
        terminated: (lanes,) whether the present episode has ended.
    """

    def __init__(
        self, setup: Setup, designs: Sequence[ArrayParameters], threads: int | None = None, recorded: bool = False
    ) -> None:
        """Without episodes yet: they begin with :meth:`reset`.

        Args:
            setup: what they share.
            designs: parameters by lane, before anything is drawn.
            threads: see ``Batch``.
            recorded: whether force peaks are kept for frames.
        """
        self.setup = setup
        self.designs = tuple(designs)
        self.parameters = list(designs)
        lanes = len(designs)
        self._sensors = setup.sensors(lanes)
        self.observations = self._sensors.observed
        self.terms = np.zeros((lanes, len(REWARD_TERMS)))
        self.terminated = np.zeros(lanes, dtype=np.bool_)
        self._charged = np.zeros((lanes, 2))
        self._end_times = np.zeros(lanes)
        # What the kernels need to know of the task and of what is observed.
        self._numbers = setup.task.numbers(setup.hardware)
        present = self._sensors.present
        bounds = (self._sensors.low[:present], self._sensors.high[:present])
        self._observed = (setup.observation == "privileged", *bounds)
        self._threads = threads
        self._batch: Batch | None = None
        self._histories: list[_History] | None = [_History(setup) for _ in range(lanes)] if recorded else None

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

    def reset(
        self, lanes: NDArray[np.int64], generators: Sequence[np.random.Generator], changes: Sequence[Changes]
    ) -> None:
        """Fold arrays and draw their parameters.

        Args:
            lanes: (k,) which; the first time all, in order.
            generators: (k,) of random numbers.
            changes: (k,) of parameters, after the draw.

        Raises:
            gymnasium.error.ResetNeeded: if not all lanes have begun an episode yet.
            ValueError: for unknown parameters, refused values, or values that change the mechanism's structure.
        """
        if self._batch is None and lanes.size < len(self.parameters):
            raise gymnasium.error.ResetNeeded("the first reset must be one of all lanes")
        drawn = [
            self.setup.draw(self.designs[lane], generator, change)
            for lane, generator, change in zip(lanes, generators, changes, strict=True)
        ]
        simulations = [self.setup.simulation(parameters) for parameters in drawn]
        everything = lanes.size == len(self.parameters)
        if self._batch is None or (everything and not self._batch.takes(simulations[0])):
            self._batch = Batch(simulations, self._threads)
        else:
            for lane, simulation in zip(lanes, simulations, strict=True):
                self._batch.replace(int(lane), simulation)
        for lane, parameters in zip(lanes, drawn, strict=True):
            self.parameters[lane] = parameters
            if self._histories is not None:
                self._histories[lane] = _History(self.setup)
        self.terminated[lanes] = False
        self.terms[lanes] = 0.0
        self._charged[lanes] = 0.0
        self._observe(lanes)
        self._sensors.begin(lanes, generators)

    def _observe(self, lanes: NDArray[np.int64]) -> None:
        """Write what ideal sensors see of the present states."""
        batch = self.batch
        observe_lanes(batch.models, batch.states, self._numbers, *self._observed, lanes, self._sensors.exact)

    def step(self, lanes: NDArray[np.int64], actions: NDArray[np.float64]) -> None:
        """Hold motor torques for one control period.

        Args:
            lanes: (k,) which.
            actions: (lanes,) motor torques in units of the torque limit; clipped to [-1, 1].

        Raises:
            SimulationError: if a simulation cannot go on.

        Warns:
            SimulationWarning: as ``Simulation.check``.
        """
        self.begin(lanes, actions)
        self.batch.advance(lanes, self._end_times)
        self.end(lanes)

    def begin(self, lanes: NDArray[np.int64], actions: NDArray[np.float64]) -> None:
        """Set the motor torques of a control period, and when it ends."""
        begin_periods(self.batch.states, self._numbers, lanes, actions, self._end_times)

    def end(self, lanes: NDArray[np.int64]) -> None:
        """Charge and observe a control period."""
        batch = self.batch
        end_periods(
            batch.models,
            batch.states,
            self._numbers,
            *self._observed,
            lanes,
            self._charged,
            self.terms,
            self._sensors.exact,
            self.terminated,
        )
        self._sensors.measure(lanes)
        if self._histories is not None:
            for lane in lanes:
                self._histories[lane].add(batch.simulations[lane].state)

    def save(self, lane: int) -> SavedEpisode:
        """The present episode of a lane, to be gone on with later, in any lane of episodes with the same setup.

        Raises:
            gymnasium.error.ResetNeeded: before the first reset.
        """
        state = self.batch.simulations[lane].snapshot()
        charged, terms = self._charged[lane].copy(), self.terms[lane].copy()
        return SavedEpisode(self.parameters[lane], state, charged, terms, self._sensors.memory(lane))

    def restore(self, lane: int, saved: SavedEpisode) -> None:
        """Go on with a saved episode: the same actions lead to the same bits. Frames begin their force history anew.

        Raises:
            gymnasium.error.ResetNeeded: before the first reset.
            ValueError: if the episode's structure is not that of this setup.
        """
        simulation = self.setup.simulation(saved.parameters)
        simulation.restore(saved.state)
        self.batch.replace(lane, simulation)
        self.parameters[lane] = saved.parameters
        self._charged[lane], self.terms[lane], self.terminated[lane] = saved.charged, saved.terms, False
        self._sensors.recall(lane, saved.sensors)
        if self._histories is not None:
            self._histories[lane] = _History(self.setup)

    def futures(self, lane: int, count: int, threads: int | None = None) -> Episodes:
        """Copies of the present episode of a lane, which go on without touching it.

        Each has the original's whole state, mid-contact included, its parameters, its charges so far and its motor, and
        goes on to the same bits under the same actions. They observe the entries of "drive" with perfect sensors: no
        random number is drawn.

        Args:
            lane: of the original.
            count: number of copies, the lanes of what is returned.
            threads: see ``Batch``.

        Raises:
            gymnasium.error.ResetNeeded: before the first reset.
            ValueError: if ``count`` or ``threads`` is not positive.
        """
        state, parameters = self.batch.simulations[lane].state, self.parameters[lane]
        simulations = [self.setup.simulation(parameters) for _ in range(count)]
        for simulation in simulations:
            simulation.restore(state)
        copies = Episodes(self.setup.with_exact_observations(), [parameters] * count, threads)
        copies._batch = Batch(simulations, threads)
        copies.terms[:] = self.terms[lane]
        copies.terminated[:] = self.terminated[lane]
        copies._charged[:] = self._charged[lane]
        copies._observe(np.arange(count))
        return copies

    def figures(self, lane: int) -> dict[str, Any]:
        """The physical figures of an episode, after a look at its accuracy.

        Warns:
            SimulationWarning: if it was less accurate than it looks, see ``Simulation.check``.
        """
        simulation = self.batch.simulations[lane]
        simulation.check()
        state = simulation.state
        joints = state.joints
        by_joint = m.joint_integrals(state.integrals)
        locked = float(state.clock["latched_joints"][0] > 0)
        return {
            "latched": bool(joints["latched"].all()),
            "latch_times_s": [
                float(t) if own else None for t, own in zip(joints["latch_time"], joints["latched"], strict=True)
            ],
            "peak_postlock_force_N": joints["postlock_peak_force"].tolist(),
            "postlock_impulse_Ns": ((by_joint[:, m.IMPULSE] - joints["lock_impulse"]) * locked).tolist(),
            "postlock_sliding_work_J": ((by_joint[:, m.SLIDING_WORK] - joints["lock_sliding_work"]) * locked).tolist(),
            "wear_depth_max_m": wear_depths(state).tolist(),
            "contact_starts": joints["contact_starts"].tolist(),
            "motor_work_J": float(by_joint[0, m.MOTOR_WORK]),
            "energy_residual_J": simulation.energy_residual(),
            "duration_s": simulation.time,
        }

    def close(self) -> None:
        """End the threads."""
        if self._batch is not None:
            self._batch.close()

    def render(self, lane: int) -> NDArray[np.uint8]:
        """Draw the present state; (540, 960, 3) uint8. The episodes must be recorded."""
        assert self._histories is not None
        return self._histories[lane].draw(self.batch.simulations[lane], self.parameters[lane])


class _History:
    """Force peaks of an episode so far, and the renderer that draws them with the array."""

    def __init__(self, setup: Setup) -> None:
        self._setup = setup
        self._peaks = [np.zeros(setup.parameters.panel_count)]
        self._times = [0.0]
        self._renderer: Renderer | None = None

    def add(self, state: m.State) -> None:
        """Take the peaks of the period that has ended."""
        self._peaks.append(state.joints["recent_peak_force"].copy())
        self._times.append(float(state.clock["time"][0]))

    def draw(self, simulation: Simulation, parameters: ArrayParameters) -> NDArray[np.uint8]:
        if self._renderer is None:
            task, folded = self._setup.task, self._setup.simulation(parameters)
            scene = _scene(folded, parameters, [0.0], [np.zeros(parameters.panel_count)])
            self._renderer = Renderer(scene, task.deadline + task.postlock_window)
        return self._renderer.draw(_scene(simulation, parameters, self._times, self._peaks))


def _level(model: str, elements: int, question: str | None, tolerance: float | None) -> tuple[str, int]:
    """Model and elements as given, or chosen by the ladder."""
    if model != "auto":
        if question is not None or tolerance is not None:
            raise ValueError(f"question and tolerance choose the model: they need model='auto', not {model!r}")
        return check_model(model), check_elements(elements)
    if elements != DEFAULT_ELEMENTS:
        raise ValueError(f"model='auto' chooses the elements too: leave out elements = {elements!r}, or name the model")
    chosen = cheapest(
        read_answers(),
        DEFAULT_QUESTION if question is None else question,
        DEFAULT_TOLERANCE if tolerance is None else tolerance,
    )
    return chosen.model, chosen.elements or DEFAULT_ELEMENTS


def _checked_ranges(parameters: ArrayParameters, ranges: Ranges) -> Ranges:
    """The ranges with both ends shown to be acceptable values, by joint where the parameter is."""
    checked: dict[str, tuple[Bound, Bound]] = {}
    for name, bounds in ranges.items():
        by_joint = name in ArrayParameters.BY_JOINT
        pair: Any = bounds
        if not hasattr(pair, "__len__") or len(pair) != 2:
            raise ValueError(f"randomize[{name!r}] = {bounds!r} must be a pair (low, high)")
        low, high = (_by_joint(bound, parameters.panel_count) if by_joint else bound for bound in pair)
        if not np.all(np.less_equal(low, high)):
            raise ValueError(f"randomize[{name!r}] = {bounds!r} must satisfy low <= high")
        for end in (low, high):
            parameters.with_changes({name: end})
        checked[name] = (low, high)
    return checked


def _by_joint(bound: Bound, joints: int) -> tuple[float, ...]:
    """An entry for every joint; the last one given holds for all further ones."""
    entries = np.atleast_1d(bound)
    return tuple(float(entries[min(j, len(entries) - 1)]) for j in range(joints))


def _scene(
    simulation: Simulation, parameters: ArrayParameters, times: list[float], peaks: list[NDArray[np.float64]]
) -> Scene:
    model, state = simulation.model, simulation.state
    loads = simulation.joint_loads()
    axes = [centreline(model, state.q, body) for body in range(parameters.panel_count + 1)]
    eccentricity = loads[:, [ECCENTRICITY_X, ECCENTRICITY_Y]]
    return Scene(
        time=simulation.time,
        main_body=main_body_corners(parameters, axes[0]),
        panels=tuple(axes[1:]),
        hinges=np.array([panel[0] for panel in axes[1:]]) - eccentricity,
        eccentricity=eccentricity,
        clearance=model.joints["clearance"].copy(),
        journal_radius=model.joints["journal_radius"].copy(),
        in_contact=state.joints["in_contact"].astype(np.bool_),
        normal_force=loads[:, NORMAL].copy(),
        latched=state.joints["latched"].astype(np.bool_),
        motor_torque=float(state.joints["motor_torque"][0]),
        force_times=np.array(times),
        force_history=np.array(peaks),
    )
