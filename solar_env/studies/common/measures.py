"""Errors of a run against a reference: angles, latch times, and impacts up to the horizon of prediction."""

import math

import numpy as np
from numpy.typing import NDArray

from solar_env.studies.common.motion import Motion

# Two references tell the same impact if it starts and peaks alike within these.
SAME_START, SAME_FORCE = 1e-5, 1e-2  # s, relative
# A method has predicted an impact if the peak force is that of the reference within this share.
PREDICTED = 1e-2
# Errors are taken over so many first impacts of a joint.
FIRST = 3


def angle_error(motion: Motion, reference: Motion, until: float) -> float:
    """Greatest difference of a joint angle [rad] at the common samples of a motion and its reference up to a time [s].

    Raises:
        ValueError: if the samples lie at other times.
    """
    if motion.time.shape != reference.time.shape or not np.allclose(motion.time, reference.time, rtol=0.0, atol=1e-9):
        raise ValueError("the samples of the two motions lie at different times")
    counted = reference.time <= until + 1e-9
    return float(np.abs(motion.angles - reference.angles)[counted].max())


def latch_error(motion: Motion, reference: Motion) -> float:
    """Greatest difference of a latch time [s]; inf if a joint that should have latched has not, nan if none should."""
    expected = np.isfinite(reference.latch_times)
    if not expected.any():
        return math.nan
    differences = np.abs(motion.latch_times - reference.latch_times)[expected]
    return float(np.where(np.isnan(differences), math.inf, differences).max())


def force_error(motion: Motion, reference: Motion) -> float:
    """Greatest relative error of a joint's peak force after the first latching; nan where the reference has none."""
    right = reference.totals["peak_force"]
    errors = np.abs(motion.totals["peak_force"] / np.where(right > 0.0, right, math.nan) - 1.0)
    return math.nan if np.isnan(errors).all() else float(np.nanmax(errors))


def impacts_of(motion: Motion, joint: int) -> NDArray[np.void]:
    """Contacts of one joint in the order of their starts."""
    return motion.contacts[motion.contacts["joint"] == joint]


def horizon(first: Motion, second: Motion) -> tuple[int, ...]:
    """By joint, how many first impacts two references tell alike: beyond, the motion is unpredictable for them."""
    return tuple(_alike(first, second, joint) for joint in range(len(first.latch_times)))


def _alike(first: Motion, second: Motion, joint: int) -> int:
    a, b = impacts_of(first, joint), impacts_of(second, joint)
    count = min(len(a), len(b))
    a, b = a[:count], b[:count]
    same = np.abs(a["start_s"] - b["start_s"]) <= SAME_START
    same &= np.abs(a["peak_force"] - b["peak_force"]) <= SAME_FORCE * b["peak_force"]
    return int(np.argmin(same)) if not same.all() else count


def compared_impacts(counts: tuple[int, ...]) -> tuple[int, ...]:
    """How many impacts of each joint errors are taken over, out of those within the horizon.

    Errors grow from impact to impact: over the first few, a quarter of the way to the horizon at most, a reference
    still has most of its digits, and a method with fewer has not lost all of them.
    """
    return tuple(min(math.ceil(count / 4), FIRST) for count in counts)


def impact_errors(motion: Motion, reference: Motion, counts: tuple[int, ...]) -> tuple[float, float]:
    """Greatest error of the start [s] and of the peak force (relative) over the first impacts of every joint.

    `counts` tells by joint how many; both errors are inf if the run has fewer.
    """
    start, force = 0.0, 0.0
    for joint, count in enumerate(counts):
        own, right = impacts_of(motion, joint)[:count], impacts_of(reference, joint)[:count]
        if len(own) < len(right):
            return math.inf, math.inf
        if len(right) > 0:
            start = max(start, float(np.abs(own["start_s"] - right["start_s"]).max()))
            force = max(force, float(np.abs(own["peak_force"] / right["peak_force"] - 1.0).max()))
    return start, force


def predicted_impacts(motion: Motion, reference: Motion, counts: tuple[int, ...]) -> int:
    """How many first impacts of all joints, at most `counts` by joint, have the right peak force within PREDICTED."""
    total = 0
    for joint, count in enumerate(counts):
        own, right = impacts_of(motion, joint)[:count], impacts_of(reference, joint)[:count]
        both = min(len(own), len(right))
        own, right = own[:both], right[:both]
        wrong = np.abs(own["peak_force"] - right["peak_force"]) > PREDICTED * right["peak_force"]
        total += int(np.argmax(wrong)) if wrong.any() else both
    return total
