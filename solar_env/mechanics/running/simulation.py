"""Running a mechanism from Python: `Simulation` for step-by-step use, `simulate` for a whole run."""

import math
import time
from collections.abc import Callable
from dataclasses import asdict
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.arrays.lanes import with_lane_axis
from solar_env.mechanics.equations.build import compile_mechanism
from solar_env.mechanics.equations.constraints import constraint_drift, velocity_drift
from solar_env.mechanics.equations.system import accelerations, applied_forces, make_workspace, stored_energies
from solar_env.mechanics.integrators.driver import advance_lanes
from solar_env.mechanics.integrators.methods.table import method_of
from solar_env.mechanics.integrators.recording import RECORDED_LOADS, Recorder, make_recorder, sample_columns
from solar_env.mechanics.integrators.settings import Integrator, RungeKutta
from solar_env.mechanics.joints import joint as columns
from solar_env.mechanics.mechanism.description import Mechanism
from solar_env.mechanics.running.accuracy import AccuracyWatch, limits_of_the_laws
from solar_env.mechanics.running.errors import raise_for_status
from solar_env.mechanics.running.in_motion import InMotion
from solar_env.mechanics.running.trajectory import Trajectory, contact_record

_CONTACTS_PER_DRAIN = 4096
_PROGRESS_CALLS = 20
_SMALLEST_ENERGY_SCALE = 1e-9  # J, for a mechanism that starts without energy


