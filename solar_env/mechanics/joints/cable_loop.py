"""Closed cable loops: belts over the wheels of two joints, along the body between (Li et al. 2019, Eqs 2-4).

The inner wheel is fixed to the body inboard of the inner joint, the outer wheel to the body outboard of the outer
joint. The body between the joints is the carrier. The strands run along its chord, the straight line from hinge to
hinge, and the wheels' angles are measured relative to this chord. On a rigid carrier, they are the joints' angles. If
the carrier bends, the loop pulls at its hinges, across the chord, and exerts no torque on its ends.

A loop with a given wheel radius also pulls on the bearings (Eq 3). It runs between the wheels' centres, which differ
from the hinges by the clearances. The wheels' radii are r1 and r2, the distance of their centres is d. As d grows, each
strand lengthens with sqrt(d^2 - (r1 - r2)^2) + (r1 - r2) asin((r1 - r2) / d), whose slope by d is cos phi with sin phi
= (r1 - r2) / d. The two strands' tensions F1 and F2 exert torques (F1 - F2) r1 and (F1 - F2) r2 on the wheels. On the
wheels' centres they exert (F1 + F2) cos phi along the line of centres and (F1 - F2) sin phi across it, so that the
forces have a potential; Li et al. print (F1 + F2) sin phi for the component across it. Where both joints' angles grow
in the same sense, the strands cross: r1 + r2 replaces r1 - r2.
"""

import math

from solar_env.mechanics.bodies.markers import add_point_force, add_torque, place, spin, vector_angle
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.vectors import where_less


@kernel
def cable_torque(cable, stretch):
    """Return a cable loop's torque on its outer joint [N m], its slope by `stretch` [N m/rad], and its energy [J].

    `stretch` is the mismatch of the wheels' angles [rad], a number or a vector. The two strands are equally stiff.
    Beyond twice the preload's torque one strand is slack and the other acts alone: no tension is negative.
    """
    taut_limit = 2.0 * cable.preload_torque / cable.stiffness if cable.stiffness > 0.0 else math.inf
    magnitude = abs(stretch)
    excess = where_less(taut_limit, magnitude, magnitude - taut_limit, 0.0)
    torque = cable.stiffness * (magnitude - 0.5 * excess)
    slope = cable.stiffness * where_less(taut_limit, magnitude, 0.5, 1.0)
    energy = 0.5 * cable.stiffness * (magnitude * magnitude - 0.5 * excess * excess)
    return where_less(stretch, 0.0, -torque, torque), slope, energy


@kernel
def strand(cable, elongation):
    """Return a strand's tension [N], stiffness [N/m], energy [J]; elongation [m] and energy are zero at the preload."""
    stiffness = 0.5 * cable.stiffness / (cable.wheel_radius * cable.wheel_radius)
    preload = cable.preload_torque / cable.wheel_radius
    tension = preload + stiffness * elongation
    if tension <= 0.0:
        return 0.0, 0.0, -0.5 * preload * preload / stiffness
    return tension, stiffness, (preload + 0.5 * stiffness * elongation) * elongation


@kernel
def strand_length(offset, distance):
    """Return a strand's length [m] up to a constant; `offset`: difference (or sum, if crossed) of the wheels' radii."""
    return math.sqrt(distance * distance - offset * offset) + offset * math.asin(offset / distance)


@kernel
def belt_loads(cable, stretch, distance):
    """Return a cable loop's torque on the outer wheel, pull on the wheels' centres, stored energy, and three slopes.

    Args:
        cable: record of the loop (`model.cable_type`).
        stretch: mismatch of the wheels' angles [rad].
        distance: distance between the wheels' centres [m]; ignored where the loop does not pull.

    Returns:
        Torque [N m], pull [N], energy [J]; slope of the torque by `stretch`; slope of the torque by `distance`, equal
            to the pull's slope by `stretch`; slope of the pull by `distance`.
    """
    if cable.wheel_radius == 0.0:
        torque, slope, energy = cable_torque(cable, stretch)
        return torque, 0.0, energy, slope, 0.0, 0.0
    radius = cable.wheel_radius
    offset = cable.strand_offset
    longer = strand_length(offset, distance) - strand_length(offset, cable.rest_distance)
    tight, k1, energy1 = strand(cable, longer + radius * stretch)
    loose, k2, energy2 = strand(cable, longer - radius * stretch)
    cosine = math.sqrt(1.0 - (offset / distance) ** 2)
    by_distance = (k1 + k2) * cosine * cosine + (tight + loose) * offset * offset / (distance**3 * cosine)
    cross = radius * (k1 - k2) * cosine
    torque, pull = radius * (tight - loose), (tight + loose) * cosine
    return torque, pull, energy1 + energy2, radius * radius * (k1 + k2), cross, by_distance


