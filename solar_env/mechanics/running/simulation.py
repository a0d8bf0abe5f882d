"""Running a mechanism from Python: `Simulation` for step-by-step use, `simulate` for a whole run."""

import math
import time
from collections.abc import Callable, Mapping
from dataclasses import asdict
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.arrays import columns
from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.arrays.lanes import copied, with_lane_axis
from solar_env.mechanics.equations.formulation import Formulation, ModelArrays, StateArrays
from solar_env.mechanics.integrators.formulations import FORMULATIONS
from solar_env.mechanics.integrators.methods.table import method_of
from solar_env.mechanics.integrators.run import advance_lanes
from solar_env.mechanics.integrators.settings import Integrator, RungeKutta
from solar_env.mechanics.mechanism.description import Mechanism
from solar_env.mechanics.numerics.handles import Handle
from solar_env.mechanics.records.recording import Recorder, make_recorder
from solar_env.mechanics.running.diagnosis import force_shortcoming, range_shortcoming, shortcomings, warn
from solar_env.mechanics.running.errors import SimulationError, failure
from solar_env.mechanics.running.trajectory import Trajectory, assemble, contact_table, energy_flows
from solar_env.support.values import check_positive

STEPS_PER_CALL = 5000  # steps of a compiled call; Ctrl-C waits for its end, some tenths of a second at most
STEPS_BETWEEN_LOOKS = 10_000  # steps between accuracy checks: a check takes as long as some hundred steps
_MOST_SAMPLES = 10_000_000
_CONTACTS_PER_DRAIN, _PROGRESS_CALLS = 4096, 20
_SMALLEST_ENERGY_SCALE = 1e-9  # J, least energy scale, for a mechanism that starts without energy


