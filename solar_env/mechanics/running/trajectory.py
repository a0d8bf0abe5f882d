"""The result of a run: named arrays over time, totals by joint, every contact; saved to and loaded from npz."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.arrays.columns import TORQUES
from solar_env.mechanics.arrays.model import ENERGY_NAMES
from solar_env.support.files import writing
from solar_env.support.plain_arrays import MOST_BYTES, parse_json, read_arrays

Array = NDArray[np.float64]
_STORED = tuple(name for name in ENERGY_NAMES if name != "gravity")
_PUT_IN = (*(law.book for law in TORQUES if law.book and not law.lost), "external_work")
_ENERGIES = "energies/"  # before the names of their arrays in a file
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
        peak_force, postlock_peak_force: (nj,) over all accepted steps; post-lock counts from the first latching. With
            flexible panels and ideal joints the former has no limit: springs that act from one moment on send a wave
            into the panels, and the finer these are, the greater the reaction in its first tenth of a millisecond.
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
    def joint_torque(self) -> Array:
        """(nt, nj) sum of the torques on the joint angles [N m]."""
        return np.asarray(sum(getattr(self, law.name) for law in TORQUES))

    @property
    def energy_put_in(self) -> float:
        """Energy stored at t = 0 in springs, cables and motion, plus what motor, cable, drives and loads added [J].

        What they took out in the end does not count.
        """
        stored = sum(float(self.energies[name][0]) for name in _STORED)
        return stored + sum(max(float(self.energies[name][-1]), 0.0) for name in _PUT_IN)

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
            # Of a cable loop whose torque ratio is not its wheel ratio: what it destroys is negative.
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
            path: of the file.
            most_bytes: of all arrays together; a larger file is refused before it is inflated.

        Raises:
            OSError: if the file cannot be opened.
            ValueError: if it is not such a file, is damaged or too large.
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
            _check_arrays(values)
        except ValueError as error:
            raise ValueError(f"{path} is not a saved trajectory: {error}") from error
        return cls(**values)


def _check_arrays(values: dict[str, Any]) -> None:
    """Refuse arrays whose types or shapes are not those of a trajectory."""
    sizes = {"2": 2}
    if not isinstance(values["metadata"], dict):
        raise ValueError("its metadata are no mapping")
    for name, dimensions in {**_SHAPES, **{f"{_ENERGIES}{name}": ("nt",) for name in values["energies"]}}.items():
        array = values["energies"][name.removeprefix(_ENERGIES)] if name.startswith(_ENERGIES) else values[name]
        expected = _TYPES.get(name, np.dtype(np.float64))
        if array.dtype != expected:
            raise ValueError(f"{name} is of the type {array.dtype}; expected {expected}")
        shape = tuple(sizes.setdefault(letter, size) for letter, size in zip(dimensions, array.shape, strict=False))
        if array.shape != shape or len(dimensions) != array.ndim:
            raise ValueError(f"{name} has the shape {array.shape}, which does not fit {dimensions} of the others")
    if missing := {*_STORED, *_PUT_IN, "residual"} - set(values["energies"]):
        raise ValueError(f"it lacks the energies {', '.join(sorted(missing))}")
    if not sizes["nt"] or not sizes["bins"]:
        raise ValueError("it has no samples, or no bins of wear")


_BY_SAMPLE_AND_JOINT = (
    "angles", "rates", "penetration", "normal_force", "tangential_force", *(law.name for law in TORQUES),
    "sliding_work", "impulse",
)  # fmt: skip
_BY_JOINT = (
    "latch_times", "peak_force", "postlock_peak_force", "postlock_impulse", "postlock_sliding_work", "contact_starts",
    "clearance", "journal_radius",
)  # fmt: skip
_SHAPES = {
    "time": ("nt",),
    "coordinates": ("nt", "n"),
    "velocities": ("nt", "n"),
    **dict.fromkeys(_BY_SAMPLE_AND_JOINT, ("nt", "nj")),
    **dict.fromkeys(("eccentricity", "joint_force"), ("nt", "nj", "2")),
    **dict.fromkeys(("wear_journal", "wear_bearing"), ("nj", "bins")),
    **dict.fromkeys(_BY_JOINT, ("nj",)),
    "contacts": ("contacts",),
}
_TYPES: dict[str, np.dtype[Any]] = {"contacts": contact_record, "contact_starts": np.dtype(np.int64)}
