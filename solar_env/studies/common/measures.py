"""Errors of a run against a reference: angles, latch times and peak forces."""

import math

import numpy as np

from solar_env.studies.common.motion import Motion


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
    right = reference.totals["peak_force_N"]
    errors = np.abs(motion.totals["peak_force_N"] / np.where(right > 0.0, right, math.nan) - 1.0)
    return math.nan if np.isnan(errors).all() else float(np.nanmax(errors))
