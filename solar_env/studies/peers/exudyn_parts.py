"""Parts that all arrays in Exudyn share: main body, joints, torques, latches and sensors."""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Any

import exudyn
import exudyn.itemInterface
import numpy as np
from exudyn.utilities import CreateSymbolicUserFunction

from solar_env.mechanics.mechanism import Stop
from solar_env.studies.common.motion import Scene

items = exudyn.itemInterface
_SENSES = (1.0, -1.0)  # signs that turn the rotation differences of neighbouring bodies into the two joint angles

Value = Any  # a number, or a symbolic expression that Exudyn evaluates


class PeerArray(ABC):
    """An array assembled as an Exudyn system.

    Attributes:
        scene, p: the deployment to simulate, and its parameters.
        system: system to be solved.
        watched: coordinates that determine the joint angles, each as (node, index in the node, reference value).
        sensors: node -> sensors of the node's coordinates and of their rates.
        contacts: sensors of the joints' contact forces; empty without clearance, or if `scene.forces_kept` is false.
        latch_times: latch times of the joints [s], nan while open; written while the system is solved.
    """

    def __init__(self, scene: Scene) -> None:
        self.scene, self.p = scene, scene.parameters
        self._container = exudyn.SystemContainer()  # owns the system, and must outlive it
        self.system = self._container.AddSystem()
        self.watched: list[tuple[int, int, float]] = []
        self.sensors: dict[int, tuple[Any, Any]] = {}
        self.contacts: list[Any] = []
        self.latch_times = [math.nan, math.nan]
        self._kept_alive: list[object] = []  # Python functions that the library calls
        self.panel = self.p.panel(0)  # both panels are alike
        ground = self.system.AddNode(items.NodePointGround(referenceCoordinates=[0, 0, 0]))
        self.ground = self.system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=ground, coordinate=0))
        latches = self.build()
        self._add_latches(latches)

    @abstractmethod
    def build(self) -> list[tuple[int, int]]:
        """Add all parts but the latches to the system; return each joint's two coordinate markers for its latch."""

    @abstractmethod
    def angles(self, *values: Value) -> tuple[Value, Value]:
        """Return the two joint angles [rad]; `values` are the coordinates in `watched`, in the same order."""

    def release(self) -> list[tuple[float, float]]:
        """Return (speed of the inner end along x [m/s], spin [rad/s]) of each folded panel at t = 0."""
        rates = [self.p.by_joint("initial_rate", j) for j in (0, 1)]
        return [(0.0, rates[0]), (self.panel.length * rates[0], rates[0] - rates[1])]

    def base(self) -> tuple[int, int]:
        """Add the main body; return the numbers of its node and of its body object."""
        node = self.system.AddNode(items.NodeRigidBody2D(referenceCoordinates=[0, 0, 0]))
        body = items.ObjectRigidBody2D(mass=self.p.body_mass, inertia=self.p.body_inertia, nodeNumber=node)
        return node, self.system.AddObject(body)

    def point(self, body: int, x: float, y: float = 0.0) -> int:
        """Add a marker at a body's point (x, y) in the body's frame [m], and return the marker's number."""
        return int(self.system.AddMarker(items.MarkerBodyRigid(bodyNumber=body, localPosition=[x, y, 0.0])))

    def torque_matrix(self, to_angles: Any, nodes: list[int]) -> None:
        """Add the torques of hinge springs and cable loop to the system, as an object with a stiffness matrix.

        The matrix `to_angles` (2, n) maps the n coordinates of `nodes` to the two joint angles.
        """
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
        """Add a joint between each (bearing, journal) pair of markers: a contact with clearance, or an ideal joint."""
        p, system = self.p, self.system
        for j, (bearing, journal) in enumerate(markers):
            if not self.scene.level.clearance:
                system.AddObject(items.ObjectJointRevolute2D(markerNumbers=[bearing, journal]))
                continue
            clearance = p.by_joint("clearance", j)
            data = items.NodeGenericData(initialCoordinates=[clearance, 0, 0, 0], numberOfDataCoordinates=4)
            contact = system.AddObject(
                items.ObjectContactSphereSphere(
                    markerNumbers=[journal, bearing],
                    nodeNumber=system.AddNode(data),
                    spheresRadii=[p.journal_radius, p.journal_radius + clearance],
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
            if self.scene.forces_kept:
                force = exudyn.OutputVariableType.Force
                sensor = items.SensorObject(objectNumber=contact, storeInternal=True, outputVariableType=force)
                self.contacts.append(system.AddSensor(sensor))

    def watch(self, *coordinates: tuple[int, int, float]) -> None:
        """Store `coordinates` in `watched`, and add sensors of their nodes' coordinates and rates to `sensors`.

        Each is (node, index of the coordinate in the node, reference value to add to the sensor's reading).
        """
        self.watched = list(coordinates)
        for node, _, _ in coordinates:
            if node not in self.sensors:
                kinds = exudyn.OutputVariableType.Coordinates, exudyn.OutputVariableType.Coordinates_t
                place, rate = (
                    self.system.AddSensor(
                        items.SensorNode(nodeNumber=node, storeInternal=True, outputVariableType=kind)
                    )
                    for kind in kinds
                )
                self.sensors[node] = place, rate

    def _add_latches(self, coordinates: list[tuple[int, int]]) -> None:
        """Add a latch between each joint's two coordinate markers in `coordinates`, then assemble the Exudyn system.

        A latch acts from the first step that begins past its lock angle.
        """
        system, latch_times, objects = self.system, self.latch_times, []
        locks = [joint.lock_angle for joint in self.p.joints]
        for j, pair in enumerate(coordinates):
            latch = system.AddObject(
                items.ObjectConnectorCoordinateSpringDamper(
                    markerNumbers=list(pair), stiffness=self.p.stop(j).stiffness, damping=0.0, activeConnector=False
                )
            )
            torque = _stop_expression(self.p.stop(j), _SENSES[j] * locks[j])
            symbolic = CreateSymbolicUserFunction(system, torque, "springForceUserFunction", latch)
            system.SetObjectParameter(latch, "springForceUserFunction", symbolic)
            self._kept_alive += [torque, symbolic]
            objects.append(latch)
        system.Assemble()
        places = [(system.systemData.GetNodeLTGODE2(node)[k], start) for node, k, start in self.watched]
        before = [0.0, 0.0, 0.0]  # time and angles at the start of the previous step
        called = [0.0, 0.0]  # the last two distinct times at which `engage` was called

        def engage(mbs: Any, time: float) -> bool:
            if math.isnan(latch_times[0] + latch_times[1]):
                # Exudyn calls with the end time of the step, and again if it repeats the step with half the size.
                called[:] = [called[1] if time > called[1] else called[0], time]
                q = system.systemData.GetODE2Coordinates()
                start, now = called[0], self.angles(*(q[place] + rest for place, rest in places))
                for j, angle in enumerate(now):
                    if math.isnan(latch_times[j]) and angle >= locks[j]:
                        share = (locks[j] - before[1 + j]) / (angle - before[1 + j])
                        latch_times[j] = before[0] + share * (start - before[0])
                        mbs.SetObjectParameter(objects[j], "activeConnector", True)
                before[:] = [start, *now]
            return True

        self._kept_alive.append(engage)
        system.SetPreStepUserFunction(engage)


def _stop_expression(stop: Stop, lock: float) -> Callable[..., Value]:
    """Return an Exudyn user function for the torque of a two-sided stop at `lock` [rad]; positive beyond `lock`."""
    symbolic = exudyn.symbolic

    def one_side(depth: Value, closing_rate: Value) -> Value:
        share = symbolic.min(symbolic.max(depth / stop.ramp_depth, 0.0), 1.0)
        damping = stop.damping * share * share * (3.0 - 2.0 * share)
        elastic = stop.stiffness * symbolic.pow(symbolic.max(depth, 0.0), stop.exponent)
        return symbolic.max(elastic + damping * closing_rate, 0.0)

    def torque(
        mbs: Any, t: Any, itemNumber: Any, displacement: Any, velocity: Any, stiffness: Any, damping: Any, offset: Any
    ) -> Value:
        below, above = lock - stop.gap - displacement, displacement - lock - stop.gap
        return symbolic.IfThenElse(
            below > 0.0,
            -one_side(below, -1.0 * velocity),
            symbolic.IfThenElse(above > 0.0, one_side(above, velocity), 0.0 * velocity),
        )

    return torque
