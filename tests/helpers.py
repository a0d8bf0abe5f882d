"""Comparisons that several test modules share."""

from __future__ import annotations

import base64
import gzip
import hashlib
import json
import math
import re
import warnings
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from mechanisms import Vector, beam_rotor, rotor

from solar_env.array import ArrayParameters, build
from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.arrays.columns import ANGLE
from solar_env.mechanics.bodies.kinds import KINDS
from solar_env.mechanics.equations.build import compile_mechanism
from solar_env.mechanics.equations.system import add_mass_products, make_workspace, stored_energies
from solar_env.mechanics.integrators.settings import GeneralizedAlpha, RungeKutta
from solar_env.mechanics.joints.joint import joint_forces
from solar_env.mechanics.mechanism.description import Mechanism
from solar_env.mechanics.records.recording import make_recorder
from solar_env.mechanics.running.diagnosis import SimulationWarning
from solar_env.mechanics.running.simulation import Simulation
from solar_env.studies.common.motion import Motion


class Forces:
    """Forces, loads, powers and stored energies of a compiled mechanism as functions of its state."""

    def __init__(self, mechanism: Mechanism, impact_speed: float = 0.0) -> None:
        self.model, self.state = compile_mechanism(mechanism)
        self.work = make_workspace(self.model, self.state)
        self.work.impact_speeds[:] = impact_speed

    @classmethod
    def of(cls, simulation: Simulation) -> Forces:
        """Those of a simulation, at its own state."""
        forces = cls.__new__(cls)
        forces.model, forces.state = simulation.model, simulation.state
        forces.work = make_workspace(forces.model, forces.state)
        return forces

    def force(self, q: Vector, v: Vector) -> Vector:
        """Generalized force of all joints, gravity left out; loads and powers are left in `work`."""
        total = np.zeros_like(q)
        joint_forces(
            self.model, self.state.joints, self.work.impact_speeds, q, v, self.work.loads, total, self.work.power
        )
        return total

    def stored(self, q: Vector, v: Vector) -> Vector:
        """The stored energies."""
        self.force(q, v)
        energies = np.zeros(len(m.ENERGY_NAMES))
        stored_energies(self.model, self.state.joints, q, v, self.work.loads, energies)
        return energies

    def integral_powers(self) -> Vector:
        """(joints, INTEGRALS_PER_JOINT) powers of the last evaluation."""
        return m.joint_integrals(self.work.power)

    def constraint_rows(self) -> Vector:
        """(m, n) linear constraint rows of the last evaluation, drives included."""
        constraints = self.model.constraints
        rows = np.zeros((constraints.size.size, self.state.q.size))
        for r, size in enumerate(constraints.size):
            np.add.at(rows[r], constraints.coordinate[r, :size], self.work.row_value[r, :size])
        return rows

    def mass_product(self, a: Vector) -> Vector:
        """M a, zero for fixed bodies."""
        out = np.zeros_like(a)
        add_mass_products(self.model, a, out)
        return out


def rigid_motions(model: m.Model, q: Vector) -> Vector:
    """(3, n) velocities when everything moves as one body: along x, along y, and about the origin."""
    parts = np.split(q, model.bodies["offset"][1:])
    return np.hstack([KINDS[body["kind"]].rigid_motions(own) for body, own in zip(model.bodies, parts, strict=True)])


def central_difference(function: Callable[[Vector], Vector], x: Vector, step: float = 2e-4) -> Vector:
    """Jacobian of a function by central differences of step h and h/2, extrapolated.

    The error is of order h^4 f^(5) / 480 + 2 eps |f| / h. The forces' sharpest bend is that of depth^1.5 at a depth of
    0.02, whose fifth derivative is 1e6 times their scale: both terms come to about 1e-12 to 1e-11.
    """
    columns = []
    for i in range(x.size):

        def slope(h: float, i: int = i) -> Vector:
            e = np.zeros_like(x)
            e[i] = h
            return (np.asarray(function(x + e)) - np.asarray(function(x - e))) / (2.0 * h)

        columns.append((4.0 * slope(step / 2) - slope(step)) / 3.0)
    return np.stack(columns, axis=-1)


