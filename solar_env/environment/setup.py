"""What all episodes of an environment share: the array and what is drawn of it, the task, sensors and motor."""

from __future__ import annotations

import math
from collections.abc import Mapping
from copy import copy
from numbers import Real
from typing import Any

import gymnasium
import numpy as np

from solar_env.array import DEFAULT_ELEMENTS, ArrayParameters, build, check_elements, check_model
from solar_env.array.ladder import DEFAULT_QUESTION, DEFAULT_TOLERANCE, cheapest, read_answers
from solar_env.array.methods import default_integrator
from solar_env.environment.hardware import Hardware
from solar_env.environment.scenarios import Bound, Ranges, scenario_named
from solar_env.environment.sensors import Sensors
from solar_env.environment.task import Task, observation_entries
from solar_env.mechanics.running.simulation import Simulation

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

    def check_changes(self, design: ArrayParameters, changes: Changes) -> None:
        """Check changes of the parameters of one episode, before anything is drawn.

        Raises:
            ValueError: for unknown parameters, refused values, or values that change the mechanism's structure.
        """
        if not isinstance(changes, Mapping):
            raise ValueError(f"options['parameters'] = {changes!r} must be a mapping of names to values")
        if not changes:
            return
        changed = design.with_changes(changes)
        for name in ArrayParameters.STRUCTURAL:
            if getattr(changed, name) != getattr(design, name):
                raise ValueError(
                    f"{name} = {getattr(changed, name)!r} changes the mechanism's structure, here with {name} = "
                    f"{getattr(design, name)!r}; set it when the environment is made"
                )

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
        return design.with_changes({**drawn, **changes})

    def simulation(self, parameters: ArrayParameters) -> Simulation:
        """A folded array at rest."""
        return Simulation(build(parameters, self.model, self.elements), default_integrator(self.model))


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
        parameters.check_name(name)
        if name not in ArrayParameters.CONTINUOUS:
            raise ValueError(f"randomize[{name!r}]: {name} is not a real number and cannot be drawn")
        pair: Any = bounds
        if not hasattr(pair, "__len__") or len(pair) != 2:
            raise ValueError(f"randomize[{name!r}] = {bounds!r} must be a pair (low, high)")
        by_joint = name in ArrayParameters.BY_JOINT
        low, high = (_checked_bound(name, bound, parameters.panel_count if by_joint else None) for bound in pair)
        if not np.all(np.less_equal(low, high)):
            raise ValueError(f"randomize[{name!r}] = {bounds!r} must satisfy low <= high")
        for end in (low, high):
            parameters.with_changes({name: end})
        checked[name] = (low, high)
    # Draws of several parameters may meet at any corner; these are the ones at which two of them can contradict.
    lows, highs = ({name: pair[end] for name, pair in checked.items()} for end in (0, 1))
    corners = [lows, highs] + [
        {**lows, small: highs[small]} for small in ArrayParameters.BELOW_ANOTHER if small in highs
    ]
    for corner in corners:
        parameters.with_changes(corner)
    return checked


def _checked_bound(name: str, bound: Any, joints: int | None) -> Bound:
    """A bound as a number, or with an entry for each of ``joints``: the last one given holds for all further ones."""
    entries = bound if isinstance(bound, (tuple, list, np.ndarray)) else (bound,)
    for entry in entries:
        if isinstance(entry, bool) or not isinstance(entry, Real) or not math.isfinite(entry):
            raise ValueError(f"randomize[{name!r}]: the bound {bound!r} must be a finite number")
    if joints is None:
        if len(entries) != 1 or entries is bound:
            raise ValueError(f"randomize[{name!r}]: the bound {bound!r} must be a single number")
        return float(bound)
    if not 1 <= len(entries) <= joints:
        raise ValueError(f"randomize[{name!r}]: the bound {bound!r} must have 1 to {joints} entries, one a joint")
    return tuple(float(entries[min(j, len(entries) - 1)]) for j in range(joints))
