"""Formulation in absolute coordinates: the equations of motion of `system`, with multipliers for ideal joints."""

import math

import numpy as np

from solar_env.mechanics.arrays.model import ENERGIES, Model, State
from solar_env.mechanics.bodies.kinds import KINDS
from solar_env.mechanics.bodies.markers import direction
from solar_env.mechanics.equations import system
from solar_env.mechanics.equations.build import compile_mechanism
from solar_env.mechanics.equations.constraints import constraint_drift, velocity_drift
from solar_env.mechanics.equations.formulation import Array, Formulation, JointView
from solar_env.mechanics.equations.system import Workspace, make_workspace
from solar_env.mechanics.joints.joint import joint_motion, relative
from solar_env.mechanics.mechanism.description import Mechanism
from solar_env.mechanics.numerics.jit import kernel


@kernel
def view_joint(model, state, j):
    """Return the joint `j` as a controller may observe it."""
    joint = model.joints[j]
    angle, rate, _, spin = joint_motion(joint, model.markers, state.q, state.v)
    x, y = direction(model.markers[joint.inboard], state.q)
    ex, ey = relative(joint, model.markers, state.q)
    return JointView(angle, rate, math.atan2(y, x), spin, ex, ey)


class AbsoluteCoordinates(Formulation):
    """Rigid bodies and beams of cable elements in coordinates of inertial axes, see `bodies.kinds`."""

    view_joint = staticmethod(view_joint)

    def compile(self, mechanism: Mechanism) -> tuple[Model, State]:
        """See `Formulation.compile`."""
        return compile_mechanism(mechanism)

    def begin(self, model: Model, state: State) -> None:
        """Do nothing: integrators evaluate accelerations and multipliers."""

    def drift(self, model: Model, state: State) -> tuple[float, float]:
        """Return the greatest violations of the linear constraints, in m and m/s."""
        work, time = make_workspace(model, state), state.clock["time"][0]
        position = constraint_drift(model, state.q, time, work)
        return float(position), float(velocity_drift(model, state.q, state.v, time, work))

    def joint_loads(self, model: Model, state: State) -> Array:
        """Evaluate the table of loads with the multipliers that hold the constraints now."""
        return _evaluate(model, state)[0].loads

    def stored_energies(self, model: Model, state: State) -> Array:
        """See `Formulation.stored_energies`."""
        energies = np.zeros(ENERGIES)
        system.stored_energies(model, state.joints, state.q, state.v, self.joint_loads(model, state), energies)
        return energies

    def greatest_weight(self, model: Model) -> float:
        """Return the greatest magnitude of the constant generalized forces [N]."""
        return float(np.abs(model.constant_force).max(initial=0.0))

    def momenta(self, model: Model, state: State) -> Array:
        """Return the products of the generalized momentum with the three rigid motions of the mechanism."""
        momentum = np.zeros_like(state.v)
        system.add_mass_products(model, state.v, momentum)
        motions = np.zeros((3, state.q.size))
        for row in model.bodies:
            of_body = slice(row["offset"], row["offset"] + row["coordinates"])
            motions[:, of_body] = KINDS[row["kind"]].rigid_motions(state.q[of_body])
        return motions @ momentum

    def centreline(self, model: Model, q: Array, body: int, points_per_element: int) -> Array:
        """Ask the body's kind for its points."""
        row = model.bodies[body]
        first = int(row["offset"])
        of_body = q[..., first : first + int(row["coordinates"])]
        return KINDS[row["kind"]].centreline(row, of_body, points_per_element)

    def modal_range(self, model: Model, state: State) -> tuple[float, float]:
        """Return zeros: there are no modal panels."""
        return 0.0, 0.0

    def constraint_force_defect(self, model: Model, state: State) -> tuple[float, float]:
        """Return the defect of generalized-alpha's multipliers; a length's multiplier counts times that length."""
        work, multipliers = _evaluate(model, state)
        scale = np.ones_like(multipliers)
        scale[model.constraints.target.size :] = model.bodies["length"]
        system.applied_forces(model, state.joints, state.q, state.v, work)
        largest = max(np.abs(scale * multipliers).max(initial=0.0), np.abs(work.force).max(initial=0.0))
        return float(np.abs(scale * (state.multipliers - multipliers)).max(initial=0.0)), float(largest)


def _evaluate(model: Model, state: State) -> tuple[Workspace, Array]:
    """Return a workspace with the present loads and powers, and the multipliers that hold the constraints."""
    work = make_workspace(model, state)
    work.impact_speeds[:] = np.where(state.joints["in_contact"], state.joints["impact_speed"], 0.0)
    scratch, multipliers = np.zeros_like(state.a), np.zeros_like(state.multipliers)
    system.accelerations(model, state.joints, state.q, state.v, state.clock["time"][0], work, scratch, multipliers)
    return work, multipliers
