"""Rows of joints and cable loops in a compiled mechanism: angle, spring, stop, bearing, and the loop's chord."""

import math

import numpy as np

from solar_env.mechanics.joints.friction.laws import SLIDING_READINGS
from solar_env.mechanics.mechanism.description import Bearing, CableLoop, FlexibleBody, Joint, Mechanism, ModalPanel


def fill_joint(record: np.void, joint: Joint) -> None:
    """Fill what a joint's row, of `model.joint_type`, holds of its angle, its spring and its stop."""
    turn = joint.folded_angle + joint.sign * joint.middle
    record["sign"] = joint.sign
    record["middle"] = joint.middle
    record["turn_cos"] = math.cos(turn)
    record["turn_sin"] = math.sin(turn)
    if joint.spring is not None:
        record["spring_stiffness"] = joint.spring.stiffness
        record["spring_preload_angle"] = joint.spring.preload_angle
    if joint.stop is not None:
        for name in ("gap", "stiffness", "exponent", "ramp_depth", "damping"):
            record[f"stop_{name}"] = getattr(joint.stop, name)
    if joint.lock_angle is not None:
        record["has_latch"] = 1
        record["lock_angle"] = joint.lock_angle
    if joint.stow_angle is not None:
        record["has_stow_stop"] = 1
        record["stow_angle"] = joint.stow_angle
    record["angle_limited"] = joint.spring is not None or joint.stop is not None


def fill_bearing(record: np.void, bearing: Bearing) -> None:
    """Fill what the row of a joint with clearance holds of its bearing and of the laws of contact and friction."""
    record["clearance"] = bearing.clearance
    record["journal_radius"] = bearing.journal_radius
    for kind, law in (("contact", bearing.contact), ("friction", bearing.friction)):
        parameters = law.parameters()
        record[f"{kind}_law"] = law.code
        record[kind][: len(parameters)] = parameters
    record["minimum_impact_speed"] = bearing.minimum_impact_speed
    record["friction_coefficient"] = bearing.friction_coefficient
    record["sliding"] = SLIDING_READINGS.index(bearing.sliding)
    record["wear_coefficient"] = bearing.wear_coefficient
    record["bearing_width"] = bearing.width


def chord_sense(mechanism: Mechanism, cable: CableLoop) -> int:
    """Whether the axis of a body that bends runs from a cable loop's first joint to its second (1) or back (-1).

    0 on a rigid body, against whose chord a wheel turns as against the body.

    Raises:
        ValueError: if both joints attach to one point of a body that bends.
    """
    joints = {joint.name: joint for joint in mechanism.joints}
    first, last = joints[cable.joint_a], joints[cable.joint_b]
    carrier = next((body for body in mechanism.bodies if body.name == first.outboard), None)
    if not isinstance(carrier, FlexibleBody | ModalPanel):
        return 0
    reach = last.inboard_point[0] - first.outboard_point[0]
    if abs(reach) < 1e-9 * carrier.length:
        raise ValueError(
            f"CableLoop.joint_b = {cable.joint_b!r}: attaches to {carrier.name!r} where {cable.joint_a!r} does; a belt "
            "along a body that bends needs two points of it"
        )
    return 1 if reach > 0.0 else -1