class Simulation(InMotion[m.State]):
    """A mechanism in motion.

    `state` is a named tuple of arrays; `snapshot` and `restore` copy it, in the middle of a contact
    too, and a restored simulation continues to the same bits.
    """

    def __init__(self, mechanism: Mechanism, integrator: Integrator | None = None) -> None:
        """Compile `mechanism` and check that its initial state meets the constraints.

        Raises:
            ValueError: if positions or velocities violate a constraint, if the integrator is none, or if it takes no
                drives and the mechanism has some.
        """
        self.integrator: Integrator = RungeKutta() if integrator is None else integrator
        method_of(self.integrator)
        if mechanism.drives and not self.integrator.takes_drives:
            raise ValueError(
                f"the integrator {self.integrator.name!r} takes no drives; use RungeKutta or GeneralizedAlpha"
            )
        self.model, self.state = compile_mechanism(mechanism)
        self._check_initial_state()
        self._engage_stops()
        energies = self.stored_energies()
        self.state.clock["initial_energy"] = energies.sum()
        self.state.clock["energy_scale"] = max(np.abs(energies).sum(), _SMALLEST_ENERGY_SCALE)
        self._unrecorded = make_recorder(self.model, self.state, np.zeros(0), 0)
        self._watch = AccuracyWatch(self)

    def _check_initial_state(self) -> None:
        work = make_workspace(self.model, self.state)
        for quantity, unit, value in (
            ("position", "m", constraint_drift(self.model, self.state.q, self.time, work)),
            ("velocity", "m/s", velocity_drift(self.model, self.state.q, self.state.v, self.time, work)),
        ):
            if not value < 1e-9 * max(self.model.length_scale, 1.0):
                raise ValueError(
                    f"the initial {quantity} violates a constraint by {value:.3g} {unit}; place the bodies so that "
                    "joints, guides and drives are met"
                )

    def __getstate__(self) -> dict[str, Any]:
        """For copies and pickles: without arrays that share their memory with the state; those of a copy would not."""
        return {name: value for name, value in vars(self).items() if name != "_lane"}

    def snapshot(self) -> m.State:
        """An independent copy of the state, which can be pickled."""
        return m.copy_state(self.state)

    def move_to(self, model: m.Model, state: m.State) -> None:
        """Go on with other arrays, which hold the same values."""
        self.model, self.state = model, state
        self.__dict__.pop("_lane", None)

    def advance(self, end_time: float, recorder: Recorder | None = None) -> None:
        """Advance to `end_time` [s], landing on it.

        Every 10,000 steps the accuracy is looked at, as `check` does at any time; with generalized-alpha also the
        latest impacts in every call, and constraint forces in the first calls.

        Raises:
            ValueError: if `end_time` is not finite or lies before the present time.
            SimulationError: if the run cannot go on; the state stays at the last accepted step.

        Warns:
            SimulationWarning: as `check`.
        """
        self._check_end_time(end_time)
        self.raise_unless_done(self._advance(end_time, recorder or self._unrecorded))
        self._watch.after_call()

    def raise_unless_done(self, status: int) -> None:
        """Raise the `SimulationError` of a status code with which a kernel has left this state, if any."""
        if status != m.DONE:
            clock = self.state.clock[0]
            raise_for_status(status, self.time, int(clock["failure_joint"]), float(clock["failure_value"]))

    def check(self) -> None:
        """Look at the accuracy of the run so far; every shortcoming is told once.

        Warns:
            SimulationWarning: if the energy book is open by more than 1 % of the energy turned over; if multipliers of
                generalized-alpha are off the constraint forces by more than 10 % of the largest force; if its fixed
                step does not resolve the latest impact of a joint.
        """
        self._watch.check()

    @cached_property
    def _lane(self) -> tuple[m.Model, m.State, dict[str, Any]]:
        """Model and state as those of a single lane, and scratch arrays by the name of a method."""
        return with_lane_axis(self.model), with_lane_axis(self.state), {}

    def _advance(self, end_time: float, recorder: Recorder) -> int:
        method = method_of(self.integrator)
        models, states, scratch = self._lane
        if self.integrator.name not in scratch:
            scratch[self.integrator.name] = method.arrays(self.model, self.state)
        queue, counter, status = np.zeros(1, np.int64), np.zeros(1, np.int64), np.zeros(1, np.int64)
        settings, end_times = method.convert(self.integrator), np.array([end_time], np.float64)
        arrays = scratch[self.integrator.name]
        advance_lanes(models, states, settings, recorder, queue, counter, end_times, status, arrays)
        return int(status[0])

    def _evaluate(self) -> tuple[Any, NDArray[np.float64]]:
        """Workspace with loads and powers at the present state, and the multipliers that hold its constraints."""
        state = self.state
        work = make_workspace(self.model, state)
        work.impact_speeds[:] = np.where(state.joints["in_contact"], state.joints["impact_speed"], 0.0)
        scratch, multipliers = np.zeros_like(state.a), np.zeros_like(state.multipliers)
        accelerations(self.model, state.joints, state.q, state.v, self.time, work, scratch, multipliers)
        return work, multipliers

    def joint_loads(self) -> NDArray[np.float64]:
        """(joints, columns) table of angles, rates, forces and torques now; columns are named in `joint.py`."""
        return self._evaluate()[0].loads[:, :RECORDED_LOADS]

    def stored_energies(self) -> NDArray[np.float64]:
        """(ENERGIES,) stored energies now [J], in the order of `model.ENERGY_NAMES`."""
        energies = np.zeros(m.ENERGIES)
        work, _ = self._evaluate()
        stored_energies(self.model, self.state.joints, self.state.q, self.state.v, work.loads, energies)
        return energies

    def energy_residual(self) -> float:
        """Energy now that the books do not account for [J]."""
        return self.energy_book()[0]

    def energy_book(self) -> tuple[float, float]:
        """Energy now that the books do not account for, and the energy that the run turned over so far [J].

        The latter is what was stored at the start, or what is stored now and was lost; weight counts with its work over
        the longest body, so that a pendulum which rests for a moment has turned some over too.
        """
        integrals = self.state.integrals
        by_joint = m.joint_integrals(integrals).sum(axis=0)
        put_in = by_joint[m.MOTOR_WORK] + by_joint[m.CABLE_WORK] + integrals[m.EXTERNAL_WORK]
        lost = by_joint[[m.NORMAL_DISSIPATION, m.FRICTION_DISSIPATION, m.STOP_DISSIPATION]].sum()
        lost += integrals[m.MATERIAL_DISSIPATION]
        stored = self.stored_energies()
        weight = np.abs(self.model.constant_force).max(initial=0.0) * self.model.length_scale
        clock = self.state.clock[0]
        turned_over = float(np.abs(stored[: m.GRAVITY]).sum() + abs(lost))
        return (
            float(stored.sum() - clock["initial_energy"] - put_in + lost),
            max(float(clock["energy_scale"]), turned_over) + float(weight),
        )

    def constraint_force_defect(self) -> tuple[float, float]:
        """Greatest difference of a multiplier from the one that holds its constraint, and the greatest force [N].

        Multipliers of a rigid body's length count times the length. The greatest force is at least the one that turns
        over the run's energy within the longest body, lest rounding be measured by rounding.
        """
        state = self.state
        work, multipliers = self._evaluate()
        scale = np.ones_like(multipliers)
        scale[self.model.constraints.target.size :] = self.model.bodies["length"]
        applied_forces(self.model, state.joints, state.q, state.v, work)
        largest = max(
            np.abs(scale * multipliers).max(initial=0.0),
            np.abs(work.force).max(initial=0.0),
            self.energy_book()[1] / self.model.length_scale,
        )
        return float(np.abs(scale * (state.multipliers - multipliers)).max(initial=0.0)), float(largest)


