"""Functions that write the records of joints, bearings and cable loops (`arrays/model.py`) from their descriptions."""

import math

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.joints.laws import SLIDING_READINGS
from solar_env.mechanics.joints.torques.table import compile_table, steepest_slope
from solar_env.mechanics.mechanism.description import Bearing, CableLoop, FlexibleBody, Joint, Mechanism, ModalPanel


def fill_joint(record: np.void, joint: Joint) -> None:
    """Write angles, springs, harness, damper, friction, stops and hold-down to a joint's `model.joint_type` record."""
    turn = joint.folded_angle + joint.sign * joint.middle
    record["sign"] = joint.sign
    record["middle"] = joint.middle
    record["turn_cos"] = math.cos(turn)
    record["turn_sin"] = math.sin(turn)
    if joint.spring is not None:
        record["spring_stiffness"] = joint.spring.stiffness
        record["spring_preload_angle"] = joint.spring.preload_angle
    record["known_stiffness"] = record["spring_stiffness"]
    for name, points in (("spring", joint.spring_table), ("harness", joint.harness)):
        record[f"{name}_points"], record[f"{name}_table"] = len(points), compile_table(points)
        record["known_stiffness"] += steepest_slope(points)
    record["damping"], record["friction_torque"] = joint.damping, joint.friction_torque
    record["friction_ramp_rate"] = joint.friction_ramp_rate
    if joint.stop is not None:
        for name in ("gap", "stiffness", "exponent", "ramp_depth", "damping"):
            record[f"stop_{name}"] = getattr(joint.stop, name)
    if joint.lock_angle is not None:
        record["has_latch"], record["one_sided"] = 1, not joint.latches
        record["lock_angle"] = joint.lock_angle
    if joint.stow_angle is not None:
        record["has_stow_stop"] = 1
        record["stow_angle"] = joint.stow_angle
    if joint.release_time is not None:
        record["is_held"], record["release_time"] = 1, joint.release_time
    record["angle_limited"] = any((joint.spring, joint.stop, joint.spring_table, joint.harness))


def fill_bearing(record: np.void, bearing: Bearing) -> None:
    """Write a clearance joint's bearing, contact law and friction law to its record (`model.joint_type`)."""
    for name in ("clearance", "journal_radius", "minimum_impact_speed", "friction_coefficient", "wear_coefficient"):
        record[name] = getattr(bearing, name)
    record["contact"] = bearing.contact.parameters()
    record["friction_speed_zero"], record["friction_speed_full"] = bearing.friction_speeds
    record["sliding"] = SLIDING_READINGS.index(bearing.sliding)
    record["bearing_width"] = bearing.width


def fill_cable(record: np.void, cable: CableLoop, mechanism: Mechanism, joints: NDArray[np.void]) -> None:
    """Write a cable loop's parameters to its record (`model.cable_type`); the joints' records must have their markers.

    Raises:
        ValueError: if the joints are not on the axis of the body between them, although the loop measures its wheels'
            angles from the line between joints (`chord_sense`), or if its wheels do not fit between the joints.
    """
    places = {joint.name: k for k, joint in enumerate(mechanism.joints)}
    a, b = (record["joint_a"], record["joint_b"]) = places[cable.joint_a], places[cable.joint_b]
    for name in ("wheel_ratio", "torque_ratio", "stiffness", "preload_torque"):
        record[name] = getattr(cable, name)
    record["chord_sense"] = chord_sense(mechanism, cable)
    if cable.wheel_radius is not None:
        reach = mechanism.joints[b].inboard_point[0] - mechanism.joints[a].outboard_point[0]
        radii = cable.wheel_radius * (1.0 + cable.wheel_ratio)
        if radii >= abs(reach):
            raise ValueError(
                f"CableLoop.wheel_radius = {cable.wheel_radius!r}: two wheels of {radii:.6g} m together do not fit "
                f"between joints {abs(reach):.6g} m apart"
            )
        crossing = mechanism.joints[a].sign * mechanism.joints[b].sign
        record["strand_offset"] = cable.wheel_radius * (cable.wheel_ratio + crossing)
        record["wheel_radius"], record["rest_distance"] = cable.wheel_radius, abs(reach)
    enter_chord(record, joints)


def enter_chord(record: np.void, joints: NDArray[np.void]) -> None:
    """Write the indices of the markers at both ends of a cable loop's chord, the line between its wheels, to `record`.

    `joints` are the records of all joints. The markers lie on the body between the loop's joints or, if the loop pulls
    on the bearings (has a wheel radius), on the two bodies to which its wheels are fixed.
    """
    ends = ("inboard", "outboard") if record["wheel_radius"] > 0.0 else ("outboard", "inboard")
    record["first"], record["last"] = joints[record["joint_a"]][ends[0]], joints[record["joint_b"]][ends[1]]


def chord_sense(mechanism: Mechanism, cable: CableLoop) -> int:
    """Return 1 if the axis of the body between a cable loop's joints runs from joint a to joint b, -1 if from b to a.

    The wheels' angles are then measured from the chord, the straight line between the joints. If that body is rigid and
    the loop does not pull on the bearings, return 0: the wheels' angles are then measured from the body itself.

    Raises:
        ValueError: if a chord is needed and the joints are not at two points of the body's axis.
    """
    joints = {joint.name: joint for joint in mechanism.joints}
    first, last = joints[cable.joint_a], joints[cable.joint_b]
    carrier = next(body for body in mechanism.bodies if body.name == first.outboard)
    if not isinstance(carrier, FlexibleBody | ModalPanel) and cable.wheel_radius is None:
        return 0
    along, across = (last.inboard_point[k] - first.outboard_point[k] for k in (0, 1))
    if abs(along) < 1e-9 or abs(across) > 1e-9 * abs(along):
        raise ValueError(
            f"CableLoop.joint_b = {cable.joint_b!r}: must attach to {carrier.name!r} at another point of its axis than "
            f"{cable.joint_a!r}, for a belt runs from one to the other"
        )
    return 1 if along > 0.0 else -1
