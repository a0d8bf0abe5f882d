"""SciPy's integrators on the project's own equations of motion, as a first-order system in coordinates and velocities.

The equations are those with the constraints differentiated twice (index 1). Nothing returns the solution to the
constraints, from which it drifts. The right-hand side switches at latchings and, with clearance, where
a contact starts or ends; there the integration stops at the event and starts anew.
"""

import math
import time as clock
from collections.abc import Callable
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.arrays.columns import ANGLE
from solar_env.mechanics.equations.system import accelerations, make_workspace
from solar_env.mechanics.joints.joint import joint_motion, penetration
from solar_env.mechanics.running.errors import SimulationError
from solar_env.mechanics.running.simulation import Simulation
from solar_env.studies.common.motion import Motion, Scene

Array = NDArray[np.float64]
_LATCH, _TOUCH, _PART = range(3)  # kinds of event
# A contact starts and ends this far [m] beyond the wall, so that the event that ended one leg never hides the next.
_HYSTERESIS = 1e-14
_FIRST_STEP = 1e-9  # s after a contact starts: SciPy's own choice steps over the contact


def run_scipy(scene: Scene, name: str, rtol: float) -> Motion:
    """A scene with one of SciPy's integrators.

    Args:
        scene: what moves.
        name: of a method of `scipy.integrate.solve_ivp`, for instance "DOP853" or "Radau".
        rtol: relative tolerance; the absolute one is rtol times 1 m for positions and times 0.1 m/s for velocities.

    Raises:
        SimulationError: if SciPy gives up.
    """
    system = _SwitchedSystem(scene)
    samples = scene.sample_times
    angles = np.full((len(samples), len(system.own.joints)), math.nan)
    time, state, first_step, factorizations = 0.0, system.start(), None, 0
    begin = clock.perf_counter()
    while time < scene.duration:
        leg = solve_ivp(
            system.rates,
            (time, scene.duration),
            state,
            method=name,
            t_eval=samples[samples >= time],
            events=system.events(),
            rtol=rtol,
            atol=rtol * system.scales,
            first_step=first_step,
        )
        if not leg.success:
            raise SimulationError(f"SciPy's {name} stopped: {leg.message}", time, "scipy")
        factorizations += leg.nlu
        for index, column in zip(np.searchsorted(samples, leg.t), np.transpose(leg.y), strict=True):
            angles[index] = system.joint_angles(samples[index], column)
        if leg.status == 0:
            time, state = scene.duration, leg.y[:, -1]
        else:
            which = next(k for k, roots in enumerate(leg.t_events) if len(roots))
            time, state = float(leg.t_events[which][0]), leg.y_events[which][0]
            started = system.switch(which, time, state)
            first_step = min(_FIRST_STEP, scene.duration - time) if started else None
    wall_time = clock.perf_counter() - begin
    return Motion(
        time=samples,
        angles=np.unwrap(angles, axis=0),
        latch_times=system.own.joints["latch_time"].copy(),
        wall_time=wall_time,
        evaluations=float(system.evaluations),
        factorizations=float(factorizations),
    )


class _SwitchedSystem:
    """The equations of motion between two events, and what changes at an event."""

    def __init__(self, scene: Scene) -> None:
        simulation = Simulation(scene.mechanism())
        self.model, self.own = simulation.model, simulation.state
        self.work = make_workspace(self.model, self.own)
        self.work.impact_speeds[:] = 0.0
        self.own.joints["stop_engaged"] = 1
        self.n = self.own.q.size
        self.scales = np.repeat([1.0, 0.1], self.n)
        self.evaluations = 0
        self._acceleration = np.zeros(self.n)
        self._multipliers = np.zeros_like(self.own.multipliers)
        self._watched: list[tuple[int, int]] = []  # joint and kind of every event

    def start(self) -> Array:
        """(2 n,) coordinates and velocities at t = 0."""
        return np.concatenate([self.own.q, self.own.v])

    def rates(self, time: float, state: Array) -> Array:
        """(2 n,) velocities and accelerations."""
        self.evaluations += 1
        self._evaluate(time, state)
        return np.concatenate([state[self.n :], self._acceleration])

    def _evaluate(self, time: float, state: Array) -> None:
        q, v = state[: self.n], state[self.n :]
        accelerations(self.model, self.own.joints, q, v, time, self.work, self._acceleration, self._multipliers)

    def joint_angles(self, time: float, state: Array) -> Array:
        """(joints,) [rad]."""
        self._evaluate(time, np.ascontiguousarray(state))
        return self.work.loads[:, ANGLE].copy()

    def events(self) -> list[Callable[[float, Array], float]]:
        """Event functions for `solve_ivp`: latchings, and starts or ends of contacts."""
        functions: list[Callable[[float, Array], float]] = []
        self._watched = []
        for j, (joint, own) in enumerate(zip(self.model.joints, self.own.joints, strict=True)):
            if joint["has_latch"] and not own["latched"]:
                functions.append(self._event(j, _LATCH))
            if joint["kind"] == m.CLEARANCE:
                functions.append(self._event(j, _PART if own["in_contact"] else _TOUCH))
        return functions

    def _event(self, j: int, kind: int) -> Callable[[float, Array], float]:
        joint, markers, n = self.model.joints[j], self.model.markers, self.n

        def past_lock(_: float, state: Array) -> float:
            return float(joint_motion(joint, markers, state[:n], state[n:])[0] - joint["lock_angle"])

        def depth(_: float, state: Array) -> float:
            return float(penetration(joint, markers, state[:n], state[n:])[0]) - threshold

        threshold = -_HYSTERESIS if kind == _PART else _HYSTERESIS
        function: Any = past_lock if kind == _LATCH else depth
        function.terminal, function.direction = True, -1.0 if kind == _PART else 1.0
        self._watched.append((j, kind))
        return cast("Callable[[float, Array], float]", function)

    def switch(self, which: int, time: float, state: Array) -> bool:
        """Change what the event changes; returns whether a contact has started."""
        j, kind = self._watched[which]
        own = self.own.joints[j]
        if kind == _LATCH:
            own["latched"], own["latch_time"] = 1, time
        elif kind == _TOUCH:
            joint = self.model.joints[j]
            _, rate = penetration(joint, self.model.markers, state[: self.n], state[self.n :])
            own["in_contact"] = 1
            own["impact_speed"] = max(rate, joint["minimum_impact_speed"])
            self.work.impact_speeds[j] = own["impact_speed"]
        else:
            own["in_contact"] = 0
            self.work.impact_speeds[j] = 0.0
        return kind == _TOUCH