def simulate(
    mechanism: Mechanism,
    duration: float,
    *,
    integrator: Integrator | None = None,
    output_step: float = 0.01,
    progress: Callable[[float], None] | None = None,
    metadata: dict[str, Any] | None = None,
) -> Trajectory:
    """Simulate a mechanism from rest of its clock for `duration` and keep samples every `output_step`.

    Args:
        mechanism: what moves.
        duration: [s].
        integrator: defaults to `RungeKutta`.
        output_step: distance of the samples [s]; independent of the integration step.
        progress: called with the simulated time [s] now and then; the result does not depend on it.
        metadata: further entries of the trajectory's metadata.

    Raises:
        ValueError: if duration or output_step is not positive and finite.
        SimulationError: if the run cannot go on.

    Warns:
        SimulationWarning: if the result is less accurate than it looks, see `Simulation.check`.
    """
    for name, value in (("duration", duration), ("output_step", output_step)):
        if not 0.0 < value < math.inf:
            raise ValueError(f"{name} = {value!r} s must be positive and finite")
    simulation = Simulation(mechanism, integrator)
    times = np.append(np.arange(math.ceil(duration / output_step - 1e-9)) * output_step, duration)
    recorder = make_recorder(simulation.model, simulation.state, times, _CONTACTS_PER_DRAIN)
    contacts: list[NDArray[np.float64]] = []
    start = time.perf_counter()
    status = m.PAUSED
    while status == m.PAUSED:
        if progress:
            recorder.pause[0] = simulation.time + duration / _PROGRESS_CALLS
        status = simulation._advance(duration, recorder)
        contacts.append(recorder.contacts[: recorder.filled[1]].copy())
        recorder.filled[1] = 0
        if progress:
            progress(simulation.time)
    simulation.raise_unless_done(status)
    wall = time.perf_counter() - start
    details = {**(metadata or {}), "integrator": simulation.integrator.name, "wall_time_s": wall}
    table = _contact_table(simulation.state, np.concatenate(contacts))
    simulation._watch.check_impacts(table)
    simulation.check()
    return _assemble(simulation, recorder, table, details)


