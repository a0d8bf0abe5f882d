"""Result of a run: arrays over time, each joint's totals, and a table of contacts; functions make, save and load it."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.arrays import columns
from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.arrays.columns import TORQUES
from solar_env.mechanics.equations.formulation import ModelArrays, StateArrays
from solar_env.mechanics.records.recording import CONTACT_FIELDS, Recorder, sample_columns
from solar_env.support.files import writing
from solar_env.support.plain_arrays import MOST_BYTES, parse_json, read_arrays

Array = NDArray[np.float64]
_STORED = tuple(name for name in m.ENERGY_NAMES if name != "gravity")
_PUT_IN = (*(law.book for law in TORQUES if law.book and not law.lost), "external_work")
_ENERGIES = "energies/"  # prefix of the energies' names in a file
_COUNTS = ("steps", "rejected_steps", "evaluations", "factorizations", "stability_bound_steps")
_COSTS_AND_LIMITS = (*_COUNTS, "slow_contacts", "creeping_share", "wall_time_s")  # metadata that a summary shows

# Row of a contact; its end time is nan while the contact lasts.
contact_record = np.dtype([(name, np.int64 if name == "joint" else np.float64) for name in CONTACT_FIELDS])


@dataclass(frozen=True)
class Trajectory:
    """Simulated motion, in SI units; nt samples, nj joints, n generalized coordinates.

    Attributes:
        time: (nt,) times of the samples.
        coordinates, velocities: (nt, n) generalized coordinates and velocities.
        angles, rates: (nt, nj) joint angles and their rates; continuous through full turns.
        eccentricity: (nt, nj, 2) journal centre minus bearing centre, in inertial axes; zero for ideal joints.
        penetration: (nt, nj) |eccentricity| - clearance; negative is a gap.
        normal_force, tangential_force: (nt, nj) contact force on the journal; for an ideal joint, the reaction's
            magnitude and zero. Samples inside linearly implicit steps are interpolated: after a change of motor
            torque, they may show up to 10 N where a journal leans on its bearing with 0.2 N. Samples inside steps of
            modal-radau follow the step's polynomial. Peak forces and integrals are free of these errors.
        joint_force: (nt, nj, 2) force on the outboard body, in inertial axes.
        spring_torque, cable_torque, latch_torque, motor_torque, harness_torque, damping_torque, hinge_friction_torque:
            (nt, nj) torques on the joint angle; `latch_torque` comes from latch, stow stop, end stop or hold-down.
        energies: arrays (nt,) by name. Stored: kinetic, spring, cable, latch, contact, elastic, harness, gravity (of
            all constant forces). Put in: motor_work, cable_work (zero for a loop that conserves energy),
            external_work (of drives and load torques). Lost: contact_dissipation, friction_dissipation,
            latch_dissipation, damper_dissipation, hinge_friction_dissipation, material_dissipation. The error,
            residual, is stored - initially stored - put in + lost.
        sliding_work, impulse: (nt, nj) integrals since t = 0 of normal_force * |sliding speed|, and of normal_force.
        wear_journal, wear_bearing: (nj, bins) wear depth at the end, by angle in the frame of the surface's body.
        contacts: structured array of all contacts by end time; open contacts come last, with end_s = nan. Fields: joint
            (index), start_s, end_s, impact_speed, peak_force, impulse, sliding_work.
        latch_times: (nj,) times of latching; nan if not latched.
        latch_rates: (nj,) rates of the joint angles at the latching [rad/s]; nan if not latched.
        peak_latch_torque: (nj,) greatest torque [N m] of the latch, or of the stop at the lock angle, at steps' ends.
        peak_force, postlock_peak_force: (nj,) greatest force in all accepted steps; post-lock counts from the first
            latching. With flexible panels and ideal joints the peak force does not converge as panels are refined:
            springs that act suddenly send a wave into them, whose reaction in the first 0.1 ms grows with refinement.
        postlock_impulse, postlock_sliding_work: (nj,) impulse and sliding work since the first latching.
        contact_starts: (nj,) number of contacts that began.
        clearance, journal_radius: (nj,) zero for ideal joints.
        metadata: model, integrator, counts of steps and evaluations, wall time, parameters. `stability_bound_steps`
            counts explicit steps that stability on flexible bodies, not accuracy, has limited. `slow_contacts` counts
            contacts that began at or below the law's minimum impact speed; they bounce too much. `creeping_share` is
            the fraction of samples in contact with friction below Coulomb's limit, where dry friction might stick.
    """

    time: Array
    coordinates: Array
    velocities: Array
    angles: Array
    rates: Array
    eccentricity: Array
    penetration: Array
    normal_force: Array
    tangential_force: Array
    joint_force: Array
    spring_torque: Array
    cable_torque: Array
    latch_torque: Array
    motor_torque: Array
    harness_torque: Array
    damping_torque: Array
    hinge_friction_torque: Array
    energies: dict[str, Array]
    sliding_work: Array
    impulse: Array
    wear_journal: Array
    wear_bearing: Array
    contacts: NDArray[np.void]
    latch_times: Array
    latch_rates: Array
    peak_latch_torque: Array
    peak_force: Array
    postlock_peak_force: Array
    postlock_impulse: Array
    postlock_sliding_work: Array
    contact_starts: NDArray[np.int64]
    clearance: Array
    journal_radius: Array
    metadata: dict[str, Any]

    @property
    def joint_torque(self) -> Array:
        """Sum of all torques on the joint angles (nt, nj) [N m]."""
        return np.asarray(sum(getattr(self, law.name) for law in TORQUES))

    @property
    def energy_put_in(self) -> float:
        """Energy [J] stored at t = 0, without gravity, plus the works of motor, cable loops, drives and load torques.

        A work that is negative at the end counts as zero. If a stored energy becomes negative (as a tabulated torque's
        may), its lowest sampled value is subtracted.
        """
        stored = sum(float(self.energies[name][0] - min(self.energies[name].min(), 0.0)) for name in _STORED)
        return stored + sum(max(float(self.energies[name][-1]), 0.0) for name in _PUT_IN)

    @property
    def energy_residual(self) -> float:
        """Greatest error of the energy balance in any sample [J]."""
        return float(np.max(np.abs(self.energies["residual"])))

    @property
    def wear_depth(self) -> Array:
        """Depth [m] of the deepest wear at the end, on journal or bearing, whichever is deeper: (nj,)."""
        return np.maximum(self.wear_journal.max(axis=1), self.wear_bearing.max(axis=1))

    def summary(self) -> dict[str, object]:
        """Return the main results of the whole run as plain Python values, ready for JSON; nan becomes None."""

        def plain(values: NDArray[Any]) -> list[Any]:
            return [None if isinstance(x, float) and math.isnan(x) else x for x in values.tolist()]

        return {
            "model": self.metadata.get("model"),
            "integrator": self.metadata.get("integrator"),
            "status": "completed",
            "duration_s": float(self.time[-1] - self.time[0]),
            "latch_times_s": plain(self.latch_times),
            "latch_rates_rad_s": plain(self.latch_rates),
            "peak_latch_torque_Nm": plain(self.peak_latch_torque),
            "peak_contact_force_N": plain(self.peak_force),
            "peak_postlock_force_N": plain(self.postlock_peak_force),
            "postlock_impulse_Ns": plain(self.postlock_impulse),
            "postlock_sliding_work_J": plain(self.postlock_sliding_work),
            "contact_starts": plain(self.contact_starts),
            "sliding_work_J": plain(self.sliding_work[-1]),
            "wear_depth_max_m": plain(self.wear_depth),
            "theta_end_rad": plain(self.angles[-1]),
            "energy_residual_J": self.energy_residual,
            "energy_put_in_J": self.energy_put_in,
            # Work of cable loops whose torque ratio is not their wheel ratio: energy that they destroy is negative.
            "cable_work_J": float(self.energies["cable_work"][-1]) or None,
            **{name: self.metadata.get(name) for name in _COSTS_AND_LIMITS},
        }

    def save(self, path: str | Path) -> None:
        """Write all arrays and the metadata to a compressed npz file."""
        arrays: dict[str, Any] = {}
        for item in fields(self):
            value = getattr(self, item.name)
            if item.name == "energies":
                arrays.update({f"{_ENERGIES}{name}": series for name, series in value.items()})
            elif item.name == "metadata":
                arrays["metadata"] = np.array(json.dumps(value))
            else:
                arrays[item.name] = value
        with writing(path) as file:
            np.savez_compressed(file, **arrays)

    @classmethod
    def load(cls, path: str | Path, most_bytes: int = MOST_BYTES) -> Trajectory:
        """Read a file that `save` wrote; nothing in it is executed.

        Args:
            path: path of the file.
            most_bytes: greatest size of all arrays together; a larger file is refused before it is inflated.

        Raises:
            OSError: if the file cannot be opened.
            ValueError: if the file is no saved trajectory, is damaged or too large.
        """
        plain = {item.name for item in fields(cls)} - {"energies"}
        try:
            data = read_arrays(path, lambda name: name in plain or name.startswith(_ENERGIES), most_bytes)
            missing = [item.name for item in fields(cls) if item.name in plain and item.name not in data]
            if missing:
                raise ValueError(f"it lacks {', '.join(missing)}")
            values: dict[str, Any] = {name: data[name] for name in plain}
            values["energies"] = {k.removeprefix(_ENERGIES): v for k, v in data.items() if k.startswith(_ENERGIES)}
            values["metadata"] = parse_json(str(data["metadata"]))
            _check(values)
        except ValueError as error:
            raise ValueError(f"{path} is not a saved trajectory: {error}") from error
        return cls(**values)


_BY_JOINT = (
    "latch_times", "latch_rates", "peak_latch_torque", "peak_force", "postlock_peak_force", "postlock_impulse",
    "postlock_sliding_work", "contact_starts", "clearance", "journal_radius", "wear_journal", "wear_bearing",
)  # fmt: skip


def _check(values: dict[str, Any]) -> None:
    """Raise ValueError for entries whose types or shapes do not fit a trajectory."""
    if not isinstance(values["metadata"], dict):
        raise ValueError("its metadata are no mapping")
    energies, alone = values["energies"], {"metadata", "energies", "contacts"}
    if missing := {*_STORED, *_PUT_IN, "residual"} - set(energies):
        raise ValueError(f"it lacks the energies {', '.join(sorted(missing))}")
    if values["contacts"].dtype != contact_record:
        raise ValueError(f"contacts is of the type {values['contacts'].dtype}; expected {contact_record}")
    samples, joints = values["time"].shape, values["latch_times"].shape
    by_name = {name: values[name] for name in values if name not in alone}
    for name, array in {**by_name, **{f"{_ENERGIES}{name}": energies[name] for name in energies}}.items():
        expected = np.dtype(np.int64 if name == "contact_starts" else np.float64)
        if array.dtype != expected:
            raise ValueError(f"{name} is of the type {array.dtype}; expected {expected}")
        leading = (*samples, *joints)
        if name in _BY_JOINT:
            leading = joints
        elif name.startswith(_ENERGIES) or name in ("time", "coordinates", "velocities"):
            leading = samples
        if array.shape[: len(leading)] != leading or (len(samples), len(joints)) != (1, 1):
            raise ValueError(f"{name} has the shape {array.shape}, which does not fit {leading} of the others")
    if not samples[0] or not values["wear_journal"].shape[1:] == values["wear_bearing"].shape[1:] > (0,):
        raise ValueError("it has no samples, or no bins of wear")


def energy_flows(integrals: NDArray[np.float64]) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the energies [J] put into a mechanism since t = 0, and the energies lost, as two dictionaries by name.

    `integrals` (..., count) are the state's time integrals of powers and normal forces, at one time or at all samples.
    Every energy has the shape (...). `Trajectory.energies` has the same names.
    """
    totals = m.joint_integrals(integrals).sum(axis=-2)
    by_torques: list[dict[str, Any]] = [
        {law.book: totals[..., law.integral] for law in columns.TORQUES if law.book and law.lost == lost}
        for lost in (False, True)
    ]
    put_in = {**by_torques[0], "external_work": integrals[..., m.EXTERNAL_WORK]}
    lost = {
        "contact_dissipation": totals[..., m.NORMAL_DISSIPATION],
        "friction_dissipation": totals[..., m.FRICTION_DISSIPATION],
        **by_torques[1],
        "material_dissipation": integrals[..., m.MATERIAL_DISSIPATION],
    }
    return put_in, lost


