"""Samples inside a step: the cubics through the coordinates, and the loads along their collocation polynomial."""

import math

from solar_env.mechanics.arrays import columns
from solar_env.mechanics.arrays.model import IDEAL
from solar_env.mechanics.joints.cable_loop import cable_torque
from solar_env.mechanics.joints.contact import friction_share
from solar_env.mechanics.joints.torques import enter_cable, enter_torques, hinge_torques
from solar_env.mechanics.modal.arrays import DEPTH, OTHER, SLIDING_SPEED, STRETCH
from solar_env.mechanics.modal.run.books import stored_energies
from solar_env.mechanics.modal.step.bodies import outboard_load
from solar_env.mechanics.modal.step.motion import look_at
from solar_env.mechanics.numerics.jit import kernel

# Step [s] in which velocities hardly change, while rounding shows in quotients of differences.
_SHORT = 1e-6


@kernel(inlined=True)
def cubic(share, x0, r0, x1, r1):
    """Value at a share of the step of the cubic through values and rates (times the step) at both ends."""
    rest = 1.0 - share
    return rest * rest * ((1.0 + 2.0 * share) * x0 + share * r0) + share * share * (
        (3.0 - 2.0 * share) * x1 - rest * r1
    )


@kernel
def fill_load_table(model, state, work, slot, loads, table):
    """Fill the (joints, LOAD_COLUMNS) table of loads from motion at a slot and `loads` (joints, 3)."""
    for j in range(model.joints.size):
        joint, own, motion, row = model.joints[j], state.joints[j], work.joints[j].motion[slot], table[j]
        clearance = joint.kind != IDEAL
        for column in range(columns.SHARED_COLUMNS):
            row[column] = motion[column]
        if not clearance:
            row[columns.ECCENTRICITY_X], row[columns.ECCENTRICITY_Y] = 0.0, 0.0
        fx, fy, _, _ = outboard_load(joint, own, loads[j], motion)
        row[columns.NORMAL] = loads[j, 0] if clearance else math.sqrt(fx * fx + fy * fy)
        row[columns.TANGENTIAL] = loads[j, 1] if clearance else 0.0
        row[columns.FORCE_X], row[columns.FORCE_Y] = fx, fy
        enter_torques(hinge_torques(joint, own, row[columns.ANGLE], row[columns.RATE]), j, table)
    for c in range(model.cables.size):
        cable = model.cables[c]
        torque, _, _ = cable_torque(cable, work.cables[c].motion[slot, STRETCH])
        enter_cable(cable, torque, table)


@kernel(inner=True)
def record_modal_sample(model, state, work, recorder, h, share):
    """Store one row at a share of the step from the present state to `work.q`.

    Velocities of frames are the rates of their cubics. Those of modes, which the step may not resolve, and integrals go
    along a line.
    """
    n, rest = state.q.size, 1.0 - share
    row = recorder.samples[recorder.filled[0]]
    for i in range(n):
        x0, v0, x1, v1 = state.q[i], state.v[i], work.q[i], work.v[i]
        row[i] = cubic(share, x0, h * v0, x1, h * v1)
        row[n + i] = v0 + share * (v1 - v0)
    if h > _SHORT:
        for b in range(model.bodies.size):
            for i in range(model.bodies[b].offset, model.bodies[b].offset + 3):
                rise, v0, v1 = (work.q[i] - state.q[i]) / h, state.v[i], work.v[i]
                row[n + i] = rest * (6.0 * share * rise + (1.0 - 3.0 * share) * v0) + share * (3.0 * share - 2.0) * v1
    look_at(model, row[:n], row[n : 2 * n], work, OTHER)
    for j in range(model.joints.size):
        for c in range(3):
            first, second = work.joints[j].load[0, c], work.joints[j].load[1, c]
            work.sample_load[j, c] = second + 1.5 * (share - 1.0) * (second - first)
        joint, motion = model.joints[j], work.joints[j].motion[OTHER]
        if joint.kind != IDEAL:
            # A polynomial knows neither the moment at which the surfaces part nor the one at which sliding turns round.
            normal = max(work.sample_load[j, 0], 0.0) if motion[DEPTH] > 0.0 else 0.0
            slip, _ = friction_share(joint, motion[SLIDING_SPEED])
            work.sample_load[j, 0], work.sample_load[j, 1] = normal, -joint.friction_coefficient * slip * normal
    fill_load_table(model, state, work, OTHER, work.sample_load, work.sample)
    stored_energies(model, state, row[:n], row[n : 2 * n], work, OTHER, work.energies)
    k = 2 * n
    for j in range(model.joints.size):
        for c in range(columns.LOAD_COLUMNS):
            row[k] = work.sample[j, c]
            k += 1
    for e in range(work.energies.size):
        row[k] = work.energies[e]
        k += 1
    for i in range(state.integrals.size):
        row[k] = state.integrals[i] + share * (work.integrals[i] - state.integrals[i])
        k += 1
    recorder.filled[0] += 1
