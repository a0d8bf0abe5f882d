"""The result of a run: named arrays over time, totals by joint, every contact; saved to and loaded from npz."""

from __future__ import annotations

import json
import math
import zipfile
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
# Entries of the metadata that a summary shows.
_COSTS_AND_LIMITS = (
    "steps", "rejected_steps", "evaluations", "factorizations", "stability_bound_steps", "slow_contacts",
    "creeping_share", "cut_off_share", "wall_time_s",
)  # fmt: skip

contact_record = np.dtype(
    [
        ("joint", np.int64),
        ("start_s", np.float64),
        ("end_s", np.float64),  # nan while the contact lasts
        ("impact_speed", np.float64),
        ("peak_force", np.float64),
        ("impulse", np.float64),
        ("sliding_work", np.float64),
    ]
)


@dataclass(frozen=True)
class Trajectory:
    """A simulated motion, in SI units; nt samples, nj joints, n generalized coordinates.

    Attributes:
        time: (nt,).
        coordinates, velocities: (nt, n).
        angles, rates: (nt, nj) joint angles and their rates; continuous through full turns.
        eccentricity: (nt, nj, 2) journal centre minus bearing centre; zero for ideal joints.
        penetration: (nt, nj) eccentricity minus clearance; negative is a gap.
        normal_force, tangential_force: (nt, nj) contact force on the journal, or the magnitude of an ideal joint's
            reaction and zero. Samples inside linearly implicit steps are those of their interpolant, in which a journal
            that leans on its bearing with 0.2 N may seem to with up to 10: after changes of the motor torque, in 0.02 %
            of the time of quiet deployments; those inside steps of modal-radau follow the step's polynomial. Peak
            forces and integrals are free of that.
        joint_force: (nt, nj, 2) force on the outboard body.
        spring_torque, cable_torque, latch_torque, motor_torque: (nt, nj) on the joint angle. The latch torque includes
            the stow stop's.
        energies: name -> (nt,); stored: kinetic, spring, cable, latch, contact, elastic, gravity (of all constant
            forces); put in: motor_work, cable_work (zero for a loop whose torque ratio is its wheel ratio),
            external_work (of drives and load torques); lost: contact_dissipation, friction_dissipation,
            latch_dissipation, material_dissipation; residual: stored - initially stored - put in + lost.
        sliding_work, impulse: (nt, nj) integrals of normal force * |sliding speed| and of the force since t = 0.
        wear_journal, wear_bearing: (nj, bins) depth at the end, by angle in the surface's own body frame.
        contacts: structured array of all contacts in the order of their ends; those still open come last, with
            end_s = nan.
        latch_times: (nj,) nan if not latched.
        peak_force, postlock_peak_force: (nj,) over all accepted steps; post-lock counts from the first latching.
        postlock_impulse, postlock_sliding_work: (nj,).
        contact_starts: (nj,).
        clearance, journal_radius: (nj,) zero for ideal joints.
        metadata: model, integrator, counts of steps and evaluations, wall time, parameters; and where the laws of
            contact and friction were at their limits: `slow_contacts`, the number of contacts that began below the
            minimum impact speed and bounce too much; `creeping_share`, the share of the samples in contact at which
            the surfaces crept on the friction ramp, where Coulomb's law might stick; `cut_off_share`, the share at
            which the contact's damping would have pulled and the force is cut off at zero.
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
    energies: dict[str, Array]
    sliding_work: Array
    impulse: Array
    wear_journal: Array
    wear_bearing: Array
    contacts: NDArray[np.void]
    latch_times: Array
    peak_force: Array
    postlock_peak_force: Array
    postlock_impulse: Array
    postlock_sliding_work: Array
    contact_starts: NDArray[np.int64]
    clearance: Array
    journal_radius: Array
    metadata: dict[str, Any]

    @property
    def energy_put_in(self) -> float:
        """Energy stored at t = 0 in springs, cables and motion, plus what motor, cable, drives and loads added [J].

        What they took out in the end does not count.
        """
        names = ("kinetic", "spring", "cable", "latch", "contact", "elastic")
        stored = sum(float(self.energies[name][0]) for name in names)
        return stored + sum(
            max(float(self.energies[name][-1]), 0.0) for name in ("motor_work", "cable_work", "external_work")
        )

    @property
    def energy_residual(self) -> float:
        """Greatest magnitude over the samples of the energy that the books do not account for [J]."""
        return float(np.max(np.abs(self.energies["residual"])))

    @property
    def wear_depth(self) -> Array:
        """(nj,) deepest wear of journal or bearing [m]."""
        return np.maximum(self.wear_journal.max(axis=1), self.wear_bearing.max(axis=1))

    @property
    def stability_bound_share(self) -> float:
        """Fraction of the steps that were bounded by the stability of the explicit method on the flexible bodies'
        axial vibration; zero with rigid bodies alone and with generalized-alpha, which has no such bound.

        Fewer elements make these steps longer, a looser tolerance does not.
        """
        return float(self.metadata["stability_bound_steps"] / self.metadata["steps"])

    def summary(self) -> dict[str, Any]:
        """Figures of the whole run as plain Python values, ready for JSON; nan becomes None."""

        def plain(values: NDArray[Any]) -> list[Any]:
            return [None if isinstance(x, float) and math.isnan(x) else x for x in values.tolist()]

        return {
            "model": self.metadata.get("model"),
            "panels": self.metadata.get("panels"),
            "elements": self.metadata.get("elements"),
            "modes": self.metadata.get("modes"),
            "integrator": self.metadata.get("integrator"),
            "status": "completed",
            "duration_s": float(self.time[-1] - self.time[0]),
            "latch_times_s": plain(self.latch_times),
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
            **{name: self.metadata.get(name) for name in _COSTS_AND_LIMITS},
        }

    def save(self, path: str | Path) -> None:
        """Write all arrays and the metadata to a compressed npz file."""
        arrays: dict[str, Any] = {}
        for item in fields(self):
            value = getattr(self, item.name)
            if item.name == "energies":
                arrays.update({f"energies/{name}": series for name, series in value.items()})
            elif item.name == "metadata":
                arrays["metadata"] = np.array(json.dumps(value))
            else:
                arrays[item.name] = value
        with open(path, "wb") as file:
            np.savez_compressed(file, **arrays)

    @classmethod
    def load(cls, path: str | Path) -> Trajectory:
        """Read a file that `save` wrote.

        Raises:
            ValueError: if the file is not such a file.
        """
        with open(path, "rb") as file:
            if not zipfile.is_zipfile(file):
                raise ValueError(f"{path} is not a saved trajectory: it is no npz file")
        with np.load(path, allow_pickle=False) as data:
            missing = [f.name for f in fields(cls) if f.name != "energies" and f.name not in data]
            if missing:
                raise ValueError(f"{path} is not a saved trajectory: it lacks {', '.join(missing)}")
            prefix = "energies/"
            values: dict[str, Any] = {f.name: data[f.name] for f in fields(cls) if f.name in data}
            values["energies"] = {k[len(prefix) :]: data[k] for k in data.files if k.startswith(prefix)}
            values["metadata"] = json.loads(str(data["metadata"]))
        return cls(**values)
