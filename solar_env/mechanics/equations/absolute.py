"""Formulation in absolute coordinates: the equations of motion in `system.py`, with multipliers for ideal joints."""

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
    """Return joint `j`'s `JointView`: angle, rate, its inboard body's angle and spin, and the eccentricity vector."""
    joint = model.joints[j]
    angle, rate, _, spin = joint_motion(joint, model.markers, state.q, state.v)
    x, y = direction(model.markers[joint.inboard], state.q)
    ex, ey = relative(joint, model.markers, state.q)
    return JointView(angle, rate, math.atan2(y, x), spin, ex, ey)


class AbsoluteCoordinates(Formulation):
    """Formulation of rigid bodies and beams of ANCF cable elements in coordinates along inertial axes."""

    view_joint = staticmethod(view_joint)

    def compile(self, mechanism: Mechanism) -> tuple[Model, State]:
        """Compile a mechanism into its model and its initial state."""
        return compile_mechanism(mechanism)

    def begin(self, model: Model, state: State) -> None:
        """Do nothing: integrators compute the initial accelerations and multipliers."""

    def drift(self, model: Model, state: State) -> tuple[float, float]:
        """Return the greatest violation of the linear constraints [m] and of their rates [m/s]."""
        work, time = make_workspace(model, state), state.clock["time"][0]
        position = constraint_drift(model, state.q, time, work)
        return float(position), float(velocity_drift(model, state.q, state.v, time, work))

    def joint_loads(self, model: Model, state: State) -> Array:
        """Return joints' motion, forces and torques (joints, LOAD_COLUMNS), solving anew for the constraint forces."""
        return _evaluate(model, state)[0].loads

    def stored_energies(self, model: Model, state: State) -> Array:
        """Return the stored energies (ENERGIES,) [J] at a state, in the order of `model.ENERGY_NAMES`."""
        energies = np.zeros(ENERGIES)
        system.stored_energies(model, state.joints, state.q, state.v, self.joint_loads(model, state), energies)
        return energies

    def greatest_weight(self, model: Model) -> float:
        """Return the greatest magnitude of the constant generalized forces [N]."""
        return float(np.abs(model.constant_force).max(initial=0.0))

    def momenta(self, model: Model, state: State) -> Array:
        """Return the momenta (3,) along x and y [N s] and about the origin [N m s], from the bodies' rigid motions."""
        momentum = np.zeros_like(state.v)
        system.add_mass_products(model, state.v, momentum)
        motions = np.zeros((3, state.q.size))
        for row in model.bodies:
            of_body = slice(row["offset"], row["offset"] + row["coordinates"])
            motions[:, of_body] = KINDS[row["kind"]].rigid_motions(state.q[of_body])
        return motions @ momentum

    def centreline(self, model: Model, q: Array, body: int, points_per_element: int) -> Array:
        """Return points (..., k, 2) [m] along a body's axis; their number k depends on the kind of body."""
        row = model.bodies[body]
        first = int(row["offset"])
        of_body = q[..., first : first + int(row["coordinates"])]
        return KINDS[row["kind"]].centreline(row, of_body, points_per_element)

    def modal_range(self, model: Model, state: State) -> tuple[float, float]:
        """Return zero maxima of panels' end slope [rad], and of spin divided by lowest frequency: no panel is modal."""
        return 0.0, 0.0

    def constraint_force_defect(self, model: Model, state: State) -> tuple[float, float]:
        """Return the greatest error of `state.multipliers` against exact constraint forces, and greatest force [N]."""
        work, multipliers = _evaluate(model, state)
        # The multiplier of a length constraint times the body's length is a force.
        scale = np.ones_like(multipliers)
        scale[model.constraints.target.size :] = model.bodies["length"]
        system.applied_forces(model, state.joints, state.q, state.v, work)
        largest = max(np.abs(scale * multipliers).max(initial=0.0), np.abs(work.force).max(initial=0.0))
        return float(np.abs(scale * (state.multipliers - multipliers)).max(initial=0.0)), float(largest)


def _evaluate(model: Model, state: State) -> tuple[Workspace, Array]:
    """Return a workspace with the loads and powers at the state, and the multipliers that satisfy the constraints."""
    work = make_workspace(model, state)
    work.impact_speeds[:] = np.where(state.joints["in_contact"], state.joints["impact_speed"], 0.0)
    scratch, multipliers = np.zeros_like(state.a), np.zeros_like(state.multipliers)
    system.accelerations(model, state.joints, state.q, state.v, state.clock["time"][0], work, scratch, multipliers)
    return work, multipliers
