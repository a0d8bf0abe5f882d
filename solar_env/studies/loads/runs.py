"""Simulation of a deployment with its shocks, sampled finely from the first latching on, in pieces that fit memory."""

import math
import warnings
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from solar_env.array import ArrayParameters, build
from solar_env.array.parameters.ranges import Ranges, drawn
from solar_env.mechanics.arrays import columns
from solar_env.mechanics.records.recording import Recorder, make_recorder, sample_columns
from solar_env.mechanics.running.diagnosis import SimulationWarning
from solar_env.mechanics.running.simulation import Simulation
from solar_env.mechanics.running.trajectory import Trajectory, assemble, contact_table
from solar_env.studies.common.motion import Level, perturbed
from solar_env.studies.loads.hub import hub_place, hub_velocity, mean_loads, sampled_hinge_loads
from solar_env.studies.loads.shock_spectrum import ShockSpectrum

Array = NDArray[np.float64]

# Samples per second from the first latching on. Most contacts last a millisecond and more; at five times this rate
# the spectra are the same within 1 %.
RATE = 20_000
EVERY = 20  # one fine sample in this many is kept, and no others are taken before the latching: one per ms
FREQUENCIES = 5.0 * 2.0 ** (np.arange(52) / 6.0)  # Hz; frequencies of spectra, six per octave up to 0.1 times the rate
_PIECE = 0.5  # s; time simulated between two checks for latching
_CONTACTS = 100_000  # greatest number of contacts in a piece


@dataclass(frozen=True)
class Deployment:
    """Motion, loads and shock spectra of a deployment that was simulated past its last latching.

    Peak loads on a free hub are the greatest means over 50 microseconds (before the first latching, 1 ms). On a fixed
    hub they are the greatest of samples 1 ms apart.
    """

    trajectory: Trajectory  # trajectory with a sample every millisecond
    place: Array  # (nt, 3) place of the hub's centroid [m] and angle of the hub [rad]
    velocity: Array  # (nt, 3) velocity of the hub's centroid [m/s] and spin of the hub [rad/s]
    hub_loads: Array  # (nt - 1, 3) mean force [N] and torque [N m] on the hub between the samples
    peak_torque: Array  # (joints,) greatest sum of a hinge's torques, which bend the panel's root [N m]
    hub_peaks: Array  # greatest force [N], torque [N m] and acceleration [m/s2] of the hub
    hub_greatest: Array  # (nt - 1, 2) greatest force [N] and torque [N m] on the hub between samples
    hinge_spectrum: Array  # (f, joints) shock response spectra of the hinges' forces [N]
    hub_spectrum: Array  # (f,) shock response spectrum of the acceleration of the hub's centroid [m/s2]
    warnings: tuple[str, ...]  # warnings of the simulator


def member_parameters(parameters: ArrayParameters, ranges: Ranges, member: int) -> ArrayParameters:
    """Return a member's parameters: sampled from `ranges`, with perturbed initial joint rates; member 0 is nominal."""
    if member > 0:
        parameters = parameters.with_changes(drawn(ranges, np.random.default_rng([member, 2])))
    return perturbed(parameters, member)


def deploy(level: Level, parameters: ArrayParameters, member: int, window: float, deadline: float) -> Deployment:
    """Simulate to `window` [s] after the last joint latches, or `deadline` [s] if one does not; return a `Deployment`.

    `level` is the level of model detail, from rigid to finely discretised panels. `parameters` belong to the ensemble
    member `member`, whose number also varies the integrator's tolerance.
    """
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", SimulationWarning)
        run = _Run(Simulation(build(parameters, level.model), level.integrator(member)), parameters)
        run.go_on(window, deadline)
        trajectory = run.trajectory(level.model)
        run.simulation.check()
    said = tuple(dict.fromkeys(str(item.message) for item in caught if issubclass(item.category, SimulationWarning)))
    place = hub_place(parameters, run.simulation.model, trajectory.coordinates)
    place[:, 2] = np.unwrap(place[:, 2])
    velocity = hub_velocity(parameters, run.simulation.model, trajectory.coordinates, trajectory.velocities)
    if parameters.body_fixed:
        loads = sampled_hinge_loads(parameters, trajectory, place)[1:]
        greatest = np.column_stack([np.hypot(loads[:, 0], loads[:, 1]), np.abs(loads[:, 2])])
        run.hub_peaks[:2] = greatest.max(axis=0)
    else:
        greatest = run.hub_greatest()
        loads = mean_loads(parameters, trajectory.time, velocity)
    spectra = run.hinge_spectrum.finish(), run.hub_spectrum.finish()[:, 0]
    return Deployment(trajectory, place, velocity, loads, run.peak_torque, run.hub_peaks, greatest, *spectra, said)


