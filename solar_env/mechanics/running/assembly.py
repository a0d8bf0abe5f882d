"""Making of a `Trajectory`: the arrays of a run by name, from what its recorder and its state hold."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.arrays import columns
from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.records.recording import Recorder, sample_columns
from solar_env.mechanics.running.accuracy import limits_of_the_laws
from solar_env.mechanics.running.trajectory import Trajectory, contact_record

_COUNTS = ("steps", "rejected_steps", "evaluations", "factorizations", "stability_bound_steps")


def energy_flows(integrals: NDArray[np.float64]) -> tuple[dict[str, Any], dict[str, Any]]:
    """Energy put in and energy lost since t = 0 [J], by the names of `Trajectory`, from integrals (..., columns)."""
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
    model: Any, state: Any, recorder: Recorder, contacts: NDArray[np.void], metadata: dict[str, Any]
) -> Trajectory:
    """Make the trajectory of a finished run from its samples, its contacts (`contact_table`) and its last state.

    `metadata` is completed with the counts of steps and with where the laws were at their limits.
    """
    table, joints, clock = recorder.samples, model.joints.size, state.clock[0]
    slices = sample_columns(model, state)
    loads = table[:, slices["loads"]].reshape(len(table), joints, columns.LOAD_COLUMNS)
    integrals = table[:, slices["integrals"]]
    by_joint = m.joint_integrals(integrals)
    eccentricity = loads[:, :, [columns.ECCENTRICITY_X, columns.ECCENTRICITY_Y]]
    clearance = model.joints["clearance"].copy()
    penetration = np.hypot(eccentricity[..., 0], eccentricity[..., 1]) - clearance
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
        angles=np.unwrap(loads[:, :, columns.ANGLE], axis=0),
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
            **limits_of_the_laws(model.joints, contacts, penetration, normal, tangential),
        },
    )


def contact_table(state: Any, closed: NDArray[np.float64]) -> NDArray[np.void]:
    """Contacts as `contact_record`: those that have ended, rows of the recorder's queue, then those still open."""
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
