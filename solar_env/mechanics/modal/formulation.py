"""Formulation of the motion of rigid bodies and panels with elastic modes in floating frames, driven by joint loads."""

import itertools
import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline

from solar_env.mechanics.arrays.columns import ECCENTRICITY_X, ECCENTRICITY_Y
from solar_env.mechanics.arrays.model import ENERGIES, IDEAL
from solar_env.mechanics.equations.formulation import Array, Formulation, JointView
from solar_env.mechanics.mechanism.description import Mechanism
from solar_env.mechanics.modal.arrays import (
    RIGID_BODY,
    VELOCITY_X,
    VELOCITY_Y,
    ModalModel,
    ModalState,
    Workspace,
    make_workspace,
)
from solar_env.mechanics.modal.books import fill_load_table, stored_energies
from solar_env.mechanics.modal.build import compile_modal
from solar_env.mechanics.modal.foreshortening import bending_shapes
from solar_env.mechanics.modal.method import start_loads
from solar_env.mechanics.modal.motion import look_at
from solar_env.mechanics.modal.tables import AXIAL_EVEN, AXIAL_ODD, EVEN_ENDS, LAST, ODD_ENDS
from solar_env.mechanics.numerics.jit import kernel

_PARTS = 8  # number of parts of a panel's axis, each with as many points as an element of a beam


@kernel
def view_joint(model, state, j):
    """Return the `JointView` of joint `j`, which a controller may observe: angles, rates and eccentricity."""
    view = state.views[j]
    return JointView(view[0], view[1], math.atan2(math.sin(view[2]), math.cos(view[2])), view[3], view[4], view[5])


class FloatingFrames(Formulation):
    """Formulation by each body's centre of mass, angle and modal amplitudes; joint loads are the unknowns of a step."""

    view_joint = staticmethod(view_joint)

    def compile(self, mechanism: Mechanism) -> tuple[ModalModel, ModalState]:
        """Compile a mechanism of rigid bodies and modal panels into its constant model and its initial state."""
        return compile_modal(mechanism)

    def begin(self, model: ModalModel, state: ModalState) -> None:
        """Compute motion, loads and controllers' views of joints at the start of a run, and store them in `state`."""
        start_loads(model, state, make_workspace(model, state))

    def drift(self, model: ModalModel, state: ModalState) -> tuple[float, float]:
        """Return the greatest components of position gap [m] and relative velocity [m/s] in ideal joints, ideally 0."""
        motion = np.abs(present_motion(model, state).joints["motion"][model.joints["kind"] == IDEAL, :, LAST])
        gaps, rates = motion[:, [ECCENTRICITY_X, ECCENTRICITY_Y]], motion[:, [VELOCITY_X, VELOCITY_Y]]
        return float(gaps.max(initial=0.0)), float(rates.max(initial=0.0))

    def joint_loads(self, model: ModalModel, state: ModalState) -> Array:
        """Return the table (joints, LOAD_COLUMNS) of joint motion, forces and torques at the end of the last step."""
        work = present_motion(model, state)
        fill_load_table(model, state, work, state.course[:, LAST], work.sample)
        return work.sample

    def stored_energies(self, model: ModalModel, state: ModalState) -> Array:
        """Return the (ENERGIES,) stored energies of the present state [J], in the order of `model.ENERGY_NAMES`."""
        energies = np.zeros(ENERGIES)
        stored_energies(model, state, state.q, state.v, present_motion(model, state), energies)
        return energies

    def greatest_weight(self, model: ModalModel) -> float:
        """Return the greatest weight of a moving body [N]."""
        moving = model.bodies["inverse_mass"] > 0.0
        return float(np.hypot(*model.gravity) * model.bodies["mass"][moving].max(initial=0.0))

    def momenta(self, model: ModalModel, state: ModalState) -> Array:
        """Return the moving bodies' summed momenta (3,): linear x and y [N s], and angular about the origin [N m s]."""
        bodies = model.bodies[model.bodies["inverse_mass"] > 0.0]
        first, mass = bodies["offset"], bodies["mass"]
        x, y = state.q[first], state.q[first + 1]
        u, v, spin = state.v[first], state.v[first + 1], state.v[first + 2]
        angular = mass * (x * v - y * u) + bodies["inertia"] * spin
        return np.array([(mass * u).sum(), (mass * v).sum(), angular.sum()])

    def centreline(self, model: ModalModel, q: Array, body: int, points_per_element: int) -> Array:
        """Return points (..., k, 2) [m] along the axis of body number `body`, at coordinates `q` (..., n).

        A rigid body has k = 2 ends; a panel has 8 equal parts of `points_per_element` intervals, k - 1 in all.
        """
        row = model.bodies[body]
        first = int(row["offset"])
        if row["panel"] == RIGID_BODY:
            local = np.array([0.0j, row["length"]]) - complex(row["centroid_x"], row["centroid_y"])
        else:
            local = _panel_axis(model, row, q[..., first + 3 :], _PARTS * points_per_element + 1)
        centre, turn = q[..., first, None] + 1j * q[..., first + 1, None], np.exp(1j * q[..., first + 2, None])
        line = centre + turn * local
        return np.stack([line.real, line.imag], axis=-1)

    def modal_range(self, model: ModalModel, state: ModalState) -> tuple[float, float]:
        """Return maxima since the start: slope of a panel's end [rad], spin divided by lowest angular frequency."""
        slope, spin_ratio = state.extremes
        return float(slope), float(spin_ratio)

    def constraint_force_defect(self, model: ModalModel, state: ModalState) -> tuple[float, float]:
        """Return the reactions' error, 0 as steps solve for them, and the greatest component of any joint force [N]."""
        return 0.0, float(np.abs(state.course[-2 * len(model.joints) :, LAST]).max(initial=0.0))


