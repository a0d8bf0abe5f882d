"""Linearly implicit treatment of forces that are stiff along one direction each: stops and lasting contacts.

The end slope of a beam element has next to no inertia, so that a latch's damper slows it within microseconds; a journal
that rests in its bearing could vibrate on the contact's stiffness within milliseconds. Explicit steps would have to
resolve these times even if nothing moves. However, the stiff part A of the Jacobian of y' = f(y), y = (q, v), is known.
Let g be the gradient of the stop's angle or of the contact's depth, and w the accelerations due to a unit force and the
friction that it causes. The stiffness is k, the damping c. If y changes by (dq, dv), A changes v' by
-w (k g.dq + c g.dv). In a contact A also changes q' = v, but only by the part of dv that changes the depth, because
other motions are not stiff. A W-method (T. Steihaug and A. Wolfbrandt, Math. Comput. 33 (1979) 521,
doi:10.1090/S0025-5718-1979-0521273-8) includes A in the stages,

k_i = f(y + h sum_j alpha_ij k_j) + h A sum_j gamma_ij k_j + h gamma_i r,

which needs a system of equations in every stage, with each stiff force's rate of change as an unknown. With A = 0 the
method is the Runge-Kutta method itself. Contacts need the last term (E. Hairer and G. Wanner, Solving Ordinary
Differential Equations II, 1996, section IV.7, doi:10.1007/978-3-642-05221-7): A has only the changes of the stiff
forces, but the load that a contact carries also changes with all other forces. In this term r is the rate of change of
f without A's part, and gamma_i is the sum of gamma_ij over j.
"""

import numpy as np

from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.bodies.markers import add_point_force, add_torque, spin
from solar_env.mechanics.equations.constraints import prepare_response
from solar_env.mechanics.equations.system import acceleration_response, accelerations
from solar_env.mechanics.joints.contact import contact_motion, friction_share, normal_force
from solar_env.mechanics.joints.joint import joint_motion, penetration, relative
from solar_env.mechanics.joints.torques import hinge
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.linear import copy_into, lu_factor, lu_solve
from solar_env.mechanics.records.history import IMPACT_DURATIONS

# gamma_ij on and below the diagonal, for the stages of Kutta's 3/8 rule and for the stage that only the error estimate
# uses. Method and embedded estimate have order 3 for any A. For linear equations with the Jacobian A the method has
# order 4 and is A-stable: vibrations decay at every step size, infinitely fast ones to a third per step.
DIAGONAL = 0.5
COUPLING = (
    (0.0, 0.0, 0.0, 0.0),
    (-2.0 / 3.0, 0.0, 0.0, 0.0),
    (-1.0 / 6.0, -0.5, 0.0, 0.0),
    (1.5, 1.5, -3.0, 0.0),
    (1.875, -0.375, -1.125, -0.375),
)
# Products of step and decay rate, or of step and angular frequency, below which explicit steps need no correction.
_STIFF_DAMPING = 0.3
_STIFF_CONTACT = 2.4
# Fraction of the step over which `measure_rest` takes a difference.
_PROBE = 0.1


@kernel
def product(a, b):
    """Return the scalar product of two vectors."""
    total = 0.0
    for i in range(a.size):
        total += a[i] * b[i]
    return total


@kernel
def past_sum(values, stage, i):
    """Return the sum, over stages s before `stage`, of the W-method's gamma[`stage`, s] times entry `values[s, i]`."""
    total = 0.0
    for s in range(min(stage, 4)):
        total += COUPLING[stage][s] * values[s, i]
    return total


@kernel
def contact_directions(joint, markers, q, v, gradient, force):
    """Add the gradient of a contact's depth to `gradient` (n,), and write the direction of its resistance to `force`.

    `force` (n,) gets -Q / N: N is the normal force, and Q is the contact's generalized force, friction included.
    """
    outboard, inboard = markers[joint.outboard], markers[joint.inboard]
    ex, ey = relative(joint, markers, q)
    ux, uy = relative(joint, markers, v)
    motion = contact_motion(joint, ex, ey, ux, uy, spin(outboard, q, v), spin(inboard, q, v))
    nx, ny = motion.normal_x, motion.normal_y
    add_point_force(outboard, nx, ny, gradient)
    add_point_force(inboard, -nx, -ny, gradient)
    share, _ = friction_share(joint, motion.sliding_speed)
    friction = joint.friction_coefficient * share
    copy_into(force, gradient)
    add_point_force(outboard, -friction * ny, friction * nx, force)
    add_point_force(inboard, friction * ny, -friction * nx, force)
    add_torque(outboard, q, friction * joint.journal_radius, force)
    add_torque(inboard, q, -friction * motion.lever, force)