def assemble(
    model: ModelArrays, state: StateArrays, recorder: Recorder, contacts: NDArray[np.void], metadata: dict[str, Any]
) -> Trajectory:
    """Make the trajectory of a finished run from its samples, its contacts (from `contact_table`) and its last state.

    A copy of `metadata` gets counts of steps and evaluations; `slow_contacts`, the number of contacts that began at or
    below the minimum impact speed; `creeping_share`, the fraction of samples in contact with friction below its limit.
    """
    table, joints, clock = recorder.samples, model.joints.size, state.clock[0]
    slices = sample_columns(model, state)
    loads = table[:, slices["loads"]].reshape(len(table), joints, columns.LOAD_COLUMNS)
    integrals = table[:, slices["integrals"]]
    by_joint = m.joint_integrals(integrals)
    eccentricity = loads[:, :, [columns.ECCENTRICITY_X, columns.ECCENTRICITY_Y]]
    clearance = model.joints["clearance"].copy()
    penetration = np.hypot(eccentricity[..., 0], eccentricity[..., 1]) - clearance
    angles = loads[:, :, columns.ANGLE]
    normal, tangential = loads[:, :, columns.NORMAL].copy(), loads[:, :, columns.TANGENTIAL].copy()
    energies = {name: table[:, slices["energies"]][:, k] for k, name in enumerate(m.ENERGY_NAMES)}
    stored = sum(energies.values())
    put_in, lost = energy_flows(integrals)
    residual = stored - clock["initial_energy"] - sum(put_in.values()) + sum(lost.values())
    final = m.joint_integrals(state.integrals)
    locked = clock["latched_joints"] > 0
    return Trajectory(
        time=recorder.times,
        coordinates=table[:, slices["q"]].copy(),
        velocities=table[:, slices["v"]].copy(),
        angles=np.where(model.joints["angle_limited"], angles, np.unwrap(angles, axis=0)),
        rates=loads[:, :, columns.RATE].copy(),
        eccentricity=eccentricity,
        penetration=penetration,
        normal_force=normal,
        tangential_force=tangential,
        joint_force=loads[:, :, [columns.FORCE_X, columns.FORCE_Y]],
        **{law.name: loads[:, :, law.column].copy() for law in columns.TORQUES},
        energies={**energies, **put_in, **lost, "residual": residual},
        sliding_work=by_joint[:, :, m.SLIDING_WORK].copy(),
        impulse=by_joint[:, :, m.IMPULSE].copy(),
        wear_journal=state.wear_journal.copy(),
        wear_bearing=state.wear_bearing.copy(),
        contacts=contacts,
        latch_times=state.joints["latch_time"].copy(),
        latch_rates=np.where(state.joints["latched"] != 0, state.joints["latch_rate"], math.nan),
        peak_latch_torque=state.joints["peak_latch_torque"].copy(),
        peak_force=state.joints["peak_force"].copy(),
        postlock_peak_force=state.joints["postlock_peak_force"].copy(),
        postlock_impulse=(final[:, m.IMPULSE] - state.joints["lock_impulse"]) * locked,
        postlock_sliding_work=(final[:, m.SLIDING_WORK] - state.joints["lock_sliding_work"]) * locked,
        contact_starts=state.joints["contact_starts"].copy(),
        clearance=clearance,
        journal_radius=model.joints["journal_radius"].copy(),
        metadata={
            **metadata,
            **{name: int(clock[name]) for name in _COUNTS},
            **_limits_of_the_laws(model.joints, contacts, normal, tangential),
        },
    )


