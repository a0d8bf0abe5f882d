"""Compiler that turns mechanism descriptions into the arrays of `arrays/model.py`."""

import itertools
import math
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.bodies.cable_element.element import element_blocks
from solar_env.mechanics.bodies.kind import BodyKind
from solar_env.mechanics.bodies.kinds import KINDS, body_type, code_of
from solar_env.mechanics.bodies.markers import marker_type, pair_coordinates, place_row
from solar_env.mechanics.equations.joint_rows import fill_bearing, fill_cable, fill_joint
from solar_env.mechanics.mechanism.description import GROUND, AnyBody, Body, Mechanism, ModalPanel, Point
from solar_env.mechanics.numerics.profile import BLOCK, Elimination, make_elimination

_Row = dict[int, float]


def compile_mechanism(mechanism: Mechanism) -> tuple[m.Model, m.State]:
    """Compile a mechanism into its constant model and its initial state, which must satisfy the constraints.

    Raise a ValueError if a body is a `ModalPanel`, or if a part cannot be attached to its body or at its point.
    """
    return _Compiler(mechanism).compile()


class _Compiler:
    def __init__(self, mechanism: Mechanism) -> None:
        self.mechanism = mechanism
        for body in mechanism.bodies:
            if isinstance(body, ModalPanel):
                raise ValueError(
                    f"body {body.name!r} is a ModalPanel, which needs an integrator of its own: choose ModalRadau, or "
                    "describe the body as a FlexibleBody"
                )
        bodies: list[AnyBody] = list(mechanism.bodies)
        if self._needs_ground():
            bodies.append(Body("fixed frame", mass=1.0, inertia=1.0, length=1.0, centroid=(0.0, 0.0), fixed=True))
        self.described = bodies
        self.codes = [code_of(body) for body in bodies]
        self.kinds: list[BodyKind[Any]] = [KINDS[code] for code in self.codes]
        self.index = {body.name: k for k, body in enumerate(mechanism.bodies)}
        self.index[GROUND] = len(bodies) - 1
        self.sizes = [kind.coordinates(body) for kind, body in zip(self.kinds, bodies, strict=True)]
        self.offsets = [0, *itertools.accumulate(self.sizes)][:-1]
        self.size = sum(self.sizes)
        self.constants: list[float] = []
        self.markers: list[np.void] = []
        self.rows: list[tuple[_Row, float]] = []
        self.row_bodies: list[tuple[int, int]] = []

    def _needs_ground(self) -> bool:
        return any(GROUND in (joint.inboard, joint.outboard) for joint in self.mechanism.joints)

    def compile(self) -> tuple[m.Model, m.State]:
        bodies = self._bodies()
        joints = self._joints()
        drives = self._drives()
        cables = self._cables(joints)
        constant_force = self._weight()
        loads = self._loads(constant_force)
        compiled = m.Model(
            bodies=bodies,
            markers=np.array(self.markers, dtype=marker_type),
            joints=joints,
            cables=cables,
            drives=drives,
            loads=loads,
            constant_force=constant_force,
            constraints=self._constraints(drives),
            cable_elements=element_blocks(zip(self.offsets, self.described, strict=True)),
            body_constants=np.array(self.constants, dtype=np.float64),
            elimination=self._elimination(bodies, joints, cables),
            error_weight=np.concatenate([kind.error_weight(body) for kind, body in self._kinds_and_bodies()]),
            length_scale=float(bodies["length"].max()),
            stable_step=min(kind.stable_step(body) for kind, body in self._kinds_and_bodies()),
            flexible=int(any(kind.deformable for kind in self.kinds)),
        )
        return compiled, self._state()

    def _kinds_and_bodies(self) -> Iterator[tuple[BodyKind[Any], AnyBody]]:
        return zip(self.kinds, self.described, strict=True)

    def _bodies(self) -> NDArray[np.void]:
        bodies = np.zeros(len(self.described), dtype=body_type)
        for k, (kind, body) in enumerate(self._kinds_and_bodies()):
            row = bodies[k]
            row["kind"], row["offset"], row["coordinates"] = self.codes[k], self.offsets[k], self.sizes[k]
            kind.fill(body, row, self.constants)
            row["constraints"] = 0 if row["fixed"] else kind.constraints
        return bodies

    def _marker(self, body_name: str, point: Point) -> int:
        """Add a marker at a point of a body's frame [m]; return its index."""
        k = self.index[body_name]
        row = np.zeros(1, dtype=marker_type)[0]
        row["body"] = k
        self.kinds[k].fill_marker(self.described[k], row, self.offsets[k], point)
        self.markers.append(row)
        return len(self.markers) - 1

    def _add_place(self, row: _Row, marker: int, axis: int, weight: float) -> None:
        """Add `weight` times the coefficients of a marker's x (axis 0) or y (axis 1) to a constraint row."""
        for index, value in place_row(self.markers[marker], axis).items():
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
        names = [joint.name for joint in self.mechanism.joints]
        for k, joint in enumerate(self.mechanism.joints):
            record = joints[k]
            inboard = self._marker(joint.inboard, joint.inboard_point)
            outboard = self._marker(joint.outboard, joint.outboard_point)
            record["inboard"], record["outboard"] = inboard, outboard
            fill_joint(record, joint)
            record["released_by"] = -1 if joint.release_after is None else names.index(joint.release_after)
            if joint.bearing is None:
                record["kind"] = m.IDEAL
                record["row"] = len(self.rows)
                for axis in (0, 1):
                    row: _Row = {}
                    self._add_place(row, outboard, axis, 1.0)
                    self._add_place(row, inboard, axis, -1.0)
                    self._append_row(row, 0.0, self.markers[inboard]["body"], self.markers[outboard]["body"])
            else:
                record["kind"] = m.CLEARANCE
                record["row"] = -1
                fill_bearing(record, joint.bearing)
        return joints

    def _drives(self) -> NDArray[np.void]:
        drives = np.zeros(len(self.mechanism.drives), dtype=m.drive_type)
        for k, drive in enumerate(self.mechanism.drives):
            marker = self._marker(drive.body, drive.point)
            # The order of the entries is the order in which `constraints.set_drive_rows` sets them.
            row = dict.fromkeys(pair_coordinates(self.markers[marker]), 0.0)
            body = self.markers[marker]["body"]
            drives[k] = (self._append_row(row, 0.0, body), marker, drive.angle, drive.rate, drive.ramp_time)
        return drives

    def _cables(self, joints: NDArray[np.void]) -> NDArray[np.void]:
        cables = np.zeros(len(self.mechanism.cables), dtype=m.cable_type)
        names = {joint.name: k for k, joint in enumerate(self.mechanism.joints)}
        for k, cable in enumerate(self.mechanism.cables):
            fill_cable(cables[k], cable, self.mechanism, joints)
            joints["angle_limited"][[names[cable.joint_a], names[cable.joint_b]]] = 1
        return cables

    def _weight(self) -> NDArray[np.float64]:
        return np.concatenate([kind.weight(body, self.mechanism.gravity) for kind, body in self._kinds_and_bodies()])

    def _loads(self, force: NDArray[np.float64]) -> NDArray[np.void]:
        """Add loads' forces to the generalized `force` (n,); return records (marker, torque) of loads with torque."""
        rows = []
        for load in self.mechanism.loads:
            k = self._marker(load.body, load.point)
            constant = np.zeros(self.size)
            for axis in (0, 1):
                for index, value in place_row(self.markers[k], axis).items():
                    constant[index] += value * load.force[axis]
            force += constant
            if load.torque != 0.0:
                rows.append((k, load.torque))
        return np.array(rows, dtype=m.load_type)

    def _elimination(self, bodies: NDArray[np.void], joints: NDArray[np.void], cables: NDArray[np.void]) -> Elimination:
        """Return the order in which the unknowns of implicit steps are eliminated, and the profile of their matrix.

        The four coordinates of a beam's node or a rigid body come together, body by body. A constraint's multiplier
        follows the last coordinate on which the constraint acts. Coordinates of fixed bodies are left out.
        """
        n, rows = self.size, len(self.rows)
        position = np.full(n + rows + len(self.described), -1, dtype=np.int64)
        held = {body["offset"] + i for body in bodies if body["fixed"] for i in range(body["coordinates"])}
        waiting = [set(row) - held for row, _ in self.rows]
        couplings = [(n + r, i) for r, (row, _) in enumerate(self.rows) for i in row]
        place = 0
        for b, (first, size) in enumerate(zip(self.offsets, self.sizes, strict=True)):
            if first in held:
                continue
            for start in range(first, first + size, BLOCK):
                node = range(start, min(start + BLOCK, first + size))
                group = [*node, n + rows + b] if self.kinds[b].constraints else [*node]
                behind = range(max(first, start - BLOCK), node.stop)
                couplings += itertools.product([*behind, *group], group)
                for r, coordinates in enumerate(waiting):
                    if coordinates:
                        coordinates.difference_update(node)
                        if not coordinates:
                            group.append(n + r)
                for unknown in group:
                    position[unknown] = place
                    place += 1
                # The next node begins a new block.
                place = -(-place // BLOCK) * BLOCK
        reach = [
            [
                index
                for marker in (self.markers[joint["inboard"]], self.markers[joint["outboard"]])
                for index in pair_coordinates(marker)
            ]
            for joint in joints
        ]
        cliques = [*reach, *(reach[cable["joint_a"]] + reach[cable["joint_b"]] for cable in cables)]
        for clique in cliques:
            couplings += itertools.combinations(clique, 2)
        return make_elimination(position, couplings)

    def _state(self) -> m.State:
        motions = [kind.initial_motion(body) for kind, body in self._kinds_and_bodies()]
        joints = len(self.mechanism.joints)
        joint_states = np.zeros(joints, dtype=m.joint_state_type)
        joint_states["latch_time"] = math.nan
        integrals = m.INTEGRALS_PER_JOINT * joints + m.GLOBAL_INTEGRALS
        bins = self.mechanism.wear_bins
        return m.State(
            q=np.concatenate([q for q, _ in motions]),
            v=np.concatenate([v for _, v in motions]),
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
