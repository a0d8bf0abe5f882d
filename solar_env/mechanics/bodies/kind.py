"""Interface between a kind of body and the mechanism compiler, which turns descriptions into arrays."""

import math
from abc import ABC, abstractmethod
from typing import Any, ClassVar, Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.bodies.description import AnyBody, Point

Array = NDArray[np.float64]
Fields = list[tuple[str, type]]
Described = TypeVar("Described", bound=AnyBody)


class BodyKind(ABC, Generic[Described]):
    """Interface of a kind of body; each body of the kind has n generalized coordinates.

    Attributes:
        description: class of the bodies' parameters.
        body_fields: record fields that the kind's kernels need, beyond the fields common to all bodies.
        deformable: whether bodies of the kind deform.
        constraints: number of constraints between a body's own coordinates, 0 or 1.
    """

    description: ClassVar[type[AnyBody]]
    body_fields: ClassVar[Fields] = []
    deformable: ClassVar[bool] = False
    constraints: ClassVar[int] = 0

    @abstractmethod
    def coordinates(self, body: Described) -> int:
        """Return the number n of a body's generalized coordinates."""

    @abstractmethod
    def fill(self, body: Described, row: np.void, constants: list[float]) -> None:
        """Write a body's parameters to its record `row`; append arrays to `constants`; set their indices in `row`."""

    @abstractmethod
    def fill_marker(self, body: Described, row: np.void, first: int, point: Point) -> None:
        """Write the marker record `row` for a body-frame `point` [m]; `first` is the body's first coordinate index.

        Raises:
            ValueError: if the kind allows no marker at the point.
        """

    @abstractmethod
    def initial_motion(self, body: Described) -> tuple[Array, Array]:
        """Return a body's coordinates (n,) and velocities (n,) at t = 0."""

    @abstractmethod
    def weight(self, body: Described, gravity: Point) -> Array:
        """Return a body's generalized gravity force (n,), which must be constant, for a gravity vector [m/s2]."""

    def error_weight(self, body: Described) -> Array:
        """Return error-norm factors (n,) that scale coordinates to translations: by default 1, as for positions."""
        return np.ones(self.coordinates(body))

    def stable_step(self, body: Described) -> float:
        """Return the largest step [s] for which explicit Runge-Kutta is stable on the body without joints."""
        return math.inf

    def rigid_motions(self, q: Array) -> Array:
        """Return the coordinate rates (3, n) of rigid motion at unit speed along x, along y, and about the origin.

        The default implementation takes each pair of coordinates as a point.
        """
        along = np.resize([1.0, 0.0], q.size)
        return np.stack([along, 1.0 - along, np.stack([-q[1::2], q[0::2]], axis=1).ravel()])

    @abstractmethod
    def centreline(self, row: Any, q: Array, points_per_element: int) -> Array:
        """Return points (..., k, 2) [m] along the axis of the body with record `row` at coordinates `q` (..., n)."""