@kernel
def lasts(joint_state, time):
    """Return whether a joint is in lasting contact at `time` [s]: its impact, which short steps resolve, is over."""
    return (
        joint_state.in_contact != 0
        and time - joint_state.contact_start >= IMPACT_DURATIONS * joint_state.contact_duration
    )


@kernel
def may_be_stiff(model, state):
    """Return whether any joint's force could be stiff at the state, by a check that costs next to nothing."""
    flexible, time, found = model.flexible != 0, state.clock[0].time, False
    joint_states = state.joints
    for j in range(joint_states.size):
        joint_state = joint_states[j]
        found = found or (hinge.may_be_stiff(model.joints[j], joint_state) if flexible else lasts(joint_state, time))
    return found


@kernel
def collect(model, state, work, stiff, h):
    """Find the forces that are stiff over a step `h` [s]; return (their number, whether they are contacts).

    `stiff` gets their joints, stiffness, damping, gradients, and accelerations by a unit force. If there are beams,
    only hinge damping counts: beams' small inertias make it stiff, and their axial vibrations bound the step more than
    contacts do. Between rigid bodies only lasting contacts count.
    """
    joints, markers, q, v = model.joints, model.markers, state.q, state.v
    flexible = model.flexible != 0
    # Typed: for a literal Numba would compile functions with this argument twice.
    count, prepared = np.int64(0), False
    for j in range(joints.size):
        joint, joint_state = joints[j], state.joints[j]
        stiffness, damping, stop_damping = 0.0, 0.0, 0.0
        if flexible and hinge.may_be_stiff(joint, joint_state):
            angle, rate, _, _ = joint_motion(joint, markers, q, v)
            torques = hinge.hinge_torques(joint, joint_state, angle, rate)
            damping, stop_damping = -torques.by_rate, -torques.latch_by_rate
        elif not flexible and lasts(joint_state, state.clock[0].time):
            depth, rate = penetration(joint, markers, q, v)
            _, _, stiffness, damping = normal_force(joint, depth, rate, joint_state.impact_speed)
        if stiffness == 0.0 and damping == 0.0:
            continue
        if not prepared:
            if not prepare_response(model, q, state.clock[0].time, work):
                return count, False
            prepared = True
        gradient, response = stiff.gradient[count], stiff.response[count]
        for i in range(q.size):
            gradient[i] = 0.0
        if flexible:
            add_torque(markers[joint.outboard], q, joint.sign, gradient)
            add_torque(markers[joint.inboard], q, -joint.sign, gradient)
            copy_into(work.row_force, gradient)
        else:
            contact_directions(joint, markers, q, v, gradient, work.row_force)
        acceleration_response(model, q, work, work.row_force, response)
        inverse_mass = product(gradient, response)
        if stiffness > 0.0:
            if max(h * h * stiffness * inverse_mass / _STIFF_CONTACT, h * damping * inverse_mass) < _STIFF_CONTACT:
                continue
        elif h * damping * inverse_mass < _STIFF_DAMPING:
            continue
        if flexible:
            stiff.shares[count, 0], stiff.shares[count, 1] = stop_damping / damping, joint.damping / damping
        stiff.joint[count] = j
        stiff.stiffness[count] = stiffness
        stiff.damping[count] = damping
        count += 1
    return count, not flexible


@kernel
def separate_motions(stiff, count):
    """Compute velocities at which one contact's depth changes at unit rate, and the other contacts' depths do not.

    `stiff` lists `count` lasting contacts. Row k of `stiff.response` has the accelerations due to a unit force in
    contact k. Element [i, k] of `stiff.matrix` is the scalar product of this row and the gradient of contact i's depth;
    the matrix is replaced by its LU factors. Row k of `stiff.motion` gets the velocities for contact k, which are a
    linear combination of the rows of `stiff.response`. Return False if the matrix is singular.
    """
    if not lu_factor(stiff.matrix, count):
        return False
    for k in range(count):
        for i in range(count):
            stiff.past[i] = 0.0
        stiff.past[k] = 1.0
        lu_solve(stiff.matrix, count, stiff.past)
        motion = stiff.motion[k]
        for x in range(motion.size):
            motion[x] = 0.0
            for i in range(count):
                motion[x] += stiff.past[i] * stiff.response[i, x]
    return True


@kernel
def measure_rest(model, state, work, stiff, count, start, h):
    """Compute in `stiff.rest` (n,) the rate of change of the accelerations that is not due to the `count` stiff forces.

    It is a difference quotient between `state`, with accelerations `start` (n,), and a point extrapolated by a tenth of
    the step `h` [s]. `work` and `state.multipliers` get this point's values. Return False if constraints are singular.
    """
    q, v, time = state.q, state.v, state.clock[0].time
    delta = _PROBE * h
    q1, v1, rest = stiff.probe_q, stiff.probe_v, stiff.rest
    for i in range(q.size):
        q1[i] = q[i] + delta * v[i]
        v1[i] = v[i] + delta * start[i]
    state.clock[0].evaluations += 1
    if not accelerations(model, state.joints, q1, v1, time + delta, work, rest, state.multipliers):
        return False
    for i in range(q.size):
        rest[i] = (rest[i] - start[i]) / delta
    for k in range(count):
        gradient = stiff.gradient[k]
        rate = stiff.stiffness[k] * product(gradient, v) + stiff.damping[k] * product(gradient, start)
        for i in range(q.size):
            rest[i] += rate * stiff.response[k, i]
    return True


