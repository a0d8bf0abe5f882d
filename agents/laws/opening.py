"""The opening of the array as one quantity, which several laws control."""

import math

import numpy as np

from agents.torque_laws import Entries

LOCK_ANGLES = (math.pi / 2, math.pi)
"""Lock angles of joint 1, and of those further out [rad]."""
OPENING = ("theta_1", "theta_2", "rate_1", "rate_2")
"""Entries that the opening is made of."""


def lock_angle(joint: int) -> float:
    """Return the lock angle [rad] of a joint, counted from 0."""
    return LOCK_ANGLES[min(joint, 1)]


def weighted_opening(entries: Entries, joint_2_weight: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the weighted opening of both joints in units of their lock angles, its rate and the difference of rates.

    The rates, the second that of joint 1 minus that of joint 2, are in 1/s; all are (n,). Joint 1 has the other weight.
    """
    rate_1, rate_2 = (entries[f"rate_{i + 1}"] / LOCK_ANGLES[i] for i in range(2))
    opening = entries["theta_1"] + joint_2_weight * (entries["theta_2"] - entries["theta_1"])
    return opening, rate_1 + joint_2_weight * (rate_2 - rate_1), rate_1 - rate_2
