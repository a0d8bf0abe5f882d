"""Models of the array in Exudyn (J. Gerstmayr, Multibody Syst. Dyn. 60 (2024) 379, doi:10.1007/s11044-023-09937-1).

All parts that exert a force are compiled objects of Exudyn, chosen for their speed:

* rigid panels: planar bodies with three coordinates each, and one stiffness matrix of springs and cable loop;
* rigid panels with ideal joints, for explicit solvers: a kinematic tree, which has no constraints;
* flexible panels: cable elements in absolute nodal coordinates with our Kelvin-Voigt damping, and a massless body along
  the chord of the inner panel, against which the wheels of the cable loop turn;
* clearance: a sphere in a hollow sphere with exponent 1.5 and Hunt and Crossley's damping 3 (1 - e) / 2, in which the
  coefficient of restitution e is set so that the damping factor equals ours;
* latches: the stop's torque as a symbolic expression, which Exudyn evaluates itself.
"""

import itertools
import math
from typing import Any

import exudyn
import numpy as np

from solar_env.studies.common.motion import Scene
from solar_env.studies.peers.exudyn_parts import PeerArray, Value, items

_FOLDED = (-math.pi / 2, math.pi / 2)  # directions of the folded panels [rad]
# By joint: folded rotation of the outboard relative to the inboard body [rad], and sign of the joint angle.
_ROTATIONS = ((-math.pi / 2, 1.0), (math.pi, -1.0))


def build_peer(scene: Scene, implicit: bool) -> PeerArray:
    """Return the Exudyn model of a deployment's array; `implicit` allows constraints, which explicit solvers refuse."""
    p = scene.parameters
    if p.panel_count != 2 or max(p.entries("friction_speed_zero")) > 0.0:
        raise ValueError("the peer's objects express two panels, and friction that sets in at rest")
    if scene.level.modal:
        raise ValueError(f"model = {scene.model!r} cannot be built of the peer's objects; take panels of elements")
    if scene.level.flexible:
        return BeamArray(scene)
    return RigidArray(scene) if implicit or scene.level.clearance else TreeArray(scene)


class RigidArray(PeerArray):
    """Exudyn model of the array with rigid bodies of three planar coordinates each."""

    def build(self) -> list[tuple[int, int]]:
        """Add all parts but the latches to the system; return each joint's two coordinate markers for its latch."""
        p, system = self.p, self.system
        node, body = self.base()
        nodes, bodies = [node], [body]
        y = p.hinge_y - self.panel.length / 2
        for angle, (speed, spin) in zip(_FOLDED, self.release(), strict=True):  # the second panel lies folded back
            speed -= spin * self.panel.length / 2 * math.sin(angle)
            node = items.NodeRigidBody2D(
                referenceCoordinates=[p.hinge_x, y, angle], initialVelocities=[speed, 0.0, spin]
            )
            nodes.append(system.AddNode(node))
            panel = items.ObjectRigidBody2D(mass=self.panel.mass, inertia=self.panel.inertia, nodeNumber=nodes[-1])
            bodies.append(system.AddObject(panel))
        half = self.panel.length / 2
        first = self.point(bodies[0], p.hinge_x, p.hinge_y), self.point(bodies[1], -half)
        self.joints([first, (self.point(bodies[1], half), self.point(bodies[2], -half))])
        to_angles = np.zeros((2, 9))
        to_angles[0, [2, 5]] = -1.0, 1.0
        to_angles[1, [5, 8]] = 1.0, -1.0
        self.torque_matrix(to_angles, nodes)
        self.watch(*((node, 2, 0.0) for node in nodes))
        turns = [system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=node, coordinate=2)) for node in nodes]
        return list(itertools.pairwise(turns))

    def angles(self, *values: Value) -> tuple[Value, Value]:
        """Return the two joint angles [rad]; `values`: rotations [rad] of main body, panel 1 and panel 2."""
        base, first, second = values
        return first - base, first - second