class Simulation:
    """Simulation of a mechanism, advanced from one time to the next.

    `snapshot` and `restore` copy the state, even in the middle of a contact; a restored run repeats bit for bit.

    Attributes:
        integrator: settings of the integration method, replaceable by others with the same coordinates (`formulation`).
        model, state: named tuples of constant and of changing arrays; `formulation` determines their classes.
    """

    def __init__(self, mechanism: Mechanism, integrator: Integrator | None = None) -> None:
        """Compile `mechanism` and check that its initial state meets the constraints.

        Raises:
            ValueError: if positions or velocities violate a constraint, if the integrator's class is not in
                `integrators.settings`, or if it does not support a part of the mechanism, such as drives.
        """
        self.integrator: Integrator = RungeKutta() if integrator is None else integrator
        method = method_of(self.integrator)
        if mechanism.drives and not self.integrator.takes_drives:
            raise ValueError(
                f"the integrator {self.integrator.name!r} takes no drives; use RungeKutta or GeneralizedAlpha"
            )
        self.model: ModelArrays
        self.state: StateArrays
        self.model, self.state = method.formulation.compile(mechanism)
        self._check_initial_state()
        self._engage_stops()
        self.formulation.begin(self.model, self.state)
        energies = self.stored_energies()
        self.state.clock["initial_energy"] = energies.sum()
        self.state.clock["energy_scale"] = max(np.abs(energies).sum(), _SMALLEST_ENERGY_SCALE)
        self._unrecorded = make_recorder(self.model, self.state, np.zeros(0), 0)
        self._told: set[str] = set()
        self._steps_looked = 0

    def _check_initial_state(self) -> None:
        values = self.formulation.drift(self.model, self.state)
        for quantity, unit, value in zip(("position", "velocity"), ("m", "m/s"), values, strict=True):
            if not value < 1e-9 * max(self.model.length_scale, 1.0):
                raise ValueError(
                    f"the initial {quantity} violates a constraint by {value:.3g} {unit}; place the bodies so that "
                    "joints and drives are met"
                )

    def _engage_stops(self) -> None:
        """Engage hold-downs and stow stops that the initial angles press on; their energy must enter the balance."""
        joints, angles = self.model.joints, self.joint_loads()[:, columns.ANGLE]
        inside = joints["stow_angle"] - joints["stop_gap"] - angles > 0.0
        held, waits = joints["is_held"] != 0, joints["released_by"] >= 0
        self.state.joints["held"] = held
        self.state.joints["release_time"] = np.where(waits, math.inf, joints["release_time"])
        self.state.joints["stop_engaged"] = held | (inside & (joints["has_stow_stop"] != 0))
        depths = np.where(joints["has_latch"] != 0, angles - joints["lock_angle"] - joints["stop_gap"], 0.0)
        for joint in np.flatnonzero(depths > 0.0).tolist():
            row, depth = joints[joint], float(depths[joint])
            energy = float(row["stop_stiffness"]) * depth ** (row["stop_exponent"] + 1.0) / (row["stop_exponent"] + 1.0)
            warn(
                f"joint {joint + 1} begins {depth:.3g} rad deep in its latch, which closes at once and then holds "
                f"{energy:.3g} J that nothing has put in; begin below its lock angle, {row['lock_angle']:.6g} rad"
            )

    def __getstate__(self) -> dict[str, object]:
        """Return attributes for copies and pickles, without arrays that share memory with this simulation's state."""
        return {name: value for name, value in vars(self).items() if name != "_lane"}

    @property
    def formulation(self) -> Formulation:
        """Formulation of the equations of motion that the integration method uses."""
        return FORMULATIONS[type(self.model)]

    @property
    def time(self) -> float:
        """Present time of the simulation [s]."""
        return float(self.state.clock["time"][0])

    def snapshot(self) -> StateArrays:
        """Return an independent copy of the state, which can be pickled."""
        return copied(self.state)

    def restore(self, snapshot: StateArrays) -> None:
        """Continue from a snapshot of this simulation, or of another simulation of the same mechanism.

        Raises:
            ValueError: if the snapshot's arrays do not fit the mechanism.
        """
        if type(snapshot) is not type(self.state):
            raise ValueError(
                f"the snapshot is a {type(snapshot).__name__}, the integrator {self.integrator.name!r} needs a "
                f"{type(self.state).__name__}"
            )
        for name, mine, theirs in zip(self.state._fields, self.state, snapshot, strict=True):
            if mine.shape != theirs.shape:
                raise ValueError(f"snapshot.{name} has shape {theirs.shape}, this mechanism needs {mine.shape}")
        for mine, theirs in zip(self.state, snapshot, strict=True):
            mine[...] = theirs

    def set_motor_torque(self, joint: int, torque: float) -> None:
        """Set the motor torque on a joint's angle [N m], which acts until it is set again.

        Raises:
            ValueError: if the torque is not finite.
        """
        if not math.isfinite(torque):
            raise ValueError(f"motor torque = {torque!r} N m must be finite")
        if self.state.joints[joint]["motor_torque"] != torque:
            self.state.joints[joint]["motor_torque"] = torque
            self.state.clock["acceleration_current"] = 0

    def move_to(self, model: ModelArrays, state: StateArrays) -> None:
        """Replace model and state by other arrays that hold the same values."""
        self.model, self.state = model, state
        self.__dict__.pop("_lane", None)

    def advance(self, end_time: float, recorder: Recorder | None = None) -> None:
        """Advance the simulation to exactly `end_time` [s].

        Check accuracy every 10,000 steps (`check`), and generalized-alpha's constraint forces after every call.

        Raises:
            ValueError: if `end_time` is not finite or lies before the present time.
            SimulationError: if the run cannot go on, or takes more than `integrator.max_steps` steps; the state stays
                at the last accepted step.
            KeyboardInterrupt: within two seconds of Ctrl-C; the state stays at an accepted step.

        Warns:
            SimulationWarning: as `check`.
        """
        if not self.time <= end_time < math.inf:
            raise ValueError(
                f"end_time = {end_time!r} s must be finite and not before the present time {self.time!r} s"
            )
        status = self._advance(end_time, recorder or self._unrecorded)
        if status != m.DONE:
            raise self.failure(status)
        if abs(int(self.state.clock["steps"][0]) - self._steps_looked) >= STEPS_BETWEEN_LOOKS:
            self.check()
        elif self.integrator.settles_forces:
            self._tell("forces", force_shortcoming(self))

    def failure(self, status: int) -> SimulationError:
        """Return the error for a status code, not DONE or PAUSED, with which a kernel stopped at the present state."""
        # Modal panels that leave their range may be the cause.
        self._tell("range", range_shortcoming(self))
        return failure(status, self.state.clock[0])

    def check(self) -> None:
        """Check the accuracy of the run so far, and warn once of every shortcoming.

        Warns:
            SimulationWarning: if the energy balance is off by more than 1 % of the energy turned over; if modal panels
                bend or turn by more than their second-order theory holds for; if multipliers of generalized-alpha
                differ from the constraint forces by more than 10 % of the largest force; if a fixed step does not
                resolve the latest impact of a joint; if `rtol` is so loose that a contact's force may be ten times off.
        """
        self._steps_looked = int(self.state.clock["steps"][0])
        for subject, text in shortcomings(self).items():
            self._tell(subject, text)

    def _tell(self, subject: str, text: str) -> None:
        if text and subject not in self._told:
            self._told.add(subject)
            warn(text)

    @cached_property
    def _lane(self) -> tuple[Handle, Handle, dict[str, Handle]]:
        """Handles of model and state as a batch of one, and a dictionary of work arrays' handles by integrator name."""
        return Handle(with_lane_axis(self.model)), Handle(with_lane_axis(self.state)), {}

    def _advance(self, end_time: float, recorder: Recorder, most_steps: int | None = None) -> int:
        method = method_of(self.integrator)
        if method.formulation is not self.formulation:
            raise ValueError(
                f"the integrator {self.integrator.name!r} needs arrays that this simulation does not have; make a new "
                "Simulation with it"
            )
        models, states, scratch = self._lane
        if self.integrator.name not in scratch:
            scratch[self.integrator.name] = Handle(method.arrays(self.model, self.state))
        queue, counter, steps_left = (np.zeros(1, np.int64) for _ in range(3))
        status = np.full(1, m.TOO_MANY_STEPS)
        settings, end_times = method.convert(self.integrator), np.array([end_time], np.float64)
        arrays, clock = scratch[self.integrator.name], self.state.clock[0]
        left = self.integrator.max_steps if most_steps is None else most_steps
        while status[0] == m.TOO_MANY_STEPS and left > 0:
            allowed, counter[0] = min(STEPS_PER_CALL, left), 0
            steps_left[0], left = allowed, left - allowed
            advance_lanes(models, states, settings, recorder, arrays, queue, counter, steps_left, status, end_times)
        if status[0] == m.TOO_MANY_STEPS:
            clock["failure_joint"], clock["failure_value"] = -1, self.integrator.max_steps
        return int(status[0])

    def joint_loads(self) -> NDArray[np.float64]:
        """Return the table (joints, columns) of present angles, rates, forces and torques, see `arrays.columns`."""
        return self.formulation.joint_loads(self.model, self.state)

    def stored_energies(self) -> NDArray[np.float64]:
        """Return the (ENERGIES,) energies stored at present [J], in the order of `model.ENERGY_NAMES`."""
        return self.formulation.stored_energies(self.model, self.state)

    def momenta(self) -> NDArray[np.float64]:
        """Return the momenta (3,) of the moving bodies: linear [N s], and angular about the origin [N m s]."""
        return self.formulation.momenta(self.model, self.state)

    def energy_residual(self) -> float:
        """Return the present error of the energy balance [J]: energy that nothing accounts for."""
        return self.energy_book()[0]

    def energy_book(self) -> tuple[float, float]:
        """Return the present error of the energy balance, and the energy that the run has turned over so far [J].

        The energy turned over is the greater of the energy stored at the start and the energy stored now plus lost. The
        greatest weight's work along the longest body is added, so that a pendulum at momentary rest does not give zero.
        """
        put_in, lost = (sum(flows.values()) for flows in energy_flows(self.state.integrals))
        stored = self.stored_energies()
        weight = self.formulation.greatest_weight(self.model) * self.model.length_scale
        clock = self.state.clock[0]
        turned_over = float(np.abs(stored[: m.GRAVITY]).sum() + abs(lost))
        return (
            float(stored.sum() - clock["initial_energy"] - put_in + lost),
            max(float(clock["energy_scale"]), turned_over) + float(weight),
        )

    def constraint_force_defect(self) -> tuple[float, float]:
        """Return the greatest error of the integrator's constraint forces at present, and the greatest force [N].

        An error is the difference from the force that satisfies the constraints in the present state. The returned
        force is at least the energy that the run has stored or lost so far (`energy_book`), divided by the longest
        body's length. Without this bound, rounding errors would be compared with each other if forces vanish.
        """
        defect, largest = self.formulation.constraint_force_defect(self.model, self.state)
        return defect, max(largest, float(self.energy_book()[1] / self.model.length_scale))


