"""The plan of the array: its joints as rows, which say what bodies they join and where they lock."""

import math
from dataclasses import dataclass

MAIN_BODY = 0  # index among the bodies of the mechanism


@dataclass(frozen=True)
class JointRow:
    """A joint, and the panel that it carries.

    Attributes:
        index: among the joints, from the root on.
        inboard: index of the body that bears it, among those of the mechanism.
        panel: index of the panel that it carries, likewise.
        sign: 1 if the panel opens counter-clockwise, -1 if clockwise.
        lock_angle: at which it latches, from the folded position [rad].
    """

    index: int
    inboard: int
    panel: int
    sign: int
    lock_angle: float

    @property
    def name(self) -> str:
        """The joint as tables name it."""
        return f"joint {self.index + 1}"


def chain(panels: int) -> tuple[JointRow, ...]:
    """Rows of a chain of panels, folded like an accordion: the root opens by a quarter turn, the others by half one."""
    return tuple(
        JointRow(k, MAIN_BODY + k, MAIN_BODY + k + 1, 1 if k % 2 == 0 else -1, math.pi if k else math.pi / 2)
        for k in range(panels)
    )
