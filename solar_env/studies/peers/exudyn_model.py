"""The array in Exudyn (J. Gerstmayr, Multibody Syst. Dyn. 60 (2024) 379, doi:10.1007/s11044-023-09937-1): the peer.

Everything on the way of a force is a compiled object of the library, chosen for its speed:

* rigid panels: bodies in the plane with three coordinates, springs and cable loop together as one linear stiffness
  matrix over their rotations;
* rigid panels with ideal joints, for explicit solvers: a kinematic tree, which has no constraints;
* flexible panels: cable elements in absolute nodal coordinates, Kelvin-Voigt damping as ours, and a massless body along
  the chord of the inner panel, against which the wheels of the cable loop turn;
* clearance: a sphere in a hollow sphere with exponent 1.5 and Hunt and Crossley's damping 3 (1 - e) / 2, in which the
  coefficient of restitution e is set so that the damping factor is ours;
* latches: the torque of the stop as a symbolic expression, which the library evaluates itself.
"""

import math

import exudyn
import numpy as np

from solar_env.studies.common.motion import Scene
from solar_env.studies.peers.exudyn_beams import FlexibleBuilder
from solar_env.studies.peers.exudyn_parts import Builder, PeerArray, items

_FOLDED = (-math.pi / 2, math.pi / 2)  # directions of the folded panels [rad]


def check_supported(scene: Scene) -> None:
    """Refuse what the peer's objects cannot express.

    Raises:
        ValueError: naming the parameter, or the panels.
    """
    p = scene.parameters
    for name, fits in (
        ("panel_count", p.panel_count == 2),
        ("friction_speed_zero", max(p.entries("friction_speed_zero")) == 0.0),
        ("friction_sliding", p.friction_sliding == "material"),
        ("cable_bearing_forces", not p.cable_bearing_forces),
        ("cable_torque_ratio", p.cable_torque_ratio in (None, 2.0)),
        ("body_fixed", not p.body_fixed),
        ("initial_spin", p.initial_spin == 0.0),
    ):
        if not fits:
            raise ValueError(f"{name} = {getattr(p, name)!r} cannot be built of the peer's objects")
    if scene.level.modal:
        raise ValueError(f"model = {scene.model!r} cannot be built of the peer's objects; take panels of elements")


def build_peer(scene: Scene, implicit: bool) -> PeerArray:
    """Assemble the array of a scene for an implicit solver, or for an explicit one, which takes no constraints.

    Raises:
        ValueError: if the scene has what the peer's objects cannot express.
    """
    check_supported(scene)
    container = exudyn.SystemContainer()
    array = PeerArray(scene, container, container.AddSystem())
    tree = scene.model == "rigid-ideal" and not implicit
    builder = TreeBuilder if tree else FlexibleBuilder if scene.level.flexible else RigidBuilder
    builder(array).build()
    return array


class RigidBuilder(Builder):
    """Rigid bodies of three coordinates each."""

    def build(self) -> None:
        """Add everything to the system and assemble it."""
        p, system = self.p, self.system
        node, body = self.base()
        nodes, bodies = [node], [body]
        y = p.hinge_y - p.panel_length / 2
        for angle, (speed, spin) in zip(_FOLDED, self.release(), strict=True):  # the second lies folded back
            speed -= spin * p.panel_length / 2 * math.sin(angle)
            node = items.NodeRigidBody2D(
                referenceCoordinates=[p.hinge_x, y, angle], initialVelocities=[speed, 0.0, spin]
            )
            nodes.append(system.AddNode(node))
            panel = items.ObjectRigidBody2D(mass=self.mass, inertia=self.inertia, nodeNumber=nodes[-1])
            bodies.append(system.AddObject(panel))
        half = p.panel_length / 2
        self.joints(
            [
                (self.point(bodies[0], p.hinge_x, p.hinge_y), self.point(bodies[1], -half)),
                (self.point(bodies[1], half), self.point(bodies[2], -half)),
            ]
        )
        to_angles = np.zeros((2, 9))
        to_angles[0, [2, 5]] = -1.0, 1.0
        to_angles[1, [5, 8]] = 1.0, -1.0
        self.torque_matrix(to_angles, nodes)
        self.watch(nodes)
        turns = [system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=node, coordinate=2)) for node in nodes]
        places: list[int] = []

        def angles() -> tuple[float, float]:
            if not places:
                places.extend(system.systemData.GetNodeLTGODE2(node)[2] for node in nodes)
            q = system.systemData.GetODE2Coordinates()
            base, first, second = (q[place] for place in places)
            return first - base, first - second

        self.latches([(turns[0], turns[1]), (turns[1], turns[2])], angles)


class TreeBuilder(Builder):
    """A kinematic tree of the main body's three coordinates and two joint angles."""

    def build(self) -> None:
        """Add everything to the system and assemble it."""
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
        # Two massless carriages and the main body's turn, then the panels, whose frames start folded.
        turns = [np.eye(3) for _ in range(3)]
        for angle in (_FOLDED[0], math.pi):
            c, s = round(math.cos(angle)), round(math.sin(angle))
            turns.append(np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]))
        zero, half = [0.0, 0.0, 0.0], [p.panel_length / 2, 0.0, 0.0]
        offsets = [zero, zero, zero, [p.hinge_x, p.hinge_y, 0.0], [p.panel_length, 0.0, 0.0]]
        centres = [zero, zero, zero, half, half]

        inertias = [np.zeros((3, 3))] * 2 + [
            np.diag([0.0, 0.0, value]) for value in (p.body_inertia, *[self.inertia] * 2)
        ]
        system.AddObject(
            items.ObjectKinematicTree(
                nodeNumber=node,
                jointTypes=[joint.PrismaticX, joint.PrismaticY, joint.RevoluteZ, joint.RevoluteZ, joint.RevoluteZ],
                linkParents=[-1, 0, 1, 2, 3],
                jointTransformations=exudyn.Matrix3DList(turns),
                jointOffsets=exudyn.Vector3DList(offsets),
                linkInertiasCOM=exudyn.Matrix3DList(inertias),
                linkCOMs=exudyn.Vector3DList(centres),
                linkMasses=[0.0, 0.0, p.body_mass, self.mass, self.mass],
            )
        )
        to_angles = np.zeros((2, 5))
        to_angles[0, 3], to_angles[1, 4] = 1.0, -1.0
        self.torque_matrix(to_angles, [node])
        self.watch([node])
        turned = [system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=node, coordinate=k)) for k in (3, 4)]

        def angles() -> tuple[float, float]:
            q = system.systemData.GetODE2Coordinates()
            return q[3], -q[4]

        self.latches([(self.ground, turned[0]), (self.ground, turned[1])], angles)
