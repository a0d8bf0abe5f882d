"""Parts that the rigid and the flexible array in Exudyn share."""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import exudyn
import exudyn.itemInterface
import numpy as np
from exudyn.utilities import CreateSymbolicUserFunction

from solar_env.array import ArrayParameters
from solar_env.mechanics.mechanism.description import Stop
from solar_env.studies.common.motion import Scene

items = exudyn.itemInterface
_SENSES = (1.0, -1.0)  # of the two joint angles as differences of the bodies' rotations


@dataclass
class PeerArray:
    """An assembled array.

    Attributes:
        scene: what it is the array of.
        container: owner of the system, which must outlive it.
        system: to be solved.
        rotations: (coordinates, velocities) sensors of the nodes that the joint angles follow from.
        contacts: sensors of the joints' contact forces, empty without clearance or if not asked for.
        latch_times: of the joints [s], nan while open; filled while the system is solved.
        kept_alive: Python functions that the library calls.
    """

    scene: Scene
    container: Any
    system: Any
    rotations: list[tuple[Any, Any]] = field(default_factory=list)
    contacts: list[Any] = field(default_factory=list)
    latch_times: list[float] = field(default_factory=lambda: [math.nan, math.nan])
    kept_alive: list[Any] = field(default_factory=list)


class Builder(ABC):
    """Steps that all three builds share."""

    def __init__(self, array: PeerArray) -> None:
        self.array, self.system = array, array.system
        self.p: ArrayParameters = array.scene.parameters
        self.mass = self.p.panel_density * self.p.panel_length * self.p.panel_width * self.p.panel_thickness
        self.inertia = self.mass * (self.p.panel_length**2 + self.p.panel_thickness**2) / 12.0
        ground = self.system.AddNode(items.NodePointGround(referenceCoordinates=[0, 0, 0]))
        self.ground = self.system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=ground, coordinate=0))

    @abstractmethod
    def build(self) -> None:
        """Add everything to the system and assemble it."""

    def release(self) -> list[tuple[float, float]]:
        """Speed along x of the inner end [m/s] and spin [rad/s] of each folded panel at t = 0."""
        rates = [self.p.by_joint("initial_rate", j) for j in (0, 1)]
        return [(0.0, rates[0]), (self.p.panel_length * rates[0], rates[0] - rates[1])]

    def base(self) -> tuple[int, int]:
        """Node and body of the main body."""
        node = self.system.AddNode(items.NodeRigidBody2D(referenceCoordinates=[0, 0, 0]))
        body = items.ObjectRigidBody2D(mass=self.p.body_mass, inertia=self.p.body_inertia, nodeNumber=node)
        return node, self.system.AddObject(body)

    def point(self, body: int, x: float, y: float = 0.0) -> int:
        """Marker of a body's point (x, y) in its own frame [m]."""
        return int(self.system.AddMarker(items.MarkerBodyRigid(bodyNumber=body, localPosition=[x, y, 0.0])))

    def torque_matrix(self, to_angles: Any, nodes: list[int]) -> None:
        """Springs and cable loop: angles = to_angles @ coordinates, (2, n)."""
        p = self.p
        springs = [p.by_joint("spring_stiffness", j) for j in (0, 1)]
        relaxed = [p.by_joint("spring_preload_angle", j) for j in (0, 1)]
        rows = np.vstack([to_angles, 2.0 * to_angles[0] - to_angles[1]])
        stiffness = rows.T @ np.diag([*springs, p.by_joint("cable_stiffness", 0)]) @ rows
        self.system.AddObject(
            items.ObjectGenericODE2(
                nodeNumbers=nodes,
                massMatrix=np.zeros_like(stiffness),
                stiffnessMatrix=stiffness,
                forceVector=to_angles.T @ np.multiply(springs, relaxed),
            )
        )

    def joints(self, markers: list[tuple[int, int]]) -> None:
        """Join (bearing, journal) markers, with clearance or without."""
        p, system = self.p, self.system
        for j, (bearing, journal) in enumerate(markers):
            if not self.array.scene.level.clearance:
                system.AddObject(items.ObjectJointRevolute2D(markerNumbers=[bearing, journal]))
                continue
            data = system.AddNode(
                items.NodeGenericData(
                    initialCoordinates=[p.by_joint("clearance", j), 0, 0, 0], numberOfDataCoordinates=4
                )
            )
            contact = system.AddObject(
                items.ObjectContactSphereSphere(
                    markerNumbers=[journal, bearing],
                    nodeNumber=data,
                    spheresRadii=[p.journal_radius, p.journal_radius + p.by_joint("clearance", j)],
                    isHollowSphere1=True,
                    dynamicFriction=p.by_joint("friction_coefficient", j),
                    frictionProportionalZone=p.by_joint("friction_speed_full", j),
                    contactStiffness=p.contact(j).stiffness,
                    contactStiffnessExponent=p.contact(j).exponent,
                    impactModel=1,
                    restitutionCoefficient=1.0 - 2.0 / 3.0 * p.contact(j).damping,
                    minimumImpactVelocity=p.by_joint("minimum_impact_speed", j),
                )
            )
            if self.array.scene.forces_kept:
                sensor = self.sensor(items.SensorObject, contact, exudyn.OutputVariableType.Force)
                self.array.contacts.append(sensor)

    def sensor(self, kind: Any, number: int, what: Any) -> Any:
        """A sensor of a node or an object that keeps its data in memory."""
        owner = "objectNumber" if kind is items.SensorObject else "nodeNumber"
        return self.system.AddSensor(kind(**{owner: number}, storeInternal=True, outputVariableType=what))

    def watch(self, nodes: list[int]) -> None:
        """Keep coordinates and velocities of nodes."""
        kinds = exudyn.OutputVariableType.Coordinates, exudyn.OutputVariableType.Coordinates_t
        self.array.rotations = [tuple(self.sensor(items.SensorNode, node, kind) for kind in kinds) for node in nodes]

    def latches(self, coordinates: list[tuple[int, int]], angles: Callable[[], tuple[float, float]]) -> None:
        """Stops on (marker, marker) coordinates, engaged at the first step beyond the lock angle; ends the build."""
        system, array = self.system, self.array
        objects = []
        for j, pair in enumerate(coordinates):
            latch = system.AddObject(
                items.ObjectConnectorCoordinateSpringDamper(
                    markerNumbers=list(pair), stiffness=self.p.stop(j).stiffness, damping=0.0, activeConnector=False
                )
            )
            torque = _stop_expression(self.p.stop(j), _SENSES[j] * self.p.joints[j].lock_angle)
            symbolic = CreateSymbolicUserFunction(system, torque, "springForceUserFunction", latch)
            system.SetObjectParameter(latch, "springForceUserFunction", symbolic)
            array.kept_alive += [torque, symbolic]
            objects.append(latch)
        system.Assemble()
        before = [0.0, 0.0, 0.0]  # time and angles at the start of the previous step
        called = [0.0, 0.0]  # the last two different times of calls

        def engage(mbs: Any, time: float) -> bool:
            if math.isnan(array.latch_times[0] + array.latch_times[1]):
                # Called with the time that the step is to reach; again if the step is repeated with half its size.
                called[:] = [called[1] if time > called[1] else called[0], time]
                start, now = called[0], angles()
                for j, angle in enumerate(now):
                    lock = self.p.joints[j].lock_angle
                    if math.isnan(array.latch_times[j]) and angle >= lock:
                        share = (lock - before[1 + j]) / (angle - before[1 + j])
                        array.latch_times[j] = before[0] + share * (start - before[0])
                        mbs.SetObjectParameter(objects[j], "activeConnector", True)
                before[:] = [start, *now]
            return True

        array.kept_alive.append(engage)
        system.SetPreStepUserFunction(engage)


def _stop_expression(stop: Stop, lock: float) -> Callable[..., Any]:
    """Torque of a two-sided stop round a locked coordinate, on the left-hand side of the equations."""
    symbolic = exudyn.symbolic

    def one_side(depth: Any, closing_rate: Any) -> Any:
        share = symbolic.min(symbolic.max(depth / stop.ramp_depth, 0.0), 1.0)
        damping = stop.damping * share * share * (3.0 - 2.0 * share)
        elastic = stop.stiffness * symbolic.pow(symbolic.max(depth, 0.0), stop.exponent)
        return symbolic.max(elastic + damping * closing_rate, 0.0)

    def torque(
        mbs: Any, t: Any, itemNumber: Any, displacement: Any, velocity: Any, stiffness: Any, damping: Any, offset: Any
    ) -> Any:
        below, above = lock - stop.gap - displacement, displacement - lock - stop.gap
        return symbolic.IfThenElse(
            below > 0.0,
            -one_side(below, -1.0 * velocity),
            symbolic.IfThenElse(above > 0.0, one_side(above, velocity), 0.0 * velocity),
        )

    return torque
