"""Interface of a formulation of the equations of motion: how a mechanism becomes arrays, and what these say of it."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.mechanism.description import Mechanism

Array = NDArray[np.float64]
ModelArrays = Any  # a formulation's named tuple of constant arrays
StateArrays = Any  # that of what changes in a run


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

    Runs, batches, recordings, environments and pictures know of these arrays what all formulations share: of a model
    `joints` and `length_scale`, of a state `q`, `v`, `integrals`, `joints`, `wear_journal`, `wear_bearing` and `clock`.
    Whatever else there is to know is asked here.

    Attributes:
        view_joint: kernel (model, state, joint index) -> `JointView`.
    """

    view_joint: ClassVar[Callable]

    @abstractmethod
    def compile(self, mechanism: Mechanism) -> tuple[ModelArrays, StateArrays]:
        """Model and initial state of a mechanism.

        Raises:
            ValueError: if the mechanism has a part that the formulation does not take.
        """

    @abstractmethod
    def begin(self, model: ModelArrays, state: StateArrays) -> None:
        """Fill what a state holds beside positions and velocities before a run."""

    @abstractmethod
    def drift(self, model: ModelArrays, state: StateArrays) -> tuple[float, float]:
        """Greatest violations of a constraint and of a constraint's rate, in m and m/s."""

    @abstractmethod
    def joint_loads(self, model: ModelArrays, state: StateArrays) -> Array:
        """(joints, LOAD_COLUMNS) table of angles, rates, forces and torques; columns are named in `arrays.columns`."""

    @abstractmethod
    def stored_energies(self, model: ModelArrays, state: StateArrays) -> Array:
        """(ENERGIES,) stored energies [J], in the order of `model.ENERGY_NAMES`."""

    @abstractmethod
    def greatest_weight(self, model: ModelArrays) -> float:
        """Greatest magnitude of a constant force [N]."""

    @abstractmethod
    def momenta(self, model: ModelArrays, state: StateArrays) -> Array:
        """(3,) linear momentum [N s] and angular momentum about the origin [N m s] of the bodies that move."""

    @abstractmethod
    def centreline(self, model: ModelArrays, q: Array, body: int, points_per_element: int) -> Array:
        """Points along the axis of a body, see `analysis.geometry.centreline`."""

    @abstractmethod
    def modal_range(self, model: ModelArrays, state: StateArrays) -> tuple[float, float]:
        """Greatest slope of a modal panel's end so far [rad], and greatest spin over its lowest angular frequency."""

    @abstractmethod
    def constraint_force_defect(self, model: ModelArrays, state: StateArrays) -> tuple[float, float]:
        """Greatest difference of a constraint force from the one that holds its constraint, and greatest force [N]."""
