"""Interface of a formulation of the equations of motion: compilation into arrays, and results from the arrays."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.mechanism.description import Mechanism

Array = NDArray[np.float64]
ModelArrays = Any  # a formulation's named tuple of constant arrays
StateArrays = Any  # a formulation's named tuple of the arrays that change in a run


class JointView(NamedTuple):
    """Angles, rates and eccentricity of a joint that a controller may observe."""

    angle: float  # [rad]
    rate: float  # [rad/s]
    inboard_angle: float  # angle of the body with the bearing, between -pi and pi [rad]
    inboard_spin: float  # [rad/s]
    eccentricity_x: float  # journal centre minus bearing centre, in inertial axes [m]
    eccentricity_y: float


class Formulation(ABC):
    """A formulation of the equations of motion, with its own named tuples of model arrays and of state arrays.

    Runs, batches, recordings, environments and pictures read only the arrays that all formulations share. These are
    `joints` and `length_scale` of a model, and `q`, `v`, `integrals`, `joints`, `wear_journal`, `wear_bearing` and
    `clock` of a state. Everything else comes from the Python methods of a formulation.

    Attributes:
        view_joint: kernel (model, state, joint index) -> `JointView`.
    """

    view_joint: ClassVar[Callable]

    @abstractmethod
    def compile(self, mechanism: Mechanism) -> tuple[ModelArrays, StateArrays]:
        """Compile a mechanism into model and initial state; ValueError if the formulation cannot model a part of it."""

    @abstractmethod
    def begin(self, model: ModelArrays, state: StateArrays) -> None:
        """Compute, before a run, the state's arrays that follow from its positions and velocities, in place."""

    @abstractmethod
    def drift(self, model: ModelArrays, state: StateArrays) -> tuple[float, float]:
        """Return the greatest violation of any constraint [m] and of any constraint's rate [m/s]."""

    @abstractmethod
    def joint_loads(self, model: ModelArrays, state: StateArrays) -> Array:
        """Return the joint-load table (joints, LOAD_COLUMNS): angles, rates, forces and torques (`arrays.columns`)."""

    @abstractmethod
    def stored_energies(self, model: ModelArrays, state: StateArrays) -> Array:
        """Return the stored energies (ENERGIES,) [J] at a state, in the order of `model.ENERGY_NAMES`."""

    @abstractmethod
    def greatest_weight(self, model: ModelArrays) -> float:
        """Return the greatest magnitude [N] of the constant forces (weight and loads)."""

    @abstractmethod
    def momenta(self, model: ModelArrays, state: StateArrays) -> Array:
        """Return the momenta (3,) of the moving bodies: linear [N s], and angular about the origin [N m s]."""

    @abstractmethod
    def centreline(self, model: ModelArrays, q: Array, body: int, points_per_element: int) -> Array:
        """Return points (..., k, 2) [m] along the axis of a body, see `analysis.geometry.centreline`."""

    @abstractmethod
    def modal_range(self, model: ModelArrays, state: StateArrays) -> tuple[float, float]:
        """Return maxima since the start over all panels: end slope [rad], spin divided by lowest angular frequency."""

    @abstractmethod
    def constraint_force_defect(self, model: ModelArrays, state: StateArrays) -> tuple[float, float]:
        """Solve for constraint forces; return the greatest error of those in `state`, and the greatest force [N]."""
