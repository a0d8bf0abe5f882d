"""Curves of cost against error, which all figures of the room have."""

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from solar_env.pictures.style import Look
from solar_env.studies.common.drawing import use_decades
from solar_env.studies.common.tables import Table

ERRORS = {
    "angle_error_rad": "error of angles before the latch [rad]",
    "latch_error_s": "error of latch times [s]",
}


def positive_points(x: NDArray[np.float64], y: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The points that logarithmic axes can show, in their order."""
    shown = np.isfinite(x) & np.isfinite(y) & (x > 0.0) & (y > 0.0)
    return x[shown], y[shown]


def draw_curves(axis: Axes, rows: Table, error: str, cost: str, looks: Mapping[str, Look], by: str = "method") -> None:
    """A column of costs against one of errors, a curve for each value of the column `by`, on logarithmic axes."""
    axis.set(xscale="log", yscale="log")
    for name in rows.values(by):
        own = rows.where(**{by: name})
        axis.plot(*positive_points(own.column(error), own.column(cost)), markersize=4, **looks[str(name)])
    use_decades(axis, "x")
    use_decades(axis, "y")