class TreeArray(PeerArray):
    """Exudyn model of the array as a kinematic tree: three coordinates of the main body, and one for each hinge."""

    def build(self) -> list[tuple[int, int]]:
        """Add all parts but the latches to the system; return each joint's two coordinate markers for its latch."""
        p, system = self.p, self.system
        joint = exudyn.JointType
        node = system.AddNode(
            items.NodeGenericODE2(
                referenceCoordinates=[0.0] * 5,
                initialCoordinates=[0.0] * 5,
                initialCoordinates_t=[0.0, 0.0, 0.0, p.by_joint("initial_rate", 0), -p.by_joint("initial_rate", 1)],
                numberOfODE2Coordinates=5,
            )
        )
        # The tree chains two massless slides, the main body's rotation, and the panels, whose frames start folded.
        turns = [np.eye(3) for _ in range(3)]
        for angle in (_FOLDED[0], math.pi):
            c, s = round(math.cos(angle)), round(math.sin(angle))
            turns.append(np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]))
        zero, half = [0.0, 0.0, 0.0], [self.panel.length / 2, 0.0, 0.0]
        offsets = [zero, zero, zero, [p.hinge_x, p.hinge_y, 0.0], [self.panel.length, 0.0, 0.0]]
        about = (0.0, 0.0, p.body_inertia, self.panel.inertia, self.panel.inertia)
        inertias = [np.diag([0.0, 0.0, inertia]) for inertia in about]
        system.AddObject(
            items.ObjectKinematicTree(
                nodeNumber=node,
                jointTypes=[joint.PrismaticX, joint.PrismaticY, joint.RevoluteZ, joint.RevoluteZ, joint.RevoluteZ],
                linkParents=[-1, 0, 1, 2, 3],
                jointTransformations=exudyn.Matrix3DList(turns),
                jointOffsets=exudyn.Vector3DList(offsets),
                linkInertiasCOM=exudyn.Matrix3DList(inertias),
                linkCOMs=exudyn.Vector3DList([zero, zero, zero, half, half]),
                linkMasses=[0.0, 0.0, p.body_mass, self.panel.mass, self.panel.mass],
            )
        )
        to_angles = np.zeros((2, 5))
        to_angles[0, 3], to_angles[1, 4] = 1.0, -1.0
        self.torque_matrix(to_angles, [node])
        self.watch((node, 3, 0.0), (node, 4, 0.0))
        turned = [system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=node, coordinate=k)) for k in (3, 4)]
        return [(self.ground, marker) for marker in turned]

    def angles(self, *values: Value) -> tuple[Value, Value]:
        """Return the two joint angles [rad]; `values` are hinge rotations [rad], the second with opposite sign."""
        return values[0], -values[1]


