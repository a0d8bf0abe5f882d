"""The array with flexible panels in Exudyn."""

import itertools
import math
from typing import Any

import numpy as np

from solar_env.studies.peers.exudyn_parts import Builder, items

# Of each joint: rotation of the outboard relative to the inboard side when folded [rad], sense of the joint angle.
FOLDED = ((-math.pi / 2, 1.0), (math.pi, -1.0))


def joint_angles(turn: Any, root: Any, tip: Any, outer: Any) -> tuple[Any, Any]:
    """Joint angles of flexible panels [rad] from the main body's turn and three slope vectors (x, y)."""
    first = np.arctan2(root[0], -root[1]) - turn
    between = np.arctan2(tip[0] * outer[1] - tip[1] * outer[0], tip[0] * outer[0] + tip[1] * outer[1])
    second = math.pi - between
    return first, np.where(second > 1.75 * math.pi, second - 2.0 * math.pi, second)


class FlexibleBuilder(Builder):
    """Cable elements in absolute nodal coordinates."""

    def build(self) -> None:
        """Add everything to the system and assemble it."""
        p, system, elements = self.p, self.system, self.array.scene.level.count
        base, body = self.base()
        length = p.panel_length / elements
        section = p.panel_width * p.panel_thickness
        bending = p.panel_young * section * p.panel_thickness**2 / 12.0
        panels, cables = [], []
        senses = ((p.hinge_y, -1.0), (p.hinge_y - p.panel_length, 1.0))
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
                            massPerLength=p.panel_density * section,
                            bendingStiffness=bending,
                            axialStiffness=p.panel_young * section,
                            bendingDamping=p.panel_damping * bending,
                            axialDamping=p.panel_damping * p.panel_young * section,
                            nodeNumbers=list(pair),
                        )
                    )
                    for pair in itertools.pairwise(nodes)
                ]
            )
        # (body, x, y) of bearing and journal of each joint.
        ends = [
            ((body, p.hinge_x, p.hinge_y), (cables[0][0], 0.0, 0.0)),
            ((cables[0][-1], length, 0.0), (cables[1][0], 0.0, 0.0)),
        ]
        markers = [(self.point(*bearing), self.point(*journal)) for bearing, journal in ends]
        self.joints(markers)
        coordinates = self._torques(ends, markers)
        self.watch([base, panels[0][0], panels[0][-1], panels[1][0]])
        slopes = [panels[0][0], panels[0][-1], panels[1][0]]
        places: list[list[int]] = []

        def angles() -> tuple[float, float]:
            data = system.systemData
            if not places:
                places.append([data.GetNodeLTGODE2(base)[2]])
                places.extend(list(data.GetNodeLTGODE2(node)[2:4]) for node in slopes)
            q = data.GetODE2Coordinates()
            turn = q[places[0][0]]
            root, tip, outer = (
                (q[x], q[y] + start) for (x, y), start in zip(places[1:], (-1.0, -1.0, 1.0), strict=True)
            )
            return joint_angles(turn, root, tip, outer)

        self.latches([(self.ground, marker) for marker in coordinates], angles)

    def _torques(self, ends: Any, markers: list[tuple[int, int]]) -> list[int]:
        """Springs between the slopes, and the cable loop; returns markers of the relative rotations."""
        p, system = self.p, self.system
        rotations = []
        for j, (folded, sense) in enumerate(FOLDED):
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
        belt = self._belt(ends)
        wheels = [
            self._rotation(ends[0][0], (belt, 0.0, 0.0), FOLDED[0][0]),
            self._rotation((belt, 0.0, 0.0), ends[1][1], FOLDED[1][0]),
        ]
        system.AddObject(
            items.ObjectConnectorCoordinateSpringDamperExt(
                markerNumbers=wheels, stiffness=p.by_joint("cable_stiffness", 0), factor0=-2.0, factor1=1.0
            )
        )
        return rotations

    def _rotation(self, inner: Any, outer: Any, folded: float) -> int:
        """Marker of the rotation of one (body, x, y) relative to another, from where it is folded."""
        system = self.system
        data = system.AddNode(items.NodeGenericData(initialCoordinates=[0.0], numberOfDataCoordinates=1))
        marker = items.MarkerBodiesRelativeRotationCoordinate(
            bodyNumbers=[inner[0], outer[0]],
            nodeNumber=data,
            localPosition0=[inner[1], inner[2], 0.0],
            localPosition1=[outer[1], outer[2], 0.0],
            axis0=[0, 0, 1],
            offset=folded,
        )
        return int(system.AddMarker(marker))

    def _belt(self, ends: Any) -> int:
        """A massless body along the chord of the inner panel: pinned to its one end, sliding on its other."""
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
