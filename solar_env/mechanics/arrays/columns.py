"""Columns of the joint tables, and `TORQUES`, the table of all torque laws at a hinge.

A `TORQUES` entry names a torque and the energies that the torque stores, supplies or dissipates. Integrals, energies,
trajectories, files and torque sums are derived from these entries. The compiled torque laws are in `joints/torques`.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.arrays import model as m

# Columns of a joint's motion, the first ones of every joint table.
ECCENTRICITY_X, ECCENTRICITY_Y, ANGLE, RATE, OUTBOARD_SPIN, INBOARD_SPIN = range(6)
SHARED_COLUMNS = 6
# Further columns of the joint-load table, written by every evaluation of the forces; torque columns are adjacent.
NORMAL, TANGENTIAL, FORCE_X, FORCE_Y = range(6, 10)
SPRING_TORQUE, CABLE_TORQUE, LATCH_TORQUE, MOTOR_TORQUE, HARNESS_TORQUE, DAMPING_TORQUE, HINGE_FRICTION_TORQUE = range(
    10, 17
)
LOAD_COLUMNS = 17


class TorqueLaw(NamedTuple):
    """A torque law at a hinge; its torque [N m] acts on the joint angle.

    Attributes:
        name: the torque's name in trajectories.
        column: the torque's column in the joint-load table.
        energy: name of the energy that the torque stores; empty if it stores no energy.
        book: name of the energy that the torque supplies or dissipates; empty if neither.
        integral: column of the energy `book` among a joint's time integrals; -1 if `book` is empty.
        lost: whether the energy `book` is dissipated; otherwise it is supplied.
    """

    name: str
    column: int
    energy: str = ""
    book: str = ""
    integral: int = -1
    lost: bool = False


# All torque laws in the order of their columns, which is also the order of summation.
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
    """Return the hinge torque [N m] (...,), summed over all torque laws, from joint-load tables (..., LOAD_COLUMNS)."""
    return np.asarray(loads[..., FIRST_TORQUE:END_OF_TORQUES].sum(axis=-1))
