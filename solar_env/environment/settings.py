"""The keywords of the environments: names, defaults and checks, and the objects that episodes derive from them."""

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any, Self

import gymnasium
import numpy as np

from solar_env.array import ArrayParameters, ModelLevel, build
from solar_env.array.methods import default_integrator
from solar_env.array.parameters.ranges import Ranges, checked_ranges, drawn
from solar_env.environment.hardware import OF_THE_LOOP, Hardware
from solar_env.environment.scenarios import SCENARIOS
from solar_env.environment.task.drive import spring_load, task_numbers
from solar_env.environment.task.observations import Entry, Names, observation_entries
from solar_env.environment.task.reward import Reward, RewardFunction
from solar_env.environment.task.sensors import Sensors
from solar_env.environment.task.task import CURRENT_VERSION, VERSIONS, Task
from solar_env.mechanics.integrators.settings import Integrator
from solar_env.mechanics.running.simulation import Simulation
from solar_env.support.values import changed, check_name, plain, unknown_name

RENDER_MODES = ("human", "rgb_array")
Changes = Mapping[str, Any]


@dataclass(frozen=True)
class EnvironmentSettings:
    """The keywords of `gymnasium.make` and `gymnasium.make_vec` that describe an environment.

    Attributes:
        model: level of fidelity: "rigid-clearance", "rigid-ideal", "flexible-clearance" or "flexible-ideal". Flexible
            levels may state their discretisation, as in "flexible-clearance:8 modes" (up to 200; 32 by default) or
            "flexible-ideal:6 elements" (1 to 1000). With ideal joints, joint reactions replace contact forces and
            nothing wears. `solar_env.cheapest_level("controller-ranking", 0.2)` names the cheapest level that ranks at
            most 20 % of the pairs of controllers wrongly.
        parameters: an `ArrayParameters`, or a mapping of changes to the scenario's parameters.
        version: version of the task, which sets the defaults of the keywords below: limits and times, observation,
            action, feedback loop of the drive, and scales and weights of the reward.
        torque_limit, control_period, deadline, settling_window, driven_joint, action: see `task.task.Task`.
        observation: "scaled", "drive", "history" or "privileged" (lists of observables in `SolarArrayEnv`'s docstring);
            or a list such as `["theta", "rate", "rate_1_ago", "time_to_deadline"]`, where "rate_1_ago" is the rate one
            control period ago. A list may also contain the four names, each for all its observables.
        reward: changes to the version's reward, by term: a weight, or a mapping of "scale", "weight", "bound" and
            "form". With x = min(quantity / scale, bound) the term costs weight * x in the form "linear", and weight *
            log10(1 + x) in the form "decades". Or a function, `solar_env.environment.task.reward.RewardFunction`.
        scenario: "nominal" or "randomised"; `parameters`, `randomize` and `hardware` change the scenario's values.
        randomize: mapping of parameter names to bounds (low, high) instead of the scenario's ranges, which surround
            the array's own values. Each reset samples uniformly: by joint if a bound is a sequence by joint, and always
            by joint for springs, clearances and initial rates.
        hardware: a `solar_env.Hardware`, or a mapping of changes to the scenario's hardware.
        render_mode: "rgb_array", "human" (a window, only for a single environment) or None.
        max_steps: greatest number of integration steps, with rejected ones, in one control period; hundreds are usual.

    Raises:
        ValueError: on construction, for an unknown name or a refused value; the message says which.
    """

    model: str = "rigid-clearance"
    parameters: ArrayParameters | Changes | None = None
    version: str = CURRENT_VERSION
    torque_limit: float | None = None
    control_period: float | None = None
    deadline: float | None = None
    settling_window: float | None = None
    driven_joint: int | tuple[int, ...] = Task.driven_joint
    action: str | None = None
    observation: str | Names | None = None
    reward: Changes | RewardFunction | None = None
    scenario: str = "nominal"
    randomize: Ranges | None = None
    hardware: Hardware | Changes | None = None
    render_mode: str | None = None
    max_steps: int = 1_000_000

    def __post_init__(self) -> None:
        if self.render_mode not in (None, *RENDER_MODES):
            raise ValueError(f"render_mode {self.render_mode!r} is unknown; choose {', '.join(RENDER_MODES)} or None")
        # These properties follow from the keywords; reading them refuses bad values.
        for name, table in (("scenario", SCENARIOS), ("version", VERSIONS)):
            check_name(f"the {name}", getattr(self, name), table)
        for name in ("level", "integrator", "array", "ranges", "devices", "task", "entries", "terms"):
            getattr(self, name)
        build(self.array, self.level)  # raises an error if parameters do not fit the kind of panels

    @classmethod
    def of(cls, keywords: Changes) -> Self:
        """Make settings from keywords; the keyword `scenario` sets defaults. An unknown keyword raises a TypeError."""
        known = [item.name for item in fields(cls)]
        for name in keywords:
            if name not in known:
                of_array = name in vars(ArrayParameters())
                hint = f"; of the array it is one of parameters={{{name!r}: ...}}" if of_array else ""
                raise TypeError(unknown_name("the environment's keyword", name, known) + hint)
        given = cls(**keywords)
        model, array, ranges = str(given.level), given.array, given.ranges
        return replace(given, model=model, parameters=array, randomize=ranges, hardware=given.devices)

    @cached_property
    def level(self) -> ModelLevel:
        """Model level that the keyword `model` names, such as "rigid-clearance"."""
        return ModelLevel.of(self.model)

    @cached_property
    def integrator(self) -> Integrator:
        """Default integrator of the model level, limited to `max_steps` integration steps per control period."""
        return replace(default_integrator(self.level), max_steps=self.max_steps)

    @property
    def frames_per_second(self) -> int:
        """Control periods per second [1/s], rounded to a whole number, at least 1, as Gymnasium's `play` needs."""
        return max(round(1.0 / self.task.control_period), 1)

    @cached_property
    def array(self) -> ArrayParameters:
        """Array parameters before random sampling: the given set, or the scenario's set with the given changes."""
        usual, given = SCENARIOS[self.scenario].parameters, self.parameters
        return given if isinstance(given, ArrayParameters) else usual.with_changes(given or {})

    @property
    def structure(self) -> dict[str, object]:
        """Structural parameters by name, which determine the number of coordinates and state variables."""
        return {name: getattr(self.array, name) for name in ArrayParameters.STRUCTURAL}

    @cached_property
    def ranges(self) -> Ranges:
        """Range (low, high) of each sampled parameter by name; bounds are tuples if joints are sampled separately."""
        if self.randomize is not None:
            return checked_ranges(self.array, self.randomize)
        try:
            return checked_ranges(self.array, SCENARIOS[self.scenario].ranges(self.array))
        except ValueError as error:
            raise ValueError(f"scenario={self.scenario!r} draws around the array's parameters: {error}") from error

    @cached_property
    def devices(self) -> Hardware:
        """Hardware of the scenario, changed by the version of the task and by the keyword `hardware`."""
        if isinstance(self.hardware, Hardware):
            return self.hardware
        version = VERSIONS[self.version]
        of_version = {**version.hardware, **({} if self.level.flexible else version.rigid_hardware)}
        usual = changed("hardware", SCENARIOS[self.scenario].hardware, of_version)
        return changed("hardware", usual, self.hardware or {})

    @cached_property
    def task(self) -> Task:
        """The control task: limits, times, action and driven joints, with defaults from the version of the task."""
        given = {item.name: plain(getattr(self, item.name, None)) for item in fields(Task)}
        usual = VERSIONS[self.version].task
        task = replace(usual, **{name: value for name, value in given.items() if value is not None})
        if max(task.driven_joints) >= len(self.array.joints):
            joints = "panel_count" if self.array.wings == 1 else "panel_count * wings"
            raise ValueError(
                f"driven_joint = {task.driven_joint!r} must be below {joints} = {self.array.joint_count}: the root has "
                "index 0"
            )
        if self.torque_limit is None and self.devices.load_compensation:
            # A drive that compensates the springs' load has a motor sized for that load.
            load, driven = max((spring_load(self.array, joint)[0], joint) for joint in task.driven_joints)
            usual_load, _ = spring_load(ArrayParameters(), 0)
            if load <= 0.0:
                raise ValueError(
                    f"the springs exert {load:.3g} N m on joint {driven + 1}, folded, and do not open it: "
                    "give torque_limit, which otherwise follows from their load"
                )
            task = replace(task, torque_limit=task.torque_limit * load / usual_load)
        of_loop = [name for name in self.hardware if name in OF_THE_LOOP] if isinstance(self.hardware, Mapping) else []
        if of_loop and not task.has_loop:
            raise ValueError(
                f"hardware[{of_loop[0]!r}] is of the drive's rate loop, which action = {task.action!r} of version "
                f"{self.version!r} leaves out"
            )
        task.samples(self.devices)  # raises an error unless a control period is a whole number of samples
        return task

    @cached_property
    def entries(self) -> tuple[Entry, ...]:
        """Descriptions of the observation's entries in order: observable, joint or motor, age in control periods."""
        observation = VERSIONS[self.version].observation if self.observation is None else self.observation
        return observation_entries(len(self.array.joints), observation, self.task.driven_joints)

    @property
    def observation_names(self) -> tuple[str, ...]:
        """Names of the observation's entries, in order."""
        return tuple(entry.name for entry in self.entries)

    @cached_property
    def terms(self) -> Reward:
        """The reward: its terms, each with scale, weight, bound and form, or the user's function."""
        return Reward(self.reward, VERSIONS[self.version])

    @cached_property
    def conditions(self) -> dict[str, object]:
        """Settings other than array parameters, by name, that must be equal for a saved episode to continue here."""
        known = {"model": str(self.level), "observation": self.observation_names, "reward": self.terms.prices}
        numbers = task_numbers(self.task, self.devices, self.array)
        drive = {name: numbers.motors[name].tolist() for name in ("load", "load_slope")}
        return {**known, **vars(self.task), **vars(self.devices), **drive, "sample_period": numbers.sample_period}

    def sensors(self, lanes: int) -> Sensors:
        """Return the sensors of the drives for a batch of `lanes` environments."""
        lock_angles = [joint.lock_angle for joint in self.array.joints]
        return Sensors(lanes, lock_angles, self.entries, self.devices)

    def observation_space(self) -> gymnasium.Space[Any]:
        """Return the Gymnasium space of a single environment's observations."""
        bounds = [(entry.observable.low, entry.observable.high) for entry in self.entries]
        return gymnasium.spaces.Box(*np.array(bounds, dtype=np.float32).T, dtype=np.float32)

    def action_space(self) -> gymnasium.Space[Any]:
        """Return the Gymnasium space of a single environment's actions."""
        return gymnasium.spaces.Box(-1.0, 1.0, (len(self.task.driven_joints),), dtype=np.float32)

    def check_options(self, options: Changes | None, *known: str) -> Changes:
        """Check the options of a reset and return them; an option not among `known` raises a ValueError."""
        if not isinstance(options, Mapping | None):
            raise ValueError(f"options = {options!r} must be a mapping of names to values")
        for name in options or {}:
            check_name("the reset option", name, known)
        return options or {}

    def check_changes(self, changes: Changes) -> None:
        """Raise a ValueError if an episode cannot have these changes of parameters, given by name.

        A change is refused if it is invalid, alters the mechanism's structure, or is inconsistent with a value that may
        be drawn for another parameter.
        """
        if not isinstance(changes, Mapping):
            raise ValueError(f"options['parameters'] = {changes!r} must be a mapping of names to values")
        after = self.array.with_changes(changes)
        checked_ranges(after, {name: pair for name, pair in self.ranges.items() if name not in changes})
        if changes:
            build(after, self.level)
        for name, old in self.structure.items():
            if (new := getattr(after, name)) != old:
                raise ValueError(
                    f"{name} = {new!r} changes the mechanism's structure, here with {name} = {old!r}; set it when the "
                    "environment is made"
                )

    def draw(self, generator: np.random.Generator, changes: Changes) -> ArrayParameters:
        """Sample the array parameters of one episode; `changes`, by name, replace sampled values."""
        return self.array.with_changes({**drawn(self.ranges, generator), **changes})

    def simulation(self, parameters: ArrayParameters) -> Simulation:
        """Return a simulation of the folded array at t = 0."""
        return Simulation(build(parameters, self.level), self.integrator)
