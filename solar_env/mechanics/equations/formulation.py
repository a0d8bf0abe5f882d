"""Interface of a formulation of the equations of motion: how a mechanism becomes arrays, and what these say of it."""

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
    """A joint as a controller may observe it."""

    angle: float  # [rad]
    rate: float  # [rad/s]
    inboard_angle: float  # of the body with the bearing, between -pi and pi [rad]
    inboard_spin: float  # [rad/s]
    eccentricity_x: float  # journal centre minus bearing centre, in inertial axes [m]
    eccentricity_y: float


class Formulation(ABC):
    """A formulation, with one named tuple of arrays for models and one for states.

    Runs, batches, recordings, environments and pictures read only the arrays that all formulations share: of a model
    `joints` and `length_scale`, of a state `q`, `v`, `integrals`, `joints`, `wear_journal`, `wear_bearing` and `clock`.
    They ask a formulation for everything else.

    Attributes:
        view_joint: kernel (model, state, joint index) -> `JointView`.
    """

    view_joint: ClassVar[Callable]

    @abstractmethod
    def compile(self, mechanism: Mechanism) -> tuple[ModelArrays, StateArrays]:
        """Compile a mechanism into its model and its initial state.

        Raises:
            ValueError: if the mechanism has a part that the formulation does not take.
        """

    @abstractmethod
    def begin(self, model: ModelArrays, state: StateArrays) -> None:
        """Fill a state's arrays beside positions and velocities before a run."""

    @abstractmethod
    def drift(self, model: ModelArrays, state: StateArrays) -> tuple[float, float]:
        """Return the greatest violations of a constraint and of a constraint's rate, in m and m/s."""

    @abstractmethod
    def joint_loads(self, model: ModelArrays, state: StateArrays) -> Array:
        """Return the table (joints, LOAD_COLUMNS) of angles, rates, forces and torques, see `arrays.columns`."""

    @abstractmethod
    def stored_energies(self, model: ModelArrays, state: StateArrays) -> Array:
        """Return the (ENERGIES,) stored energies [J], in the order of `model.ENERGY_NAMES`."""

    @abstractmethod
    def greatest_weight(self, model: ModelArrays) -> float:
        """Return the greatest magnitude of a constant force [N]."""

    @abstractmethod
    def momenta(self, model: ModelArrays, state: StateArrays) -> Array:
        """Return the momenta (3,) of the moving bodies: linear [N s], and angular about the origin [N m s]."""

    @abstractmethod
    def centreline(self, model: ModelArrays, q: Array, body: int, points_per_element: int) -> Array:
        """Return the points along the axis of a body, see `analysis.geometry.centreline`."""

    @abstractmethod
    def modal_range(self, model: ModelArrays, state: StateArrays) -> tuple[float, float]:
        """Return maxima so far: slope of a modal panel's end [rad], spin divided by lowest angular frequency."""

    @abstractmethod
    def constraint_force_defect(self, model: ModelArrays, state: StateArrays) -> tuple[float, float]:
        """Return the greatest error of forces against those that hold the constraints, and the greatest force [N]."""
