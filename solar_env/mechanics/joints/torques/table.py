"""Torques that are tabulated by angle: springs of any characteristic, and harnesses.

A monotone piecewise cubic interpolates the table (F. N. Fritsch and J. Butland, SIAM J. Sci. Stat. Comput. 5 (1984)
300, doi:10.1137/0905021), as SciPy's PCHIP does. Beyond the table's ends the torque continues along straight lines. The
cubic is a sum of truncated powers: a line, plus a square and a cube from each knot on. It needs no search.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator

from solar_env.mechanics.arrays.model import TABLE_ROWS
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.vectors import where_less


def compile_table(points: tuple[tuple[float, float], ...]) -> NDArray[np.float64]:
    """Return truncated-power coefficients (TABLE_ROWS, 3) of the curve through points (angle [rad], torque [N m]).

    Row 0 holds the line (first angle, torque, slope); each other row holds a knot (angle, factors of square and cube).
    """
    compiled = np.zeros((TABLE_ROWS, 3))
    if len(points) == 1:
        compiled[0] = 0.0, points[0][1], 0.0
    elif points:
        angles, torques = np.array(points, dtype=np.float64).T
        curve = PchipInterpolator(angles, torques)
        ends = curve(angles, 1)
        cubes, squares = np.append(curve.c[0], 0.0), np.append(curve.c[1], 0.0)
        compiled[0] = angles[0], torques[0], ends[0]
        # Each knot has its polynomial minus the previous polynomial, which continues.
        steps = np.diff(angles, prepend=angles[0])
        before = np.concatenate([[0.0], cubes[:-1]])
        compiled[1 : len(points) + 1, 0] = angles
        compiled[1 : len(points) + 1, 1] = squares - np.concatenate([[0.0], squares[:-1]]) - 3.0 * before * steps
        compiled[1 : len(points) + 1, 2] = cubes - before
    return compiled


@kernel(inlined=False)
def table_torque(table, points, angle):
    """Return the torque [N m] at an angle [rad] and its slope [N m/rad] from a compiled `table` of `points` knots."""
    torque, slope = table[0, 1] + table[0, 2] * (angle - table[0, 0]), table[0, 2] + 0.0 * angle
    for k in range(1, points + 1 if points > 1 else 1):
        beyond = angle - table[k, 0]
        inside = where_less(0.0, beyond, beyond, 0.0)
        torque = torque + inside * inside * (table[k, 1] + table[k, 2] * inside)
        slope = slope + inside * (2.0 * table[k, 1] + 3.0 * table[k, 2] * inside)
    return torque, slope


def steepest_slope(points: tuple[tuple[float, float], ...]) -> float:
    """Return the greatest slope magnitude [N m/rad] of the curve through points (angle [rad], torque [N m])."""
    if len(points) < 2:
        return 0.0
    angles = np.linspace(points[0][0], points[-1][0], 500)
    return float(np.abs(PchipInterpolator(*np.array(points).T)(angles, 1)).max())


@kernel(inlined=False)
def table_energy(table, points, angle):
    """Return a tabulated torque's potential energy [J] at an angle [rad], zero at the first of its `points` knots."""
    beyond = angle - table[0, 0]
    energy = -beyond * (table[0, 1] + 0.5 * table[0, 2] * beyond)
    for k in range(1, points + 1 if points > 1 else 1):
        inside = max(angle - table[k, 0], 0.0)
        energy -= inside**3 * (table[k, 1] / 3.0 + 0.25 * table[k, 2] * inside)
    return energy
