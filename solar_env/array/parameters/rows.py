"""A joint and a panel of the array, as the mechanism is built of them."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, TypeVar

Value = TypeVar("Value")


def entry_of(entries: Sequence[Value], joint: int, panels: int) -> Value:
    """Return the entry for a joint of a wing of so many panels: the last one holds for all further ones.

    Both wings take the same entries, unless there are more of them than panels.
    """
    place = joint % panels if len(entries) <= panels else joint
    return entries[min(place, len(entries) - 1)]


@dataclass(frozen=True)
class JointRow:
    """A joint, by its index from the root on, and the panel that it carries.

    Attributes:
        inboard, panel: indices, among the bodies of the mechanism, of what bears it and of the panel.
        side: 1 for the wing towards +x, -1 for its mirror image towards -x.
        sign: 1 if the panel opens counter-clockwise, -1 if clockwise.
        fold_angle: from the folded position to the one in line with what bears it [rad].
        lock_angle: at which it latches or stops, from the folded position [rad].
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
        """The joint as tables name it."""
        return f"joint {self.index + 1}{' of the second wing' if self.side < 0 else ''}"


class PanelRow(NamedTuple):
    """A panel, by its index from the root on.

    Attributes:
        length, thickness: [m].
        linear_density: mass per length [kg/m].
        axial_stiffness: E A [N].
        bending_stiffness: E I [N m2].
        damping: retardation time of the material [s].
        masses: places from the inner hinge [m] and masses [kg] of what is fixed to it.
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
        """Mass, with what is fixed to the panel [kg]."""
        return self.linear_density * self.length + sum(mass for _, mass in self.masses)

    @property
    def centroid(self) -> float:
        """Distance of the centre of mass from the inner hinge [m]."""
        first = sum(mass * (place - self.length / 2) for place, mass in self.masses)
        return self.length / 2 + first / self.mass

    @property
    def inertia(self) -> float:
        """Moment of inertia about the centre of mass [kg m2]."""
        bare = self.linear_density * self.length
        own = bare * (self.length**2 + self.thickness**2) / 12.0
        moved = sum(mass * (place - self.centroid) ** 2 for place, mass in self.masses)
        return own + bare * (self.centroid - self.length / 2) ** 2 + moved
