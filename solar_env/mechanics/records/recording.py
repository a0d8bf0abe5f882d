"""Recorder of a run: samples at requested times, and one row for every contact. Both are optional."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.arrays.columns import LOAD_COLUMNS
from solar_env.mechanics.arrays.model import ENERGY_NAMES, IMPULSE, INTEGRALS_PER_JOINT, SLIDING_WORK, Model, State
from solar_env.mechanics.equations.system import accelerations, stored_energies
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.linear import copy_into

CONTACT_FIELDS = ("joint", "start_s", "end_s", "impact_speed", "peak_force", "impulse", "sliding_work")


class Recorder(NamedTuple):
    """Sample times, table of samples, and table of contacts."""

    times: NDArray[np.float64]  # (samples,), ascending
    samples: NDArray[np.float64]  # (samples, columns), see `sample_columns`
    contacts: NDArray[np.float64]  # (capacity, len(CONTACT_FIELDS)); capacity 0 keeps no contacts
    filled: NDArray[np.int64]  # [samples taken, contacts kept]
    pause: NDArray[np.float64]  # (1,) pause time [s]: a call ends after the first accepted step that reaches it


def sample_columns(model: Model, state: State) -> dict[str, slice]:
    """Return the slices of a sample row by name: "q", "v", "loads" (of all joints), "energies" and "integrals"."""
    n, joints = state.q.size, model.joints.size
    sizes = {
        "q": n,
        "v": n,
        "loads": joints * LOAD_COLUMNS,
        "energies": len(ENERGY_NAMES),
        "integrals": state.integrals.size,
    }
    slices, start = {}, 0
    for name, size in sizes.items():
        slices[name] = slice(start, start + size)
        start += size
    return slices


def make_recorder(model: Model, state: State, times: NDArray[np.float64], contact_capacity: int) -> Recorder:
    """Allocate a recorder for sample times [s], with room for `contact_capacity` contacts between two emptyings."""
    columns = sample_columns(model, state)["integrals"].stop
    return Recorder(
        np.ascontiguousarray(times, dtype=np.float64),
        np.zeros((len(times), columns)),
        np.zeros((contact_capacity, len(CONTACT_FIELDS))),
        np.zeros(2, dtype=np.int64),
        np.full(1, math.inf),
    )


def with_more_room(recorder: Recorder) -> Recorder:
    """Return the recorder with a table of contacts for twice as many rows."""
    return recorder._replace(contacts=np.concatenate([recorder.contacts, np.zeros_like(recorder.contacts)]))


@kernel
def sample_due(recorder, time):
    """Return whether `time` [s] has reached the next requested sample time."""
    return recorder.filled[0] < recorder.times.size and recorder.times[recorder.filled[0]] <= time


@kernel
def pause_due(recorder, time, joints):
    """Return whether to pause: the requested time is reached, or the table of contacts might overflow in the next step.

    A step can end one contact of every joint; `joints` is their number. A pause changes no step and no bit of a result.
    """
    capacity = recorder.contacts.shape[0]
    return time >= recorder.pause[0] or (capacity > 0 and recorder.filled[1] + joints > capacity)


@kernel(inlined=False)
def record_sample(recorder, model, joint_states, q, v, time, integrals, work, a, multipliers, energies):
    """Compute loads and energies of an interpolated state `q`, `v`; write all to the next row of `recorder.samples`.

    The row also gets `integrals`: works, losses and impulses up to `time` [s]. `work` holds the contacts' impact speeds
    and scratch arrays. The arguments `a`, `multipliers` and `energies` are memory for intermediate results.
    """
    accelerations(model, joint_states, q, v, time, work, a, multipliers)
    stored_energies(model, joint_states, q, v, work.loads, energies)
    row = recorder.samples[recorder.filled[0]]
    n = q.size
    copy_into(row[:n], q)
    copy_into(row[n : 2 * n], v)
    k = 2 * n
    for j in range(model.joints.size):
        for c in range(LOAD_COLUMNS):
            row[k] = work.loads[j, c]
            k += 1
    copy_into(row[k : k + energies.size], energies)
    copy_into(row[k + energies.size :], integrals)
    recorder.filled[0] += 1


@kernel
def record_contact(recorder, j, joint_state, integrals, end):
    """Write joint `j`'s contact, ended at `end` [s], to `recorder.contacts`; `integrals` give its impulse and work."""
    if recorder.contacts.shape[0] == 0:
        return
    row = recorder.contacts[recorder.filled[1]]
    row[0] = j
    row[1] = joint_state.contact_start
    row[2] = end
    row[3] = joint_state.impact_speed
    row[4] = joint_state.contact_peak
    row[5] = integrals[INTEGRALS_PER_JOINT * j + IMPULSE] - joint_state.contact_impulse
    row[6] = integrals[INTEGRALS_PER_JOINT * j + SLIDING_WORK] - joint_state.contact_sliding_work
    recorder.filled[1] += 1
