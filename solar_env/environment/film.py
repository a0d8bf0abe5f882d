"""Frames of an episode: the array as it is, and the force peaks so far."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from solar_env.array import ArrayParameters, main_body_corners
from solar_env.environment.setup import Setup
from solar_env.mechanics.analysis.geometry import centreline
from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.joints.joint import ECCENTRICITY_X, ECCENTRICITY_Y, NORMAL
from solar_env.mechanics.running.simulation import Simulation
from solar_env.pictures.render import Renderer
from solar_env.pictures.scene import Scene


class Film:
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
        """The frame of the present state; (540, 960, 3) uint8."""
        if self._renderer is None:
            task, folded = self._setup.task, self._setup.simulation(parameters)
            scene = _scene(folded, parameters, task.driven_joint, [0.0], [np.zeros(parameters.panel_count)])
            self._renderer = Renderer(scene, task.deadline + task.postlock_window)
        driven = self._setup.task.driven_joint
        return self._renderer.draw(_scene(simulation, parameters, driven, self._times, self._peaks))


def _scene(
    simulation: Simulation,
    parameters: ArrayParameters,
    driven_joint: int,
    times: list[float],
    peaks: list[NDArray[np.float64]],
) -> Scene:
    """The scene of a simulation, with force peaks (joints,) at the times given."""
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
        motor_torque=float(state.joints["motor_torque"][driven_joint]),
        force_times=np.array(times),
        force_history=np.array(peaks),
    )
