"""Formulation of rigid bodies and modal panels in floating frames, which the loads of the joints move."""

import numpy as np

from solar_env.mechanics.arrays.columns import ECCENTRICITY_X, ECCENTRICITY_Y
from solar_env.mechanics.arrays.model import ENERGIES, IDEAL
from solar_env.mechanics.equations.formulation import Array, Formulation
from solar_env.mechanics.mechanism.description import Mechanism
from solar_env.mechanics.modal.arrays import (
    OTHER,
    VELOCITY_X,
    VELOCITY_Y,
    ModalModel,
    ModalState,
    Workspace,
    make_workspace,
)
from solar_env.mechanics.modal.build import compile_modal
from solar_env.mechanics.modal.run.books import stored_energies
from solar_env.mechanics.modal.run.method import start_loads
from solar_env.mechanics.modal.run.sampling import fill_load_table
from solar_env.mechanics.modal.step.motion import look_at
from solar_env.mechanics.modal.views import modal_centreline, view_joint


class FloatingFrames(Formulation):
    """Centre of mass, angle and modal amplitudes of every body; loads of the joints as the unknowns of a step."""

    view_joint = staticmethod(view_joint)

    def compile(self, mechanism: Mechanism) -> tuple[ModalModel, ModalState]:
        """See `Formulation.compile`."""
        return compile_modal(mechanism)

    def begin(self, model: ModalModel, state: ModalState) -> None:
        """Fill the loads of the joints with the torques of their laws."""
        start_loads(model, state, make_workspace(model, state))

    def drift(self, model: ModalModel, state: ModalState) -> tuple[float, float]:
        """Return the greatest violations of the ideal joints, in m and m/s."""
        motion = np.abs(present_motion(model, state).joints["motion"][model.joints["kind"] == IDEAL, OTHER])
        gaps, rates = motion[:, [ECCENTRICITY_X, ECCENTRICITY_Y]], motion[:, [VELOCITY_X, VELOCITY_Y]]
        return float(gaps.max(initial=0.0)), float(rates.max(initial=0.0))

    def joint_loads(self, model: ModalModel, state: ModalState) -> Array:
        """Evaluate the table of loads with those at the end of the last step."""
        work = present_motion(model, state)
        fill_load_table(model, state, work, OTHER, state.loads, work.sample)
        return work.sample

    def stored_energies(self, model: ModalModel, state: ModalState) -> Array:
        """See `Formulation.stored_energies`."""
        energies = np.zeros(ENERGIES)
        stored_energies(model, state, state.q, state.v, present_motion(model, state), OTHER, energies)
        return energies

    def greatest_weight(self, model: ModalModel) -> float:
        """Return the greatest weight of a body that moves [N]."""
        moving = model.bodies["inverse_mass"] > 0.0
        return float(np.hypot(*model.gravity) * model.bodies["mass"][moving].max(initial=0.0))

    def momenta(self, model: ModalModel, state: ModalState) -> Array:
        """Return the momenta of the frames: the modes have none."""
        bodies = model.bodies[model.bodies["inverse_mass"] > 0.0]
        first, mass = bodies["offset"], bodies["mass"]
        x, y = state.q[first], state.q[first + 1]
        u, v, spin = state.v[first], state.v[first + 1], state.v[first + 2]
        angular = mass * (x * v - y * u) + bodies["inertia"] * spin
        return np.array([(mass * u).sum(), (mass * v).sum(), angular.sum()])

    def centreline(self, model: ModalModel, q: Array, body: int, points_per_element: int) -> Array:
        """See `modal_centreline`."""
        return modal_centreline(model, q, body, points_per_element)

    def modal_range(self, model: ModalModel, state: ModalState) -> tuple[float, float]:
        """See `Formulation.modal_range`."""
        (slope, spin_ratio), panels = state.extremes, model.panels
        even, odd, end = panels.first[:3]
        for body in model.bodies[model.bodies["panel"] >= 0]:
            first, d = body["offset"] + 3, body["design"]
            slopes = [panels.rows[d, i:k, 1] @ state.q[first + i : first + k] for i, k in ((even, odd), (odd, end))]
            # At one end or the other, the even and the odd part add up.
            slope = max(slope, float(np.abs(slopes).sum()))
            spin_ratio = max(spin_ratio, float(abs(state.v[first - 1]) / panels.frequency[d, even:end].min()))
        return float(slope), float(spin_ratio)

    def constraint_force_defect(self, model: ModalModel, state: ModalState) -> tuple[float, float]:
        """Return no defect, for every step solves for the reactions, and the greatest reaction [N]."""
        return 0.0, float(np.abs(state.loads[:, :2]).max(initial=0.0))


def present_motion(model: ModalModel, state: ModalState) -> Workspace:
    """Return a workspace whose slot OTHER holds the present motion."""
    work = make_workspace(model, state)
    look_at(model, state.q, state.v, work, OTHER)
    return work