def fingerprint(state: m.State, skip: tuple[str, ...] = ()) -> str:
    """Hash of all bits of a state, but for the arrays in `skip`."""
    digest = hashlib.sha256()
    for name, array in zip(state._fields, state, strict=True):
        if name not in skip:
            digest.update(array.tobytes())
    return digest.hexdigest()


def orders(errors: list[float]) -> Vector:
    """Observed orders of convergence when every error belongs to half the step of the one before."""
    values = np.asarray(errors)
    return np.log2(values[:-1] / values[1:])


def single_steps(mechanism: Mechanism, integrator: Any) -> Simulation:
    """A simulation whose calls stop after one attempted step: `attempt` then takes the next one."""
    return Simulation(mechanism, replace(integrator, max_steps=1))


def attempt(simulation: Simulation, end_time: float) -> bool:
    """Let a simulation of `single_steps` try one step; whether it has reached `end_time`."""
    from solar_env.mechanics.running.errors import SimulationError

    try:
        simulation.advance(end_time)
    except SimulationError as error:
        if error.reason != "steps":
            raise
    return simulation.time >= end_time


def in_miniature() -> None:
    """Run every kind of element and event a little with both integrators, and print what came of it."""
    # A narrow clearance and strong springs: impacts within the first 15 ms.
    p = ArrayParameters(clearance=1e-6, spring_stiffness=20.0, cable_preload_force=0.01, wear_bins=8)
    for integrator in (RungeKutta(), GeneralizedAlpha(step=2e-4)):
        for name, mechanism, torque, duration in (
            ("rigid-ideal", build(p, "rigid-ideal"), 0.1, 0.01),
            ("rigid-clearance", build(p, "rigid-clearance"), 0.1, 0.015),
            ("latching", rotor(0.01), 100.0, 0.03),
            ("flexible-ideal", build(p, "flexible-ideal:2 elements"), 0.1, 0.004),
            # In flight: the steps of an impact on a beam are chosen by errors so small that rounding decides.
            ("flexible-clearance", build(ArrayParameters(wear_bins=8), "flexible-clearance:1 element"), 0.1, 0.002),
            ("latching-beam", beam_rotor(0.01), 1.0, 0.1),
        ):
            simulation = Simulation(mechanism, integrator)
            simulation.set_motor_torque(0, torque)
            recorder = make_recorder(simulation.model, simulation.state, np.linspace(0.0, duration, 5), 1000)
            with warnings.catch_warnings():
                # The step is too long for the impacts, as it is told; here only the code counts that runs.
                warnings.filterwarnings("ignore", "an impact of", SimulationWarning)
                simulation.advance(duration, recorder)
            state = simulation.state
            print(
                f"{name}/{integrator.name}",
                state.joints["contact_starts"].sum(),
                state.joints["latched"].sum(),
                state.wear_journal.sum(),
                *simulation.joint_loads()[:, ANGLE],
                *simulation.stored_energies(),
                *recorder.samples[-1],
            )


MOTION_TIMES = np.linspace(0.0, 1.0, 11)


def make_motion(
    angle: float = 0.0,
    latch: tuple[float, float] = (0.5, math.nan),
    time: Vector = MOTION_TIMES,
) -> Motion:
    """Record of a study of a run of two joints that turn evenly."""
    return Motion(
        time=time,
        angles=np.outer(time, [1.0, 2.0]) + angle,
        latch_times=np.array(latch),
        wall_time=1.0,
    )


def page_data(text):
    """The numbers in a page of HTML."""
    packed = re.search(r'<script type="text/plain" id="data">(.*?)</script>', text)[1]
    return json.loads(gzip.decompress(base64.b64decode(packed)))


def numbers(text: str) -> set[str]:
    """The numbers of a text as they are written, whatever stands between them."""
    return {number.rstrip(".,") for number in re.findall(r"-?\d[\d.,]*", text)}