@kernel
def begin_step(model, state, work, stiff, start, h):
    """Find the forces that are stiff over a step `h` [s], store them in `stiff`, and return their number.

    `stiff` also gets the factored equations that `correct_stage` solves; return 0 if the equations are singular.
    `state` is the state at the start of the step, and `start` (n,) are the accelerations there; `work` is scratch.
    """
    count, contacts = collect(model, state, work, stiff, h)
    if count == 0:
        return 0
    for i in range(count):
        for k in range(count):
            stiff.coupling[i, k] = product(stiff.gradient[i], stiff.response[k])
            stiff.matrix[i, k] = stiff.coupling[i, k]
    if contacts and not (separate_motions(stiff, count) and measure_rest(model, state, work, stiff, count, start, h)):
        return 0
    for i in range(count):
        stiff.resistance[i] = stiff.damping[i] + h * DIAGONAL * stiff.stiffness[i]
        for k in range(count):
            stiff.matrix[i, k] = h * DIAGONAL * stiff.coupling[i, k]
        stiff.matrix[i, i] += 1.0 / stiff.resistance[i]
    return count if lu_factor(stiff.matrix, count) else 0


@kernel
def correct_stage(stiff, stage, h, velocity, acceleration, power):
    """Add the W-method's implicit terms, for the forces that `stiff` lists, to stage `stage` of a step `h` [s].

    They are added to row `stage` of `velocity` and `acceleration` (stages, n). In the same row of `power` (stages,
    integrals), the rates of loss, sliding work and impulse of the affected joints follow the corrected forces.
    """
    count = stiff.active[0]
    force_rate, right, a = stiff.force_rate, stiff.force_rate[stage], acceleration[stage]
    share = DIAGONAL
    for s in range(min(stage, 4)):
        share += COUPLING[stage][s]
    for x in range(a.size):
        a[x] += h * share * stiff.rest[x]
    for i in range(count):
        stiff.past[i] = past_sum(force_rate, stage, i)
    for i in range(count):
        gradient, stiffness = stiff.gradient[i], stiff.stiffness[i]
        right[i] = product(gradient, a)
        for c in range(count):
            right[i] -= h * stiff.coupling[i, c] * stiff.past[c]
        if stiffness > 0.0:
            rate = product(gradient, velocity[stage]) + h * past_sum(stiff.closing, stage, i)
            right[i] += stiffness / stiff.resistance[i] * rate
    lu_solve(stiff.matrix, count, right)
    for i in range(count):
        force = h * (DIAGONAL * right[i] + stiff.past[i])
        for x in range(a.size):
            a[x] -= force * stiff.response[i, x]
        first = m.INTEGRALS_PER_JOINT * stiff.joint[i]
        if stiff.stiffness[i] > 0.0:
            add_force_to_powers(power[stage], first, force)
        else:
            # Stop and damper dissipate with the torque that the step uses, not with the torque at the stage's speed.
            taken = force * product(stiff.gradient[i], velocity[stage])
            stop, damper = stiff.shares[i, 0], stiff.shares[i, 1]
            power[stage, first + m.LATCH_DISSIPATION] += stop * taken
            power[stage, first + m.DAMPER_DISSIPATION] += damper * taken
            power[stage, first + m.HINGE_FRICTION_DISSIPATION] += (1.0 - stop - damper) * taken
    for i in range(count):
        if stiff.stiffness[i] > 0.0:
            stiff.closing[stage, i] = product(stiff.gradient[i], a)
            speed = h * (DIAGONAL * stiff.closing[stage, i] + past_sum(stiff.closing, stage, i))
            for x in range(a.size):
                velocity[stage, x] += speed * stiff.motion[i, x]


@kernel
def add_force_to_powers(power, first, force):
    """Add `force` [N] to a contact's normal force in `power`, where the joint's entries begin at index `first`.

    The rates of friction loss, sliding work and impulse (the normal force itself) are multiplied by new / old force.
    """
    normal = power[first + m.IMPULSE]
    if normal > 0.0:
        scale = max(1.0 + force / normal, 0.0)
        power[first + m.FRICTION_DISSIPATION] *= scale
        power[first + m.SLIDING_WORK] *= scale
        power[first + m.IMPULSE] *= scale