def contact_table(state: StateArrays, closed: NDArray[np.float64]) -> NDArray[np.void]:
    """Return a `contact_record` array: finished contacts (`closed`, rows of the recorder), then those going on."""
    rows = [tuple(row) for row in closed]
    for j, joint_state in enumerate(state.joints):
        if joint_state["in_contact"]:
            integrals = state.integrals[m.INTEGRALS_PER_JOINT * j :]
            rows.append(
                (
                    j,
                    joint_state["contact_start"],
                    math.nan,
                    joint_state["impact_speed"],
                    joint_state["contact_peak"],
                    integrals[m.IMPULSE] - joint_state["contact_impulse"],
                    integrals[m.SLIDING_WORK] - joint_state["contact_sliding_work"],
                )
            )
    return np.array(rows, dtype=contact_record)


def _limits_of_the_laws(joints: Any, contacts: Any, normal: Array, tangential: Array) -> dict[str, Any]:
    """Return a dictionary of two totals over all joints, from `contacts` and contact forces (nt, nj) [N].

    `slow_contacts` is the number of contacts that began at or below the joint's minimum impact speed. `creeping_share`
    is the fraction of the samples in contact in which friction is below Coulomb's limit.
    """
    loose = joints["kind"] == m.CLEARANCE
    pressed = normal[:, loose] > 0.0
    coulomb = joints["friction_coefficient"][loose] * normal[:, loose]
    creeping = pressed & (np.abs(tangential[:, loose]) < 0.999 * coulomb)
    return {
        "slow_contacts": int((contacts["impact_speed"] <= joints["minimum_impact_speed"][contacts["joint"]]).sum()),
        "creeping_share": float(creeping.sum() / max(pressed.sum(), 1)),
    }