class BeamArray(PeerArray):
    """Exudyn model of the array with panels of cable elements in absolute nodal coordinates (ANCF)."""

    def build(self) -> list[tuple[int, int]]:
        """Add all parts but the latches to the system; return each joint's two coordinate markers for its latch."""
        p, system, elements = self.p, self.system, self.scene.level.count
        base, body = self.base()
        length = self.panel.length / elements
        axial, bending, damping = self.panel.axial_stiffness, self.panel.bending_stiffness, self.panel.damping
        panels, cables = [], []
        senses = ((p.hinge_y, -1.0), (p.hinge_y - self.panel.length, 1.0))
        for (start, sense), (speed, spin) in zip(senses, self.release(), strict=True):
            nodes = [
                system.AddNode(
                    items.NodePoint2DSlope1(
                        referenceCoordinates=[p.hinge_x, start + sense * k * length, 0.0, sense],
                        initialVelocities=[speed - spin * sense * k * length, 0.0, -spin * sense, 0.0],
                    )
                )
                for k in range(elements + 1)
            ]
            panels.append(nodes)
            cables.append(
                [
                    system.AddObject(
                        items.ObjectANCFCable2D(
                            length=length,
                            massPerLength=self.panel.linear_density,
                            bendingStiffness=bending,
                            axialStiffness=axial,
                            bendingDamping=damping * bending,
                            axialDamping=damping * axial,
                            nodeNumbers=list(pair),
                        )
                    )
                    for pair in itertools.pairwise(nodes)
                ]
            )
        # Bearing and journal of each joint, each as (body, x, y).
        ends = [
            ((body, p.hinge_x, p.hinge_y), (cables[0][0], 0.0, 0.0)),
            ((cables[0][-1], length, 0.0), (cables[1][0], 0.0, 0.0)),
        ]
        markers = [(self.point(*bearing), self.point(*journal)) for bearing, journal in ends]
        self.joints(markers)
        rotations = self._torques(ends, markers)
        slopes = (panels[0][0], -1.0), (panels[0][-1], -1.0), (panels[1][0], 1.0)
        self.watch((base, 2, 0.0), *((node, 2 + k, k * along) for node, along in slopes for k in (0, 1)))
        return [(self.ground, marker) for marker in rotations]

    def angles(self, *values: Value) -> tuple[Value, Value]:
        """Return the two joint angles [rad].

        `values`: main body's rotation [rad], and slope vectors (x, y) at root and tip of panel 1 and root of panel 2.
        """
        turn, root_x, root_y, tip_x, tip_y, outer_x, outer_y = values
        first = np.arctan2(root_x, -root_y) - turn
        second = math.pi - np.arctan2(tip_x * outer_y - tip_y * outer_x, tip_x * outer_x + tip_y * outer_y)
        return first, np.where(second > 1.75 * math.pi, second - 2.0 * math.pi, second)

    def _torques(self, ends: Any, markers: list[tuple[int, int]]) -> list[int]:
        """Add hinge springs and cable loop; return the numbers of markers that measure the joints' relative rotations.

        `ends` has two points (body, x, y) for each joint, on bearing and journal; `markers` has their markers' numbers.
        """
        p, system = self.p, self.system
        rotations = []
        for j, (folded, sense) in enumerate(_ROTATIONS):
            data = system.AddNode(items.NodeGenericData(initialCoordinates=[folded], numberOfDataCoordinates=1))
            system.AddObject(
                items.ObjectConnectorTorsionalSpringDamper(
                    markerNumbers=list(markers[j]),
                    nodeNumber=data,
                    stiffness=p.by_joint("spring_stiffness", j),
                    offset=folded + sense * p.by_joint("spring_preload_angle", j),
                )
            )
            inner, outer = ends[j]
            rotations.append(self._rotation(inner, outer, folded))
        belt = self._belt(ends), 0.0, 0.0
        wheels = [
            self._rotation(ends[0][0], belt, _ROTATIONS[0][0]),
            self._rotation(belt, ends[1][1], _ROTATIONS[1][0]),
        ]
        system.AddObject(
            items.ObjectConnectorCoordinateSpringDamperExt(
                markerNumbers=wheels, stiffness=p.by_joint("cable_stiffness", 0), factor0=-2.0, factor1=1.0
            )
        )
        return rotations

    def _rotation(self, inner: Any, outer: Any, folded: float) -> int:
        """Add a marker of the relative rotation at points (body, x, y), zero at `folded` [rad]; return its number."""
        data = items.NodeGenericData(initialCoordinates=[0.0], numberOfDataCoordinates=1)
        marker = items.MarkerBodiesRelativeRotationCoordinate(
            bodyNumbers=[inner[0], outer[0]],
            nodeNumber=self.system.AddNode(data),
            localPosition0=[inner[1], inner[2], 0.0],
            localPosition1=[outer[1], outer[2], 0.0],
            axis0=[0, 0, 1],
            offset=folded,
        )
        return int(self.system.AddMarker(marker))

    def _belt(self, ends: Any) -> int:
        """Add a massless body along panel 1's chord, against which the cable loop's wheels turn; return its number.

        It is pinned to the panel's root, the journal of joint 1, and slides at the tip, the bearing of joint 2. `ends`
        has bearing and journal of each joint, each as a point (body number, x, y) in the body's frame [m].
        """
        p, system = self.p, self.system
        speed, spin = self.release()[0]
        node = items.NodeRigidBody2D(
            referenceCoordinates=[p.hinge_x, p.hinge_y, -math.pi / 2], initialVelocities=[speed, 0.0, spin]
        )
        belt = system.AddObject(items.ObjectRigidBody2D(mass=0.0, inertia=0.0, nodeNumber=system.AddNode(node)))
        root, tip = self.point(*ends[0][1]), self.point(*ends[1][0])
        system.AddObject(items.ObjectJointRevolute2D(markerNumbers=[root, self.point(belt, 0.0)]))
        system.AddObject(
            items.ObjectJointPrismatic2D(
                markerNumbers=[tip, self.point(belt, 0.0)],
                axisMarker0=[1.0, 0.0, 0.0],
                normalMarker1=[0.0, 1.0, 0.0],
                constrainRotation=False,
            )
        )
        return int(belt)
