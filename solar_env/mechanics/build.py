"""Compile a described mechanism into the arrays of ``model.py``."""

from __future__ import annotations

import math

import numpy as np

from . import model as m
from .description import GROUND, Body, Joint, Mechanism, Point
from .rigid import inverse_mass_parameters, mass_parameters


def compile_mechanism(mechanism: Mechanism) -> tuple[m.Model, m.State]:
    """Return the constant model and the initial state of a mechanism.

    The state is taken as described: it must meet the constraints (checked by ``Simulation``).
    """
    return _Compiler(mechanism).compile()


class _Compiler:
    def __init__(self, mechanism: Mechanism) -> None:
        self.mechanism = mechanism
        bodies = list(mechanism.bodies)
        if self._needs_ground():
            bodies.append(Body(name="fixed frame", mass=1.0, inertia=1.0, length=1.0, centroid=(0.0, 0.0), fixed=True))
        self.described = bodies
        self.index = {body.name: k for k, body in enumerate(bodies)}
        self.index[GROUND] = len(bodies) - 1
        self.size = 4 * len(bodies)
        self.markers: list[tuple[float, ...]] = []

    def _needs_ground(self) -> bool:
        return any(GROUND in (joint.inboard, joint.outboard) for joint in self.mechanism.joints)

    def compile(self) -> tuple[m.Model, m.State]:
        mechanism = self.mechanism
        bodies = self._bodies()
        rows: list[tuple[np.ndarray, float]] = []
        joints = self._joints(rows)
        for guide in mechanism.guides:
            marker = self._marker(guide.body, guide.point)
            nx, ny = guide.normal
            rows.append((nx * self._position_row(marker, 0) + ny * self._position_row(marker, 1), guide.offset))
        drives = np.zeros(len(mechanism.drives), dtype=m.drive_type)
        for k, drive in enumerate(mechanism.drives):
            drives[k] = (len(rows), self._marker(drive.body, (0.0, 0.0)), drive.angle, drive.rate)
            rows.append((np.zeros(self.size), 0.0))
        cables = np.zeros(len(mechanism.cables), dtype=m.cable_type)
        names = {joint.name: k for k, joint in enumerate(mechanism.joints)}
        for k, cable in enumerate(mechanism.cables):
            cables[k] = (
                names[cable.joint_a],
                names[cable.joint_b],
                cable.wheel_ratio,
                cable.torque_ratio,
                cable.stiffness,
                cable.preload_torque,
            )
            joints["angle_limited"][[names[cable.joint_a], names[cable.joint_b]]] = 1
        markers = np.zeros(len(self.markers), dtype=m.marker_type)
        for k, marker_values in enumerate(self.markers):
            markers[k] = marker_values
        compiled = m.Model(
            bodies=bodies,
            markers=markers,
            joints=joints,
            cables=cables,
            drives=drives,
            gravity_force=self._gravity_force(),
            constraint_matrix=np.array([row for row, _ in rows]).reshape(len(rows), self.size),
            constraint_value=np.array([value for _, value in rows], dtype=np.float64),
            length_scale=float(max(body.length for body in self.described)),
        )
        return compiled, self._state(len(rows))

    def _bodies(self) -> np.ndarray:
        bodies = np.zeros(len(self.described), dtype=m.body_type)
        for k, body in enumerate(self.described):
            mass = mass_parameters(body.mass, body.inertia, body.length, body.centroid)
            if body.fixed:
                mass = (1.0, 1.0, 0.0, 0.0)
            kind = m.FIXED if body.fixed else m.RIGID
            bodies[k] = (kind, 4 * k, body.length, *mass, *inverse_mass_parameters(*mass))
        return bodies

    def _marker(self, body_name: str, point: Point) -> int:
        """Add a marker at a point of a body's frame; returns its index."""
        k = self.index[body_name]
        length = self.described[k].length
        along, across = point[0] / length, point[1] / length
        self.markers.append((4 * k, 4 * k + 2, 1.0 - along, -across, along, across, -1.0))
        return len(self.markers) - 1

    def _position_row(self, marker: int, axis: int) -> np.ndarray:
        """Row of the linear map from coordinates to the marker's x (axis 0) or y (axis 1)."""
        i, k, a1, b1, a2, b2, _ = self.markers[marker]
        row = np.zeros(self.size)
        sign = -1.0 if axis == 0 else 1.0
        for first, a, b in ((int(i), a1, b1), (int(k), a2, b2)):
            row[first + axis] += a
            row[first + 1 - axis] += sign * b
        return row

    def _joints(self, rows: list[tuple[np.ndarray, float]]) -> np.ndarray:
        joints = np.zeros(len(self.mechanism.joints), dtype=m.joint_type)
        for k, joint in enumerate(self.mechanism.joints):
            record = joints[k]
            record["inboard"] = self._marker(joint.inboard, joint.inboard_point)
            record["outboard"] = self._marker(joint.outboard, joint.outboard_point)
            self._fill_angle(record, joint)
            self._fill_torques(record, joint)
            if joint.bearing is None:
                record["kind"] = m.IDEAL
                record["row"] = len(rows)
                for axis in (0, 1):
                    row = self._position_row(record["outboard"], axis) - self._position_row(record["inboard"], axis)
                    rows.append((row, 0.0))
            else:
                record["kind"] = m.CLEARANCE
                record["row"] = -1
                self._fill_bearing(record, joint)
        return joints

    @staticmethod
    def _fill_angle(record: np.void, joint: Joint) -> None:
        turn = joint.folded_angle + joint.sign * joint.middle
        record["sign"] = joint.sign
        record["middle"] = joint.middle
        record["turn_cos"] = math.cos(turn)
        record["turn_sin"] = math.sin(turn)

    @staticmethod
    def _fill_torques(record: np.void, joint: Joint) -> None:
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

    @staticmethod
    def _fill_bearing(record: np.void, joint: Joint) -> None:
        bearing = joint.bearing
        assert bearing is not None
        record["clearance"] = bearing.clearance
        record["journal_radius"] = bearing.journal_radius
        record["contact_stiffness"] = bearing.stiffness
        record["damping_factor"] = bearing.damping_factor
        record["minimum_impact_speed"] = bearing.minimum_impact_speed
        record["friction_coefficient"] = bearing.friction_coefficient
        record["friction_speed_zero"], record["friction_speed_full"] = bearing.friction_speeds
        record["sliding_speed"] = m.MATERIAL_POINTS if bearing.material_sliding else m.JOINT_CENTRES
        record["wear_coefficient"] = bearing.wear_coefficient
        record["bearing_width"] = bearing.width

    def _gravity_force(self) -> np.ndarray:
        force = np.zeros(self.size)
        gx, gy = self.mechanism.gravity
        for k, body in enumerate(self.described):
            if body.fixed:
                continue
            along, across = body.centroid[0] / body.length, body.centroid[1] / body.length
            for first, a, b in ((4 * k, 1.0 - along, -across), (4 * k + 2, along, across)):
                force[first] += body.mass * (a * gx + b * gy)
                force[first + 1] += body.mass * (a * gy - b * gx)
        return force

    def _state(self, row_count: int) -> m.State:
        q, v = np.zeros(self.size), np.zeros(self.size)
        for k, body in enumerate(self.described):
            c, s = math.cos(body.angle), math.sin(body.angle)
            q[4 * k : 4 * k + 2] = body.position
            q[4 * k + 2 : 4 * k + 4] = body.position[0] + body.length * c, body.position[1] + body.length * s
            turn = body.spin * body.length
            v[4 * k : 4 * k + 2] = body.velocity
            v[4 * k + 2 : 4 * k + 4] = body.velocity[0] - turn * s, body.velocity[1] + turn * c
            if body.fixed:
                v[4 * k : 4 * k + 4] = 0.0
        joints = len(self.mechanism.joints)
        joint_states = np.zeros(joints, dtype=m.joint_state_type)
        joint_states["latch_time"] = math.nan
        integrals = m.INTEGRALS_PER_JOINT * joints + 1
        bins = self.mechanism.wear_bins
        return m.State(
            q=q,
            v=v,
            a=np.zeros(self.size),
            algorithmic_a=np.zeros(self.size),
            multipliers=np.zeros(row_count + len(self.described)),
            integrals=np.zeros(integrals),
            power=np.zeros(integrals),
            joints=joint_states,
            wear_journal=np.zeros((joints, bins)),
            wear_bearing=np.zeros((joints, bins)),
            clock=np.zeros(1, dtype=m.clock_type),
        )