def sample_times(duration: float, output_step: float) -> NDArray[np.float64]:
    """Return the times [s] of samples: every `output_step` [s] from 0, and at the end of `duration` [s].

    Raises:
        ValueError: if `duration` or `output_step` is not positive and finite, or the samples are too many.
    """
    check_positive("duration", duration, " s")
    check_positive("output_step", output_step, " s")
    count = duration / output_step
    if count > _MOST_SAMPLES:
        raise ValueError(
            f"output_step = {output_step!r} s makes {count:.3g} samples of {duration!r} s, more than "
            f"{_MOST_SAMPLES:,}; choose at least {duration / _MOST_SAMPLES:.2g} s, or simulate a shorter time"
        )
    return np.append(np.arange(math.ceil(count - 1e-9)) * output_step, duration)


def simulate(
    mechanism: Mechanism,
    duration: float,
    *,
    integrator: Integrator | None = None,
    output_step: float = 0.01,
    progress: Callable[[float], None] | None = None,
    metadata: Mapping[str, object] | None = None,
) -> Trajectory:
    """Simulate a mechanism from t = 0 for `duration`; return its `Trajectory`, sampled every `output_step`.

    Args:
        mechanism: mechanism to simulate.
        duration: simulated time [s].
        integrator: settings of the integration method; None takes `RungeKutta`.
        output_step: time between samples [s]; independent of the integration step.
        progress: function that is called about 20 times with the simulated time [s]; it does not affect the result.
        metadata: further entries of the trajectory's metadata.

    Raises:
        ValueError: if duration or output_step is not positive and finite, or the samples are too many.
        SimulationError: if the run cannot go on, or takes more than `integrator.max_steps` steps.
        KeyboardInterrupt: within two seconds of Ctrl-C.

    Warns:
        SimulationWarning: if the result is less accurate than it looks, see `Simulation.check`.
    """
    times = sample_times(duration, output_step)
    simulation = Simulation(mechanism, integrator)
    recorder = make_recorder(simulation.model, simulation.state, times, _CONTACTS_PER_DRAIN)
    contacts: list[NDArray[np.float64]] = []
    start = time.perf_counter()
    status, left = m.PAUSED, simulation.integrator.max_steps
    while status == m.PAUSED:
        if progress:
            recorder.pause[0] = simulation.time + duration / _PROGRESS_CALLS
        status = simulation._advance(duration, recorder, left)
        clock = simulation.state.clock
        left = simulation.integrator.max_steps - int(clock["steps"][0] + clock["rejected_steps"][0])
        contacts.append(recorder.contacts[: recorder.filled[1]].copy())
        recorder.filled[1] = 0
        if progress:
            progress(simulation.time)
    if status != m.DONE:
        raise simulation.failure(status)
    details: dict[str, Any] = {"wall_time_s": time.perf_counter() - start, "integrator": simulation.integrator.name}
    settings = asdict(simulation.integrator).items()
    details["integrator_settings"] = {name: None if value == math.inf else value for name, value in settings}
    table = contact_table(simulation.state, np.concatenate(contacts))
    simulation.check()
    return assemble(simulation.model, simulation.state, recorder, table, {**(metadata or {}), **details})
