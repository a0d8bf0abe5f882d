"""Interface of a kind of body to the compiler of mechanisms: how a description becomes arrays."""

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
    """A kind of body, with n generalized coordinates.

    Attributes:
        description: class of its parameters.
        body_fields: members of a body's row that its kernels need beyond the common ones.
        deformable: whether it deforms.
        constraints: number of constraints among its coordinates, 0 or 1.
    """

    description: ClassVar[type[AnyBody]]
    body_fields: ClassVar[Fields] = []
    deformable: ClassVar[bool] = False
    constraints: ClassVar[int] = 0

    @abstractmethod
    def coordinates(self, body: Described) -> int:
        """Return the number n of generalized coordinates."""

    @abstractmethod
    def fill(self, body: Described, row: np.void, constants: list[float]) -> None:
        """Fill the kind's members of a body's row; arrays are added to `constants`, the row says where they begin."""

    @abstractmethod
    def fill_marker(self, body: Described, row: np.void, first: int, point: Point) -> None:
        """Fill a marker's linear map (`markers`) for a point of the body frame [m], by the body's first coordinate.

        Raises:
            ValueError: if nothing can be attached there.
        """

    @abstractmethod
    def initial_motion(self, body: Described) -> tuple[Array, Array]:
        """Return the coordinates (n,) and velocities (n,) at t = 0."""

    @abstractmethod
    def weight(self, body: Described, gravity: Point) -> Array:
        """Return the generalized force (n,) of gravity [m/s2], which must be constant."""

    def error_weight(self, body: Described) -> Array:
        """Return the weights (n,) of coordinates in error norms: lengths by which a unit of each moves the inertia."""
        return np.ones(self.coordinates(body))

    def stable_step(self, body: Described) -> float:
        """Return the largest step [s] with which the explicit method is stable on the free body."""
        return math.inf

    def rigid_motions(self, q: Array) -> Array:
        """Return the rates (3, n) of coordinates in rigid motions at unit speed: along x, along y, about the origin.

        By default, each pair of coordinates is a point.
        """
        along = np.resize([1.0, 0.0], q.size)
        return np.stack([along, 1.0 - along, np.stack([-q[1::2], q[0::2]], axis=1).ravel()])

    @abstractmethod
    def centreline(self, row: Any, q: Array, points_per_element: int) -> Array:
        """Return the points (..., k, 2) [m] along the body's axis from its coordinates (..., n), for pictures."""
