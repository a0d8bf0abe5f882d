"""Frames of an episode: pictures of the array in its present state, with the peak forces so far."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from solar_env.array import ArrayParameters, main_body_corners
from solar_env.array.parameters.parameters import MAIN_BODY
from solar_env.environment.settings import EnvironmentSettings
from solar_env.mechanics.analysis.geometry import centreline
from solar_env.mechanics.arrays.columns import ECCENTRICITY_X, ECCENTRICITY_Y, NORMAL
from solar_env.mechanics.running.simulation import Simulation
from solar_env.pictures.frame import Renderer, Scene


class Film:
    """A history of the peak joint forces in an episode, and the renderer that draws the array with this history."""

    def __init__(self, settings: EnvironmentSettings) -> None:
        self._settings = settings
        self._peaks = [np.zeros(len(settings.array.joints))]
        self._times = [0.0]
        self._renderer: Renderer | None = None

    def __getstate__(self) -> dict[str, object]:
        """Return the attributes for copies and pickles, without the renderer; a copy makes its own renderer."""
        return {**vars(self), "_renderer": None}

    def add(self, state: Any) -> None:
        """Append each joint's peak force in the control period that ends with the simulation state `state`."""
        self._forget(np.nextafter(state.clock["time"][0], 0.0))
        self._peaks.append(state.joints["recent_peak_force"].copy())
        self._times.append(float(state.clock["time"][0]))

    def _forget(self, time: float) -> None:
        """Discard the peak forces recorded after `time` [s], because a state of that time was restored."""
        while self._times[-1] > time:
            del self._times[-1], self._peaks[-1]

    def draw(self, simulation: Simulation, parameters: ArrayParameters) -> NDArray[np.uint8]:
        """Return a frame (540, 960, 3) uint8 that shows a simulation's present state and the peak forces so far."""
        self._forget(simulation.time)
        if self._renderer is None:
            task, folded = self._settings.task, self._settings.simulation(parameters)
            self._renderer = Renderer(self._scene(folded, parameters), task.deadline + task.settling_window)
        return self._renderer.draw(self._scene(simulation, parameters))

    def _scene(self, simulation: Simulation, parameters: ArrayParameters) -> Scene:
        """Return the `Scene` that a frame shows: the simulation's present state, and the peak forces so far."""
        model, state, loads = simulation.model, simulation.state, simulation.joint_loads()
        bodies = (MAIN_BODY, *(joint.panel for joint in parameters.joints))
        axes = [centreline(model, state.q, body) for body in bodies]
        eccentricity = loads[:, [ECCENTRICITY_X, ECCENTRICITY_Y]]
        return Scene(
            time=simulation.time,
            main_body=main_body_corners(parameters, axes[0]),
            panels=tuple(axes[1:]),
            hinges=np.array([panel[0] for panel in axes[1:]]) - eccentricity,
            eccentricity=eccentricity,
            clearance=model.joints["clearance"].copy(),
            in_contact=state.joints["in_contact"].astype(np.bool_),
            normal_force=loads[:, NORMAL].copy(),
            latched=state.joints["latched"].astype(np.bool_),
            motor_torques=tuple(state.joints["motor_torque"][list(self._settings.task.driven_joints)].tolist()),
            force_times=np.array(self._times),
            force_history=np.array(self._peaks),
            wings=parameters.wings,
        )