def present_motion(model: ModalModel, state: ModalState) -> Workspace:
    """Return a new workspace that holds the motion of bodies and joints at the state's coordinates and velocities."""
    work = make_workspace(model, state)
    look_at(model, state.q, state.v, work)
    return work


def _panel_axis(model: ModalModel, row: np.void, amplitudes: Array, points: int) -> NDArray[np.complex128]:
    """Return equally spaced points (..., points) [m] of a panel's axis in the panel's frame, as complex x + i y.

    `row` is the panel's record in `model.bodies`, and `amplitudes` (..., modes) are its modal amplitudes. The lowest
    bending modes have their true shapes. Pseudo-modes represent all higher modes at the ends; between the ends, their
    deflection is interpolated by a cubic, and axial displacement linearly.
    """
    panels, d, s = model.panels, row["design"], np.linspace(0.0, 1.0, points)
    parts = [slice(*pair) for pair in itertools.pairwise(panels.first)]

    def beyond(group: int, lowest: int) -> Array:
        """Return the first end's motion (..., 2) due to the modes of kind `group`, except the first `lowest` modes.

        It is (deflection, slope) in bending, (displacement, 0) axially. The enclosing `amplitudes` are (..., modes).
        """
        return np.asarray(amplitudes[..., parts[group]][..., lowest:] @ panels.shapes[d, :, parts[group]].T[lowest:])

    low = [
        np.concatenate([amplitudes[..., parts[g]][..., :k], beyond(g, k)], axis=-1)
        for g, k in enumerate(panels.coupled[:2])
    ]
    u, odd_u = beyond(AXIAL_EVEN, 0)[..., 0], beyond(AXIAL_ODD, 0)[..., 0]
    for g in range(2):
        odd, even = panels.forms[d, g, :, :, ODD_ENDS], panels.forms[d, g, :, :, EVEN_ENDS]
        for same, other, axial, form in ((low[g], low[g], odd_u, odd), (low[g], low[1 - g], u, even)):
            block = form[: same.shape[-1], : other.shape[-1]]
            axial += 0.5 * np.einsum("ij,...i,...j->...", block, same, other)
    along = np.stack([u + odd_u, u - odd_u], axis=-1) @ np.stack([1.0 - s, s])
    (w, slope), (odd_w, odd_slope) = (np.moveaxis(beyond(g, k), -1, 0) for g, k in enumerate(panels.kept))
    ends, slopes = np.stack([w + odd_w, w - odd_w]), np.stack([odd_slope + slope, odd_slope - slope])
    across = np.moveaxis(CubicHermiteSpline([0.0, row["length"]], ends, slopes)(s * row["length"]), 0, -1)
    shapes = _kept_shapes(panels.kept.sum(), points) / math.sqrt(row["mass"])
    for g, k in enumerate(panels.kept):
        across += amplitudes[..., parts[g]][..., :k] @ shapes[g::2]
    return (s - 0.5) * row["length"] + along + 1j * across


@lru_cache(maxsize=16)
def _kept_shapes(modes: int, points: int) -> Array:
    """Return the bending modes (modes, points) of a free beam of unit mass, at equally spaced points."""
    return bending_shapes(1.0, 1.0, modes, np.linspace(0.0, 1.0, points))[0]
