"""Descriptions of the array's joints and panels, from which the mechanism is built."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, TypeVar

Value = TypeVar("Value")


def entry_of(entries: Sequence[Value], joint: int, panels: int) -> Value:
    """Return the entry for `joint` from a sequence by joint; joints beyond its end take the last entry.

    Joints count from 0, wing after wing; each wing has `panels` joints. Both wings take the same entries, unless there
    are more entries than `panels`.
    """
    place = joint % panels if len(entries) <= panels else joint
    return entries[min(place, len(entries) - 1)]


@dataclass(frozen=True)
class JointRow:
    """A joint and the panel that the joint carries; `index` counts joints from 0 at the root, wing after wing.

    Attributes:
        inboard, panel: indices of two bodies of the mechanism: the body on the joint's inner side, and the panel.
        side: 1 for the wing towards +x, -1 for its mirror image towards -x.
        sign: 1 if the panel opens counter-clockwise, -1 if clockwise.
        fold_angle: angle from the folded position to the position in line with the inboard body [rad].
        lock_angle: angle from the folded position at which the joint latches or stops [rad].
    """

    index: int
    inboard: int
    panel: int
    side: int
    sign: int
    fold_angle: float
    lock_angle: float

    @property
    def name(self) -> str:
        """Name of the joint for tables and messages, such as "joint 1"."""
        return f"joint {self.index + 1}{' of the second wing' if self.side < 0 else ''}"


class PanelRow(NamedTuple):
    """Geometry, mass and stiffness of a panel.

    Attributes:
        length, thickness: length and thickness of the panel [m].
        linear_density: mass per length [kg/m].
        axial_stiffness: E A [N].
        bending_stiffness: E I [N m2].
        damping: retardation time of the panel's material [s].
        masses: fittings on the panel, as pairs of distance from the inner hinge [m] and mass [kg].
    """

    length: float
    thickness: float
    linear_density: float
    axial_stiffness: float
    bending_stiffness: float
    damping: float
    masses: tuple[tuple[float, float], ...] = ()

    @property
    def mass(self) -> float:
        """Mass of the panel with its fittings [kg]."""
        return self.linear_density * self.length + sum(mass for _, mass in self.masses)

    @property
    def centroid(self) -> float:
        """Distance of the panel's centre of mass, with fittings, from the inner hinge [m]."""
        first = sum(mass * (place - self.length / 2) for place, mass in self.masses)
        return self.length / 2 + first / self.mass

    @property
    def inertia(self) -> float:
        """Moment of inertia of the panel, with fittings, about its centre of mass [kg m2]."""
        bare = self.linear_density * self.length
        own = bare * (self.length**2 + self.thickness**2) / 12.0
        moved = sum(mass * (place - self.centroid) ** 2 for place, mass in self.masses)
        return own + bare * (self.centroid - self.length / 2) ** 2 + moved
