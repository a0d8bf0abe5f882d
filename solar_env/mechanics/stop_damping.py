"""Linearly implicit treatment of the stops' damping, which is stiff on the slope of a flexible body.

The end slope of a beam element has next to no inertia, so that a latch's damper slows it within microseconds; explicit
steps would have to follow. But this stiffness has a known shape: A = - sum over the joints of (acceleration response
to a unit torque) * (damping coefficient) * (gradient of the joint's rate). A W-method (T. Steihaug and A. Wolfbrandt,
Math. Comput. 33 (1979) 521, doi:10.1090/S0025-5718-1979-0521273-8) takes it in:

k_i = f(y + h sum_j alpha_ij k_j) + h A sum_j gamma_ij k_j,

with a system of equations of one unknown a joint for every stage. With A = 0 it is the Runge-Kutta method itself.
"""

from __future__ import annotations

from ._jit import njit_inlined, njit_inner
from .joint import add_torque, joint_motion, spin, stop_torque
from .linear import cholesky_factor, cholesky_solve
from .system import acceleration_response, prepare_response

# gamma_ij below the diagonal, for the stages of Kutta's 3/8 rule and for the one that only the error estimate uses.
# They solve: order 3 for any A, and for the embedded estimate as well as its free parameters allow; order 4 for linear
# equations whose Jacobian is A; damping at infinity.
DIAGONAL = 0.22042841025921232
COUPLING = (
    (0.0, 0.0, 0.0, 0.0),
    (-0.20803407802114088, 0.0, 0.0, 0.0),
    (0.6299215858242412, -1.0955670708188088, 0.0, 0.0),
    (2.875, -5.876337475399026, 3.2589488823724513, 0.0),
    (-3.844589453283399, 7.694610166128818, -3.514946886302746, -0.3350738265426753),
)
# Below this product of step and decay rate the explicit method needs no help.
_STIFF = 0.3


@njit_inlined
def joint_rate(joint, markers, q, x):
    """Rate of the joint angle at a configuration ``q`` for velocities ``x``, or its acceleration's part linear in x."""
    return joint.sign * (spin(markers[joint.outboard], q, x) - spin(markers[joint.inboard], q, x))


@njit_inner
def begin_step(model, state, work, damping, h):
    """Collect the joints whose stop is stiff over a step ``h``, with their responses; returns their number.

    Args:
        model, state: of the mechanism, at the start of the step.
        work: workspace, changed.
        damping: a ``runge_kutta.StopDamping``, filled.
        h: step [s].
    """
    joints, markers, q = model.joints, model.markers, state.q
    count, prepared = 0, False
    for j in range(joints.size):
        own = state.joints[j]
        if not own.stop_engaged:
            continue
        joint = joints[j]
        angle, rate, _, _ = joint_motion(joint, markers, q, state.v)
        _, _, _, by_rate = stop_torque(joint, own, angle, rate)
        if by_rate == 0.0:
            continue
        if not prepared:
            if not prepare_response(model, q, state.clock[0].time, work):
                return 0
            prepared = True
        response = damping.response[count]
        for i in range(q.size):
            work.row_force[i] = 0.0
        add_torque(markers[joint.outboard], q, joint.sign, work.row_force)
        add_torque(markers[joint.inboard], q, -joint.sign, work.row_force)
        acceleration_response(model, q, work, work.row_force, response)
        if -by_rate * joint_rate(joint, markers, q, response) * h < _STIFF:
            continue
        damping.joint[count] = j
        damping.coefficient[count] = -by_rate
        count += 1
    for i in range(count):
        joint = joints[damping.joint[i]]
        for k in range(i + 1):
            damping.coupling[i, k] = joint_rate(joint, markers, q, damping.response[k])
            damping.coupling[k, i] = damping.coupling[i, k]
    for i in range(count):
        for k in range(i + 1):
            damping.matrix[i, k] = h * DIAGONAL * damping.coupling[i, k]
        damping.matrix[i, i] += 1.0 / damping.coefficient[i]
    # Positive definite: the joints' inverse inertias plus a positive diagonal.
    if count > 0 and not cholesky_factor(damping.matrix, count):
        return 0
    return count


@njit_inner
def correct_stage(model, q, damping, stage, h, k):
    """Turn the accelerations ``k`` of a stage into its derivative; ``q`` are the coordinates at the step's start."""
    joints, markers, count = model.joints, model.markers, damping.active[0]
    torque, right = damping.torque, damping.torque[stage]
    for i in range(count):
        damping.past[i] = 0.0
        for s in range(min(stage, 4)):
            damping.past[i] += COUPLING[stage][s] * torque[s, i]
    for i in range(count):
        total = joint_rate(joints[damping.joint[i]], markers, q, k)
        for c in range(count):
            total -= h * damping.coupling[i, c] * damping.past[c]
        right[i] = total
    cholesky_solve(damping.matrix, count, right)
    for i in range(count):
        weight = h * (DIAGONAL * right[i] + damping.past[i])
        for x in range(k.size):
            k[x] -= weight * damping.response[i, x]