def _assemble(
    simulation: Simulation, recorder: Recorder, contacts: NDArray[np.void], metadata: dict[str, Any]
) -> Trajectory:
    model, state = simulation.model, simulation.state
    table, joints = recorder.samples, model.joints.size
    slices = sample_columns(model, state)
    loads = table[:, slices["loads"]].reshape(len(table), joints, RECORDED_LOADS)
    integrals = table[:, slices["integrals"]]
    by_joint = m.joint_integrals(integrals)
    eccentricity = loads[:, :, [columns.ECCENTRICITY_X, columns.ECCENTRICITY_Y]]
    clearance = model.joints["clearance"].copy()
    penetration = np.hypot(eccentricity[..., 0], eccentricity[..., 1]) - clearance
    normal, tangential = loads[:, :, columns.NORMAL].copy(), loads[:, :, columns.TANGENTIAL].copy()
    energies = {name: table[:, slices["energies"]][:, k] for k, name in enumerate(m.ENERGY_NAMES)}
    stored = sum(energies.values())
    totals = by_joint.sum(axis=1)
    put_in = {
        "motor_work": totals[:, m.MOTOR_WORK],
        "cable_work": totals[:, m.CABLE_WORK],
        "external_work": integrals[:, m.EXTERNAL_WORK],
    }
    lost = {
        "contact_dissipation": totals[:, m.NORMAL_DISSIPATION],
        "friction_dissipation": totals[:, m.FRICTION_DISSIPATION],
        "latch_dissipation": totals[:, m.STOP_DISSIPATION],
        "material_dissipation": integrals[:, m.MATERIAL_DISSIPATION],
    }
    residual = stored - state.clock["initial_energy"][0] - sum(put_in.values()) + sum(lost.values())
    final = m.joint_integrals(state.integrals)
    locked = state.clock["latched_joints"][0] > 0
    clock = state.clock[0]
    return Trajectory(
        time=recorder.times,
        coordinates=table[:, slices["q"]].copy(),
        velocities=table[:, slices["v"]].copy(),
        angles=np.unwrap(loads[:, :, columns.ANGLE], axis=0),
        rates=loads[:, :, columns.RATE].copy(),
        eccentricity=eccentricity,
        penetration=penetration,
        normal_force=normal,
        tangential_force=tangential,
        joint_force=loads[:, :, [columns.FORCE_X, columns.FORCE_Y]],
        spring_torque=loads[:, :, columns.SPRING_TORQUE].copy(),
        cable_torque=loads[:, :, columns.CABLE_TORQUE].copy(),
        latch_torque=loads[:, :, columns.STOP_TORQUE].copy(),
        motor_torque=loads[:, :, columns.MOTOR_TORQUE].copy(),
        energies={**energies, **put_in, **lost, "residual": residual},
        sliding_work=by_joint[:, :, m.SLIDING_WORK].copy(),
        impulse=by_joint[:, :, m.IMPULSE].copy(),
        wear_journal=state.wear_journal.copy(),
        wear_bearing=state.wear_bearing.copy(),
        contacts=contacts,
        latch_times=state.joints["latch_time"].copy(),
        peak_force=state.joints["peak_force"].copy(),
        postlock_peak_force=state.joints["postlock_peak_force"].copy(),
        postlock_impulse=(final[:, m.IMPULSE] - state.joints["lock_impulse"]) * locked,
        postlock_sliding_work=(final[:, m.SLIDING_WORK] - state.joints["lock_sliding_work"]) * locked,
        contact_starts=state.joints["contact_starts"].copy(),
        clearance=clearance,
        journal_radius=model.joints["journal_radius"].copy(),
        metadata={
            **metadata,
            "integrator_settings": _json_ready(asdict(simulation.integrator)),
            "steps": int(clock["steps"]),
            "rejected_steps": int(clock["rejected_steps"]),
            "evaluations": int(clock["evaluations"]),
            "factorizations": int(clock["factorizations"]),
            "stability_bound_steps": int(clock["stability_bound_steps"]),
            **limits_of_the_laws(model.joints, contacts, penetration, normal, tangential),
        },
    )


def _json_ready(values: dict[str, Any]) -> dict[str, Any]:
    return {key: None if value == math.inf else value for key, value in values.items()}


def _contact_table(state: m.State, closed: NDArray[np.float64]) -> NDArray[np.void]:
    rows = [tuple(row) for row in closed]
    for j, own in enumerate(state.joints):
        if own["in_contact"]:
            integrals = state.integrals[m.INTEGRALS_PER_JOINT * j :]
            rows.append(
                (
                    j,
                    own["contact_start"],
                    math.nan,
                    own["impact_speed"],
                    own["contact_peak"],
                    integrals[m.IMPULSE] - own["contact_impulse"],
                    integrals[m.SLIDING_WORK] - own["contact_sliding_work"],
                )
            )
    return np.array(rows, dtype=contact_record)