class _Run:
    """A simulation in progress, with the samples, contacts and peaks seen so far."""

    def __init__(self, simulation: Simulation, parameters: ArrayParameters) -> None:
        self.simulation, self._parameters = simulation, parameters
        joints = len(parameters.joints)
        self._columns = sample_columns(simulation.model, simulation.state)
        self._samples: list[Array] = []
        self._contacts: list[Array] = []
        self._tick = 0  # time of the next sample, in samples of RATE
        self._last_velocity: Array | None = None
        self._last_tick = 0
        # Piece by piece: milliseconds, and the greatest force and torque in each millisecond.
        self._hub_loads: list[tuple[NDArray[np.int64], Array]] = []
        self.peak_torque = np.zeros(joints)
        self.hub_peaks = np.zeros(3)
        self.hinge_spectrum = ShockSpectrum(FREQUENCIES, RATE, joints)
        self.hub_spectrum = ShockSpectrum(FREQUENCIES, RATE, 1)

    def go_on(self, window: float, deadline: float) -> None:
        """Run to `window` [s] after the last latching, or to `deadline` [s]; sample finely after the first latching."""
        simulation, joints = self.simulation, self.simulation.state.joints
        while simulation.time < deadline:
            before = simulation.snapshot()
            recorder = self._advance(min(simulation.time + _PIECE, deadline), EVERY)
            if joints["latched"].any():
                simulation.restore(before)
                break
            self._take(recorder, EVERY)
        while True:
            end = joints["latch_time"].max() + window if joints["latched"].all() else deadline
            if simulation.time >= end:
                return
            before = simulation.snapshot()
            recorder = self._advance(min(simulation.time + _PIECE, end), 1)
            if joints["latched"].all() and (end := joints["latch_time"].max() + window) < simulation.time:
                simulation.restore(before)
                recorder = self._advance(end, 1)
            self._take(recorder, 1)

    def _advance(self, end: float, stride: int) -> Recorder:
        ticks = np.arange(self._tick, math.floor(end * RATE + 1e-6) + 1, stride)
        recorder = make_recorder(self.simulation.model, self.simulation.state, ticks / RATE, _CONTACTS)
        self.simulation.advance(max(end, recorder.times[-1]) if len(ticks) else end, recorder)
        return recorder

    def _take(self, recorder: Recorder, stride: int) -> None:
        """Update peaks and spectra from new samples, `stride` * 50 us apart; keep one sample per millisecond."""
        self._contacts.append(recorder.contacts[: recorder.filled[1]].copy())
        table = recorder.samples
        if len(table) == 0:
            return
        first = -self._tick % EVERY if stride == 1 else 0
        self._samples.append(table[first :: EVERY // stride].copy())
        loads = table[:, self._columns["loads"]].reshape(len(table), -1, columns.LOAD_COLUMNS)
        self.peak_torque = np.maximum(self.peak_torque, np.abs(columns.total_torque(loads)).max(axis=0))
        velocity = hub_velocity(
            self._parameters, self.simulation.model, table[:, self._columns["q"]], table[:, self._columns["v"]]
        )
        ticks = self._tick + stride * np.arange(len(table))
        if self._last_velocity is not None:
            velocity, ticks = np.vstack([self._last_velocity, velocity]), np.append(self._last_tick, ticks)
        if len(ticks) > 1:
            gained = np.diff(velocity, axis=0) / (np.diff(ticks)[:, None] / RATE)
            acceleration, turning = np.hypot(gained[:, 0], gained[:, 1]), np.abs(gained[:, 2])
            p = self._parameters
            loads_on_hub = np.column_stack([p.body_mass * acceleration, p.body_inertia * turning])
            self.hub_peaks = np.maximum(self.hub_peaks, [*loads_on_hub.max(axis=0), acceleration.max()])
            milliseconds = -(-ticks[1:] // EVERY)
            begins = np.flatnonzero(np.diff(milliseconds, prepend=-1))
            self._hub_loads.append((milliseconds[begins], np.maximum.reduceat(loads_on_hub, begins, axis=0)))
            if stride == 1:
                self.hub_spectrum.add(gained[:, None, :2])
        if stride == 1:
            self.hinge_spectrum.add(loads[:, :, [columns.FORCE_X, columns.FORCE_Y]])
        self._last_velocity, self._last_tick = velocity[-1:], int(ticks[-1])
        self._tick += len(table) * stride

    def hub_greatest(self) -> Array:
        """Return the (nt - 1, 2) greatest force [N] and torque [N m] on the hub from each kept sample to the next."""
        last = sum(map(len, self._samples)) - 1
        greatest = np.zeros((last, 2))
        for milliseconds, loads in self._hub_loads:
            np.maximum.at(greatest, np.minimum(milliseconds, last) - 1, loads)
        return greatest

    def trajectory(self, model: str) -> Trajectory:
        """Return the run's trajectory, from the samples kept; `model` names the model level in its metadata."""
        integrator = self.simulation.integrator.name
        details = {"model": model, "parameters": self._parameters.to_dict(), "integrator": integrator}
        samples, state = np.concatenate(self._samples), self.simulation.state
        times = np.asarray(np.arange(len(samples)) * (EVERY / RATE), np.float64)
        recorder = Recorder(times, samples, np.zeros((0, 7)), np.zeros(2, np.int64), np.zeros(1))
        contacts = contact_table(state, np.concatenate(self._contacts))
        return assemble(self.simulation.model, state, recorder, contacts, details)
