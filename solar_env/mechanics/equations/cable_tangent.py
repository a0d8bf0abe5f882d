"""Tangents of closed cable loops, for `tangent.fill_tangents`.

A loop runs over an inner and an outer wheel; its chord is the line between them. Let a, b, c and d be the gradients of
the inner wheel's angle, the outer wheel's angle, the chord's angle and the chord's length L. The torque T and the pull
N are functions of L and of the mismatch s = r * (inner angle) - (outer angle), with wheel ratio r. T_s, T_L, N_s and
N_L are their derivatives. With the torque ratio t, the generalized force Q = T (b - t a) - N d gives

dQ/dq = (b - t a) (T_s (r a - b) + T_L d)^T - d (N_s (r a - b) + N_L d)^T - N L c c^T + terms with Hessians
of the bodies' directions and of the chord's angle.
"""

import math

from solar_env.mechanics.arrays.columns import ANGLE
from solar_env.mechanics.bodies.markers import angle_hessian, fill_slopes, subtract_hessian
from solar_env.mechanics.joints.cable_loop import belt_loads, chord, end_torques, wheel_motion
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.profile import add_entry

# Rows of the gradients: inner and outer wheel's angle, chord's angle, chord's length.
_INNER, _OUTER, _TURN, _LENGTH = range(4)


@kernel
def add_cable_slopes(model, cable, q, v, tangent, by_q):
    """Subtract a cable loop's dQ/dq from the profile matrix `by_q`, where Q are the loop's generalized forces.

    Terms with Hessians of the bodies' direction angles must already be in `by_q`: `fill_tangents` adds them for each
    joint's total torque, cable loops included. `tangent` must hold joints' loads, angle gradients and coordinates.
    """
    joints, markers, elimination, loads = model.joints, model.markers, model.elimination, tangent.loads
    a, o = cable.joint_a, cable.joint_b
    index, gradient = tangent.cable_coordinates, tangent.cable_gradient
    if cable.chord_sense != 0:
        tangent.b[:] = 0.0
        fill_slopes(markers[cable.first], q, v, 0, index, tangent.b, tangent.rate_slope)
        fill_slopes(markers[cable.last], q, v, 1, index, tangent.b, tangent.rate_slope)
    gradient[:] = 0.0
    for c in range(8):
        index[c], index[8 + c] = tangent.coordinates[a, c], tangent.coordinates[o, c]
        gradient[_INNER, c], gradient[_OUTER, 8 + c] = tangent.angle_gradient[a, c], tangent.angle_gradient[o, c]
    stretch, length = wheel_motion(cable, joints, markers, q, loads[a, ANGLE], loads[o, ANGLE])
    torque, pull, _, slope, cross, pull_slope = belt_loads(cable, stretch, length)
    if cable.chord_sense != 0:
        add_chord_slopes(model, cable, q, torque, tangent, by_q)
    for r in range(16):
        push = gradient[_OUTER, r] - cable.torque_ratio * gradient[_INNER, r]
        for c in range(16):
            mismatch, longer = cable.wheel_ratio * gradient[_INNER, c] - gradient[_OUTER, c], gradient[_LENGTH, c]
            value = push * (slope * mismatch + cross * longer)
            value -= gradient[_LENGTH, r] * (cross * mismatch + pull_slope * longer)
            value -= pull * length * gradient[_TURN, r] * gradient[_TURN, c]
            if value != 0.0:
                add_entry(elimination, by_q, index[r], index[c], -value)


@kernel
def add_chord_slopes(model, cable, q, torque, tangent, by_q):
    """Write a cable loop's gradients to `tangent.cable_gradient` (4, 16), and correct the stiffness matrix `by_q`.

    The chord is the line between the loop's joints. The rows are gradients of the inner and outer wheel's angles and of
    the chord's angle and length, with respect to the joints' sixteen coordinates. In `by_q`, the loop still exerts
    torques, which follow from its `torque` [N m] on the outer joint, on the two ends of the body between the joints.
    Really it acts by forces on the chord's ends. The torques times the Hessians of the ends' direction angles are
    therefore replaced by the sum of the torques times the Hessian of the chord's angle.
    """
    joints, markers, elimination = model.joints, model.markers, model.elimination
    inner, outer = joints[cable.joint_a], joints[cable.joint_b]
    places, index, gradient = tangent.b, tangent.cable_coordinates, tangent.cable_gradient
    x, y = chord(cable, markers, q)
    square = x * x + y * y
    length = math.sqrt(square)
    for c in range(4):
        gradient[_INNER, c] = gradient[_OUTER, 12 + c] = 0.0
    # The loop has sixteen coordinates: for each joint, four of the outboard body, then four of the inboard body.
    first, last = (0, 12) if cable.first == inner.outboard else (4, 8)
    for c in range(8):
        sense = 1.0 if c >= 4 else -1.0
        places[0, c] *= sense
        places[1, c] *= sense
        k = last + c - 4 if c >= 4 else first + c
        gradient[_TURN, k] = (x * places[1, c] - y * places[0, c]) / square
        gradient[_LENGTH, k] = (x * places[0, c] + y * places[1, c]) / length
    for k in range(16):
        gradient[_INNER, k] += inner.sign * gradient[_TURN, k]
        gradient[_OUTER, k] -= outer.sign * gradient[_TURN, k]
    inner_torque, outer_torque = end_torques(cable, joints, torque)
    subtract_hessian(markers[inner.outboard], q, -inner_torque, elimination, by_q)
    subtract_hessian(markers[outer.inboard], q, -outer_torque, elimination, by_q)
    moment = inner_torque + outer_torque
    hxx, hxy = angle_hessian(x, y)
    for r in range(8):
        along, across = hxx * places[0, r] + hxy * places[1, r], hxy * places[0, r] - hxx * places[1, r]
        row = last + r - 4 if r >= 4 else first + r
        for c in range(8):
            value = moment * (along * places[0, c] + across * places[1, c])
            if value != 0.0:
                column = last + c - 4 if c >= 4 else first + c
                add_entry(elimination, by_q, index[row], index[column], -value)
