"""Compile a described mechanism into the arrays of ``model.py``."""

from __future__ import annotations

import itertools
import math

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.bodies.cable_element import MASS_BAND, element_blocks, factor_band, mass_band
from solar_env.mechanics.bodies.rigid import inverse_mass_parameters, mass_parameters
from solar_env.mechanics.bodies.stable_step import beam_stable_step
from solar_env.mechanics.mechanism.description import GROUND, Body, FlexibleBody, Joint, Mechanism, ModalPanel, Point
from solar_env.mechanics.numerics.profile import BLOCK, Elimination, make_elimination

_Row = dict[int, float]


def compile_mechanism(mechanism: Mechanism) -> tuple[m.Model, m.State]:
    """Return the constant model and the initial state of a mechanism.

    The state is taken as described: it must meet the constraints (checked by ``Simulation``).

    Raises:
        ValueError: if a part is attached to a flexible body elsewhere than at a node.
    """
    return _Compiler(mechanism).compile()


def _coordinates(body: Body | FlexibleBody) -> int:
    return 4 * (body.elements + 1) if isinstance(body, FlexibleBody) else 4


class _Compiler:
    def __init__(self, mechanism: Mechanism) -> None:
        self.mechanism = mechanism
        bodies = [body for body in mechanism.bodies if not isinstance(body, ModalPanel)]
        if len(bodies) < len(mechanism.bodies):
            raise ValueError("modal panels need the integrator of their own, ModalRadau")
        if self._needs_ground():
            bodies.append(Body("fixed frame", mass=1.0, inertia=1.0, length=1.0, centroid=(0.0, 0.0), fixed=True))
        self.described = bodies
        self.index = {body.name: k for k, body in enumerate(mechanism.bodies)}
        self.index[GROUND] = len(bodies) - 1
        ends = list(itertools.accumulate(_coordinates(body) for body in bodies))
        self.offsets = [0, *ends[:-1]]
        self.size = ends[-1]
        self.markers: list[tuple[float, ...]] = []
        self.marker_bodies: list[int] = []
        self.rows: list[tuple[_Row, float]] = []
        self.row_bodies: list[tuple[int, int]] = []
        self.bands: list[NDArray[np.float64]] = []

    def _needs_ground(self) -> bool:
        return any(GROUND in (joint.inboard, joint.outboard) for joint in self.mechanism.joints)

    def compile(self) -> tuple[m.Model, m.State]:
        bodies = self._bodies()
        joints = self._joints()
        for guide in self.mechanism.guides:
            marker = self._marker(guide.body, guide.point)
            row: _Row = {}
            for axis in (0, 1):
                self._add_position(row, marker, axis, guide.normal[axis])
            self._append_row(row, guide.offset, self.marker_bodies[marker])
        drives = self._drives()
        cables = self._cables(joints)
        constant_force = self._weight()
        load_torques = self._loads(constant_force)
        markers = np.zeros(len(self.markers), dtype=m.marker_type)
        for k, marker_values in enumerate(self.markers):
            markers[k] = marker_values
        band = np.concatenate([*self.bands, np.zeros((0, MASS_BAND))])
        compiled = m.Model(
            bodies=bodies,
            markers=markers,
            joints=joints,
            cables=cables,
            drives=drives,
            load_torques=load_torques,
            constant_force=constant_force,
            constraints=self._constraints(drives),
            elements=self._elements(),
            mass_band=band,
            mass_factor=np.concatenate([*(factor_band(part) for part in self.bands), np.zeros((0, MASS_BAND))]),
            elimination=self._elimination(joints, cables),
            error_weight=self._error_weight(),
            length_scale=float(max(body.length for body in self.described)),
            stable_step=min((self._stable_step(body) for body in self.described), default=math.inf),
        )
        return compiled, self._state()

    def _bodies(self) -> NDArray[np.void]:
        bodies = np.zeros(len(self.described), dtype=m.body_type)
        band_rows = 0
        for k, body in enumerate(self.described):
            record = bodies[k]
            record["offset"], record["coordinates"], record["length"] = self.offsets[k], _coordinates(body), body.length
            if isinstance(body, FlexibleBody):
                record["kind"] = m.FLEXIBLE
                record["element_length"] = body.length / body.elements
                for name in ("elements", "axial_stiffness", "bending_stiffness", "damping"):
                    record[name] = getattr(body, name)
                record["band"] = band_rows
                self.bands.append(mass_band(body.elements, body.length / body.elements, body.linear_density))
                band_rows += len(self.bands[-1])
                continue
            record["kind"] = m.FIXED if body.fixed else m.RIGID
            mass = mass_parameters(body.mass, body.inertia, body.length, body.centroid)
            record["m11"], record["m22"], record["m12"], record["n12"] = mass
            inverse = inverse_mass_parameters(*mass)
            record["w11"], record["w22"], record["w12"], record["x12"] = inverse
        return bodies

    def _elements(self) -> m.Elements:
        return element_blocks(
            [
                (
                    first,
                    body.elements,
                    body.length / body.elements,
                    body.axial_stiffness,
                    body.bending_stiffness,
                    body.damping,
                )
                for first, body in zip(self.offsets, self.described, strict=True)
                if isinstance(body, FlexibleBody)
            ]
        )

    @staticmethod
    def _stable_step(body: Body | FlexibleBody) -> float:
        if not isinstance(body, FlexibleBody):
            return math.inf
        return beam_stable_step(
            body.elements,
            body.length / body.elements,
            body.linear_density,
            body.axial_stiffness,
            body.bending_stiffness,
            body.damping,
        )

    def _marker(self, body_name: str, point: Point) -> int:
        """Add a marker at a point of a body's frame; returns its index."""
        k = self.index[body_name]
        body, first = self.described[k], self.offsets[k]
        if isinstance(body, FlexibleBody):
            node = first + 4 * body.node(point)
            self.markers.append((node, node + 2, 1.0, 0.0, 0.0, 0.0, 0.0))
        else:
            along, across = point[0] / body.length, point[1] / body.length
            self.markers.append((first, first + 2, 1.0 - along, -across, along, across, -1.0))
        self.marker_bodies.append(k)
        return len(self.markers) - 1

    def _add_position(self, row: _Row, marker: int, axis: int, weight: float) -> None:
        """Add to a row ``weight`` times the map from coordinates to the marker's x (axis 0) or y (axis 1)."""
        i, k, a1, b1, a2, b2, _ = self.markers[marker]
        turn = -1.0 if axis == 0 else 1.0
        for first, a, b in ((int(i), a1, b1), (int(k), a2, b2)):
            for index, value in ((first + axis, a), (first + 1 - axis, turn * b)):
                if value != 0.0:
                    row[index] = row.get(index, 0.0) + weight * value

    def _append_row(self, row: _Row, target: float, body: int, other: int = -1) -> int:
        self.rows.append((row, target))
        self.row_bodies.append((body, other))
        return len(self.rows) - 1

    def _constraints(self, drives: NDArray[np.void]) -> m.Constraints:
        count = len(self.rows)
        size = np.zeros(count, dtype=np.int64)
        index = np.zeros((count, m.ROW_ENTRIES), dtype=np.int64)
        value = np.zeros((count, m.ROW_ENTRIES))
        target = np.zeros(count)
        driven = np.zeros(count, dtype=np.int64)
        for r, (row, goal) in enumerate(self.rows):
            size[r], target[r] = len(row), goal
            index[r, : len(row)], value[r, : len(row)] = list(row.keys()), list(row.values())
        driven[drives["row"]] = 1
        bodies = np.array(self.row_bodies, dtype=np.int64).reshape(count, 2)
        return m.Constraints(size, index, value, target, bodies, driven)

    def _joints(self) -> NDArray[np.void]:
        joints = np.zeros(len(self.mechanism.joints), dtype=m.joint_type)
        for k, joint in enumerate(self.mechanism.joints):
            record = joints[k]
            inboard, outboard = (
                self._marker(joint.inboard, joint.inboard_point),
                self._marker(joint.outboard, joint.outboard_point),
            )
            record["inboard"], record["outboard"] = inboard, outboard
            self._fill_angle(record, joint)
            self._fill_torques(record, joint)
            if joint.bearing is None:
                record["kind"] = m.IDEAL
                record["row"] = len(self.rows)
                for axis in (0, 1):
                    row: _Row = {}
                    self._add_position(row, outboard, axis, 1.0)
                    self._add_position(row, inboard, axis, -1.0)
                    self._append_row(row, 0.0, self.marker_bodies[inboard], self.marker_bodies[outboard])
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

    def _error_weight(self) -> NDArray[np.float64]:
        """1 for positions; for a slope the length by which it moves the same inertia, from the mass matrix [m]."""
        weight = np.ones(self.size)
        for first, body in zip(self.offsets, self.described, strict=True):
            if isinstance(body, FlexibleBody):
                slope = math.sqrt(4.0 / 156.0) * body.length / body.elements
                for axis in (2, 3):
                    weight[first + axis : first + _coordinates(body) : 4] = slope
        return weight

    def _drives(self) -> NDArray[np.void]:
        drives = np.zeros(len(self.mechanism.drives), dtype=m.drive_type)
        for k, drive in enumerate(self.mechanism.drives):
            marker = self._marker(drive.body, drive.point)
            i1, i2 = (int(index) for index in self.markers[marker][:2])
            # Entries in the order in which they are set at run time.
            row = dict.fromkeys((i1, i1 + 1, i2, i2 + 1), 0.0)
            body = self.marker_bodies[marker]
            drives[k] = (self._append_row(row, 0.0, body), marker, drive.angle, drive.rate, drive.ramp_time)
        return drives

    def _cables(self, joints: NDArray[np.void]) -> NDArray[np.void]:
        cables = np.zeros(len(self.mechanism.cables), dtype=m.cable_type)
        names = {joint.name: k for k, joint in enumerate(self.mechanism.joints)}
        for k, cable in enumerate(self.mechanism.cables):
            cables[k] = (
                names[cable.joint_a],
                names[cable.joint_b],
                cable.wheel_ratio,
                cable.torque_ratio,
                cable.stiffness,
                cable.preload_torque,
            )
            joints["angle_limited"][[names[cable.joint_a], names[cable.joint_b]]] = 1
        return cables

    def _add_point_force(self, marker: int, fx: float, fy: float, force: NDArray[np.float64]) -> None:
        i, k, a1, b1, a2, b2, _ = self.markers[marker]
        for first, a, b in ((int(i), a1, b1), (int(k), a2, b2)):
            force[first] += a * fx + b * fy
            force[first + 1] += a * fy - b * fx

    def _weight(self) -> NDArray[np.float64]:
        force = np.zeros(self.size)
        gx, gy = self.mechanism.gravity
        for first, body in zip(self.offsets, self.described, strict=True):
            if isinstance(body, FlexibleBody):
                step = body.length / body.elements
                mass = body.linear_density * step
                for e in range(body.elements):
                    for k, share in enumerate((0.5, step / 12.0, 0.5, -step / 12.0)):
                        force[first + 4 * e + 2 * k] += mass * share * gx
                        force[first + 4 * e + 2 * k + 1] += mass * share * gy
            elif not body.fixed:
                along, across = body.centroid[0] / body.length, body.centroid[1] / body.length
                for k, a, b in ((first, 1.0 - along, -across), (first + 2, along, across)):
                    force[k] += body.mass * (a * gx + b * gy)
                    force[k + 1] += body.mass * (a * gy - b * gx)
        return force

    def _loads(self, force: NDArray[np.float64]) -> NDArray[np.void]:
        torques = []
        for load in self.mechanism.loads:
            marker = self._marker(load.body, load.point)
            self._add_point_force(marker, *load.force, force)
            if load.torque != 0.0:
                torques.append((marker, load.torque))
        return np.array(torques, dtype=m.load_torque_type)

    def _elimination(self, joints: NDArray[np.void], cables: NDArray[np.void]) -> Elimination:
        """Order along the bodies, node by node; a multiplier follows the last coordinate that it acts on."""
        n, rows = self.size, len(self.rows)
        position = np.full(n + rows + len(self.described), -1, dtype=np.int64)
        held = {
            i
            for first, body in zip(self.offsets, self.described, strict=True)
            if isinstance(body, Body) and body.fixed
            for i in range(first, first + 4)
        }
        waiting = [set(row) - held for row, _ in self.rows]
        couplings = [(n + r, i) for r, (row, _) in enumerate(self.rows) for i in row]
        place = 0
        for b, (first, body) in enumerate(zip(self.offsets, self.described, strict=True)):
            if first in held:
                continue
            for start in range(first, first + _coordinates(body), 4):
                node = range(start, start + 4)
                group = [*node] if isinstance(body, FlexibleBody) else [*node, n + rows + b]
                behind = node if start == first else range(start - 4, start + 4)
                couplings += itertools.product([*behind, *group], group)
                for r, coordinates in enumerate(waiting):
                    if coordinates:
                        coordinates.difference_update(node)
                        if not coordinates:
                            group.append(n + r)
                for unknown in group:
                    position[unknown] = place
                    place += 1
                # The next node begins a block of its own.
                place = -(-place // BLOCK) * BLOCK
        reach = [
            [
                int(i) + c
                for marker in (joint["inboard"], joint["outboard"])
                for i in self.markers[marker][:2]
                for c in (0, 1)
            ]
            for joint in joints
        ]
        cliques = [*reach, *(reach[cable["joint_a"]] + reach[cable["joint_b"]] for cable in cables)]
        for clique in cliques:
            couplings += itertools.combinations(clique, 2)
        return make_elimination(position, couplings)

    def _state(self) -> m.State:
        q, v = np.zeros(self.size), np.zeros(self.size)
        for first, body in zip(self.offsets, self.described, strict=True):
            c, s = math.cos(body.angle), math.sin(body.angle)
            points = np.linspace(0.0, body.length, body.elements + 1 if isinstance(body, FlexibleBody) else 2)
            positions = np.array(body.position) + np.outer(points, (c, s))
            velocities = np.array(body.velocity) + np.outer(points, (-s * body.spin, c * body.spin))
            end = first + _coordinates(body)
            step = 4 if isinstance(body, FlexibleBody) else 2
            for axis in (0, 1):
                q[first + axis : end : step] = positions[:, axis]
                v[first + axis : end : step] = velocities[:, axis]
            if isinstance(body, FlexibleBody):
                q[first + 2 : end : 4], q[first + 3 : end : 4] = c, s
                v[first + 2 : end : 4], v[first + 3 : end : 4] = -s * body.spin, c * body.spin
            elif body.fixed:
                v[first:end] = 0.0
        joints = len(self.mechanism.joints)
        joint_states = np.zeros(joints, dtype=m.joint_state_type)
        joint_states["latch_time"] = math.nan
        integrals = m.INTEGRALS_PER_JOINT * joints + m.GLOBAL_INTEGRALS
        bins = self.mechanism.wear_bins
        return m.State(
            q=q,
            v=v,
            a=np.zeros(self.size),
            algorithmic_a=np.zeros(self.size),
            multipliers=np.zeros(len(self.rows) + len(self.described)),
            integrals=np.zeros(integrals),
            power=np.zeros(integrals),
            joints=joint_states,
            wear_journal=np.zeros((joints, bins)),
            wear_bearing=np.zeros((joints, bins)),
            clock=np.zeros(1, dtype=m.clock_type),
        )
