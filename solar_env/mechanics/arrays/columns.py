"""Columns of the tables of joints, and the laws of the torques about a hinge, a row each.

A row of `TORQUES` has the torque's name, the energy that it stores, and the energy that it puts in or loses. Integrals,
energies, trajectories, files and sums of torques follow from the rows. The compiled laws are in `joints/torques`.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.arrays import model as m

# A joint's motion: the first columns of every table of joints.
ECCENTRICITY_X, ECCENTRICITY_Y, ANGLE, RATE, OUTBOARD_SPIN, INBOARD_SPIN = range(6)
SHARED_COLUMNS = 6
# Behind them, in the table of joint loads that one evaluation fills; the torques stand side by side.
NORMAL, TANGENTIAL, FORCE_X, FORCE_Y = range(6, 10)
SPRING_TORQUE, CABLE_TORQUE, LATCH_TORQUE, MOTOR_TORQUE, HARNESS_TORQUE, DAMPING_TORQUE, HINGE_FRICTION_TORQUE = range(
    10, 17
)
LOAD_COLUMNS = 17


class TorqueLaw(NamedTuple):
    """A torque about a hinge, on the joint's angle [N m].

    Attributes:
        name: the torque's name in trajectories.
        column: the torque's column in the table of loads.
        energy: name of the energy that it stores; empty if it stores nothing.
        book: name of the energy that it puts in or loses; empty if neither.
        integral: column of `book` among a joint's integrals.
        lost: whether `book` is lost; else it is put in.
    """

    name: str
    column: int
    energy: str = ""
    book: str = ""
    integral: int = -1
    lost: bool = False


# In the order of their columns, in which they are added.
TORQUES = (
    TorqueLaw("spring_torque", SPRING_TORQUE, energy="spring"),
    TorqueLaw("cable_torque", CABLE_TORQUE, energy="cable", book="cable_work", integral=m.CABLE_WORK),
    TorqueLaw(
        "latch_torque", LATCH_TORQUE, energy="latch", book="latch_dissipation", integral=m.LATCH_DISSIPATION, lost=True
    ),
    TorqueLaw("motor_torque", MOTOR_TORQUE, book="motor_work", integral=m.MOTOR_WORK),
    TorqueLaw("harness_torque", HARNESS_TORQUE, energy="harness"),
    TorqueLaw("damping_torque", DAMPING_TORQUE, book="damper_dissipation", integral=m.DAMPER_DISSIPATION, lost=True),
    TorqueLaw(
        "hinge_friction_torque",
        HINGE_FRICTION_TORQUE,
        book="hinge_friction_dissipation",
        integral=m.HINGE_FRICTION_DISSIPATION,
        lost=True,
    ),
)
FIRST_TORQUE, END_OF_TORQUES = TORQUES[0].column, TORQUES[-1].column + 1


def total_torque(loads: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the sum of the torques [N m] of all laws in tables of loads (..., columns)."""
    return np.asarray(loads[..., FIRST_TORQUE:END_OF_TORQUES].sum(axis=-1))
