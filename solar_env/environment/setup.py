"""What all episodes of an environment share: the array and what is drawn of it, the task, sensors and motor."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import gymnasium
import numpy as np

from solar_env.array import ArrayParameters, build
from solar_env.array.methods import default_integrator
from solar_env.environment.hardware import Hardware
from solar_env.environment.sensors import Sensors
from solar_env.environment.settings import EnvironmentSettings
from solar_env.mechanics.running.simulation import Simulation

Changes = Mapping[str, Any]


class Setup:
    """What all episodes share: model, parameters and their ranges, the task, what is observed.

    Args:
        settings: the keywords of the environment.

    Attributes:
        settings: the same.
        model, elements: of the array; "auto" has been replaced by what it stands for.
        parameters: before anything is drawn.
        randomize: parameter -> (low, high), by joint where the parameter is.
        hardware: sensors and motor.
        task: limits, durations and the driven joint.
        reward: terms and their prices.
        observation_names: of the entries of an observation, in order.
    """

    def __init__(self, settings: EnvironmentSettings) -> None:
        self.settings = settings
        self.model, self.elements = settings.level
        self.parameters, self.randomize, self.hardware = settings.array, settings.ranges, settings.drive
        self.task, self.reward = settings.task, settings.prices
        self.observation_names = tuple(entry.name for entry in settings.entries)

    def sensors(self, lanes: int) -> Sensors:
        """The sensors of several arrays."""
        joints = range(self.parameters.panel_count)
        lock_angles = [self.parameters.lock_angle(j) for j in joints]
        return Sensors(lanes, lock_angles, self.settings.entries, self.hardware)

    def observation_space(self) -> gymnasium.Space[Any]:
        """Space of one observation."""
        bounds = [(entry.observable.low, entry.observable.high) for entry in self.settings.entries]
        return gymnasium.spaces.Box(*np.array(bounds, dtype=np.float32).T, dtype=np.float32)

    def action_space(self) -> gymnasium.Space[Any]:
        """Space of one action."""
        return gymnasium.spaces.Box(-1.0, 1.0, (1,), dtype=np.float32)

    def with_exact_observations(self) -> Setup:
        """The same with perfect sensors that show the entries of the observation "drive"; the motor stays as it is."""
        motor = Hardware(motor_lag=self.hardware.motor_lag, torque_rate_limit=self.hardware.torque_rate_limit)
        return Setup(replace(self.settings, hardware=motor, observation="drive"))

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
