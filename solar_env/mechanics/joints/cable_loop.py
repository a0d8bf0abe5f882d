"""Closed cable loops: belts over the wheels of two joints, along the body between these (paper, Eqs 2-4).

The inner wheel is fixed to the body inboard of the inner joint, the outer one to the body outboard of the outer joint.
The strands run from hinge to hinge, along the chord of the body between, its carrier: the angle by which a wheel turns
counts from there. On a rigid carrier that is the joint's angle. On one that bends the loop pulls at the hinges, across
the chord, and not at the slopes of the carrier's ends; its generalized forces are the gradients of the wheels' angles.
"""

import math

from solar_env.mechanics.bodies.markers import add_point_force, add_torque, place, spin, vector_angle, velocity
from solar_env.mechanics.numerics.jit import kernel


@kernel(inlined=True)
def cable_torque(cable, stretch):
    """Torque of a closed cable loop on its outer joint, its slope, and its energy, at a wheel-angle mismatch [rad].

    Two strands of equal stiffness; when the torque reaches twice the preload's, one is slack and only the other acts
    on (tensions are never negative: paper, Eqs 2-4).
    """
    taut_limit = 2.0 * cable.preload_torque / cable.stiffness if cable.stiffness > 0.0 else math.inf
    if abs(stretch) <= taut_limit:
        return cable.stiffness * stretch, cable.stiffness, 0.5 * cable.stiffness * stretch * stretch
    excess = abs(stretch) - taut_limit
    torque = 2.0 * cable.preload_torque + 0.5 * cable.stiffness * excess
    energy = (
        0.5 * cable.stiffness * taut_limit**2 + (cable.preload_torque * 2.0 + 0.25 * cable.stiffness * excess) * excess
    )
    return math.copysign(torque, stretch), 0.5 * cable.stiffness, energy


@kernel(inlined=True)
def chord(cable, joints, markers, q):
    """Vector [m] along a carrier that bends, from hinge to hinge; it points as the carrier's directions do."""
    ax, ay = place(markers[joints[cable.joint_a].outboard], q)
    bx, by = place(markers[joints[cable.joint_b].inboard], q)
    return cable.chord_sense * (bx - ax), cable.chord_sense * (by - ay)


@kernel(inlined=True)
def wheel_angles(cable, joints, markers, q, inner, outer):
    """Angles [rad] of the inner and the outer wheel against the chord, at those of the loop's joints."""
    if cable.chord_sense != 0:
        a, b = joints[cable.joint_a], joints[cable.joint_b]
        x, y = chord(cable, joints, markers, q)
        inner += a.sign * vector_angle(markers[a.outboard], q, x, y)
        outer -= b.sign * vector_angle(markers[b.inboard], q, x, y)
    return inner, outer


@kernel(inlined=True)
def inner_wheel_rate(cable, joints, markers, q, v, rate):
    """Rate [rad/s] of the inner wheel's angle, at that of its joint."""
    if cable.chord_sense != 0:
        a, b = joints[cable.joint_a], joints[cable.joint_b]
        x, y = chord(cable, joints, markers, q)
        ax, ay = velocity(markers[a.outboard], q, v)
        bx, by = velocity(markers[b.inboard], q, v)
        turn = cable.chord_sense * (x * (by - ay) - y * (bx - ax)) / (x * x + y * y)
        rate += a.sign * (turn - spin(markers[a.outboard], q, v))
    return rate


@kernel(inlined=True)
def end_torques(cable, joints, torque):
    """Torques [N m] that the wheels exert on the carrier: at the inner and at the outer joint.

    Args:
        cable: row of the loop.
        joints: of the model.
        torque: of the loop on its outer joint [N m].
    """
    return -cable.torque_ratio * torque * joints[cable.joint_a].sign, -torque * joints[cable.joint_b].sign


@kernel(inlined=True)
def move_to_chord(cable, joints, markers, q, torque, force):
    """Turn the torques on the slopes of a carrier's ends, as of the joints, into forces across its chord.

    Args:
        cable: row of a loop whose carrier bends.
        joints, markers: of the model.
        q: (n,) coordinates.
        torque: of the loop on its outer joint [N m].
        force: (n,) generalized force, changed.
    """
    inner, outer = end_torques(cable, joints, torque)
    first, last = markers[joints[cable.joint_a].outboard], markers[joints[cable.joint_b].inboard]
    add_torque(first, q, -inner, force)
    add_torque(last, q, -outer, force)
    x, y = chord(cable, joints, markers, q)
    scale = cable.chord_sense * (inner + outer) / (x * x + y * y)
    add_point_force(first, q, scale * y, -scale * x, force)
    add_point_force(last, q, -scale * y, scale * x, force)