@kernel
def chord(cable, markers, q):
    """Return the vector (x, y) [m] of a cable loop's chord, the line from the inner joint to the outer joint."""
    ax, ay = place(markers[cable.first], q)
    bx, by = place(markers[cable.last], q)
    return bx - ax, by - ay


@kernel
def wheel_motion(cable, joints, markers, q, inner, outer):
    """Return a cable loop's mismatch, wheel ratio * inner angle - outer angle [rad], and its joints' distance [m].

    If `cable.chord_sense` is 0, the wheels' angles are the joint angles `inner` and `outer` [rad], and the distance is
    given as 0. If it is 1 or -1, since the body between the joints bends or the loop pulls on the bearings, the angles
    are measured from the line between the joints.
    """
    length = 0.0
    if cable.chord_sense != 0:
        a, b = joints[cable.joint_a], joints[cable.joint_b]
        x, y = chord(cable, markers, q)
        length = math.sqrt(x * x + y * y)
        x, y = cable.chord_sense * x, cable.chord_sense * y
        inner += a.sign * vector_angle(markers[a.outboard], q, x, y)
        outer -= b.sign * vector_angle(markers[b.inboard], q, x, y)
    return cable.wheel_ratio * inner - outer, length


@kernel
def inner_wheel_rate(cable, joints, markers, q, v, rate):
    """Return the inner wheel's rate [rad/s] against the line between a loop's joints; `rate` is the inner joint's."""
    if cable.chord_sense != 0:
        a = joints[cable.joint_a]
        x, y = chord(cable, markers, q)
        ax, ay = place(markers[cable.first], v)
        bx, by = place(markers[cable.last], v)
        turn = (x * (by - ay) - y * (bx - ax)) / (x * x + y * y)
        rate += a.sign * (turn - spin(markers[a.outboard], q, v))
    return rate


@kernel
def end_torques(cable, joints, torque):
    """Return the torques (inner, outer) [N m] on the body between a loop's joints, given the outer joint's `torque`."""
    return -cable.torque_ratio * torque * joints[cable.joint_a].sign, -torque * joints[cable.joint_b].sign


@kernel
def chord_force(cable, markers, q, moment, pull):
    """Return the force (x, y) [N] on the outer end of a cable loop's chord, the line from inner to outer joint.

    With the opposite force on the inner end it exerts `moment` [N m] on the chord; `pull` [N] draws the ends together.
    """
    x, y = chord(cable, markers, q)
    square = x * x + y * y
    along = pull / math.sqrt(square)
    return -moment * y / square - along * x, moment * x / square - along * y


@kernel
def move_to_chord(cable, joints, markers, q, torque, pull, force):
    """Replace, in the generalized `force`, a cable loop's torques on its carrier by forces at the ends of its chord.

    The carrier is the body between the loop's joints, the chord is the line between these joints. `torque` acts on the
    outer joint [N m]; `pull` [N] draws the wheels' centres together. Call this only if `chord_sense` is not 0: the
    carrier bends, or the loop pulls on the bearings.
    """
    inner, outer = end_torques(cable, joints, torque)
    add_torque(markers[joints[cable.joint_a].outboard], q, -inner, force)
    add_torque(markers[joints[cable.joint_b].inboard], q, -outer, force)
    fx, fy = chord_force(cable, markers, q, inner + outer, pull)
    add_point_force(markers[cable.first], -fx, -fy, force)
    add_point_force(markers[cable.last], fx, fy, force)
