"""Joints and axes of bodies, of rigid bodies and modal panels, as controllers and pictures see them."""

import itertools
import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.bodies.beam_modes import slope_factor, wave_number
from solar_env.mechanics.equations.formulation import Array, JointView
from solar_env.mechanics.modal.arrays import RIGID_BODY, ModalModel
from solar_env.mechanics.modal.panel.tables import (
    AXIAL_EVEN,
    AXIAL_ODD,
    BENDING_EVEN,
    EVEN_ENDS,
    GROUPS,
    ODD_ENDS,
    VALUES,
    side,
)
from solar_env.mechanics.numerics.jit import kernel

# Parts of a panel's axis, each with as many points as an element of a beam.
_PARTS = 8


@kernel(inner=True)
def coupled_coordinate(panels, d, group, r, q):
    """Coordinate `r` of a bending group that foreshortening couples, from a panel's amplitudes."""
    first, coupled = panels.first[group], panels.coupled[group]
    if r < coupled:
        return q[first + r]
    value = 0.0
    for k in range(first + coupled, panels.first[group + 1]):
        value += panels.modes[d, k].row[r - coupled] * q[k]
    return value


@kernel(inner=True)
def attachment_place(model, q, v, number):
    """Place (x, y) [m] of an attachment, angle [rad] and spin [rad/s] of the body there."""
    attachment, panels = model.attachments[number], model.panels
    body = model.bodies[attachment.body]
    x, y, first = attachment.x, attachment.y, body.offset
    turn, spin = q[first + 2], v[first + 2]
    c, s = math.cos(turn), math.sin(turn)
    if body.panel != RIGID_BODY:
        d, first_mode, forms, odd = body.design, first + 3, panels.forms[body.design], side(attachment.end)
        for group in range(GROUPS):
            sign = 1.0 if group in (BENDING_EVEN, AXIAL_EVEN) else odd
            for k in range(panels.first[group], panels.first[group + 1]):
                value = sign * panels.modes[d, k].row[0] * q[first_mode + k]
                if group < AXIAL_EVEN:
                    y += value
                    # A slope is odd where the deflection is even.
                    turn += sign * odd * panels.modes[d, k].row[1] * q[first_mode + k]
                    spin += sign * odd * panels.modes[d, k].row[1] * v[first_mode + k]
                else:
                    x += value
        for group in range(2):
            for partner in range(2):
                form, sign = (ODD_ENDS, odd) if partner == group else (EVEN_ENDS, 1.0)
                for r in range(panels.coupled[group] + VALUES):
                    own = coupled_coordinate(panels, d, group, r, q[first_mode:])
                    for k in range(panels.coupled[partner] + VALUES):
                        other = coupled_coordinate(panels, d, partner, k, q[first_mode:])
                        x += 0.5 * sign * forms[group, r, k, form] * own * other
    return q[first] + c * x - s * y, q[first + 1] + s * x + c * y, turn, spin


@kernel(inlined=True)
def view_joint(model, state, j):
    """The joint `j` as a controller may observe it."""
    joint = model.joints[j]
    ox, oy, outboard, outboard_spin = attachment_place(model, state.q, state.v, joint.outboard)
    ix, iy, inboard, inboard_spin = attachment_place(model, state.q, state.v, joint.inboard)
    angle = joint.sign * (outboard - inboard - model.folded_angle[j])
    rate = joint.sign * (outboard_spin - inboard_spin)
    return JointView(angle, rate, math.atan2(math.sin(inboard), math.cos(inboard)), inboard_spin, ox - ix, oy - iy)


def modal_centreline(model: ModalModel, q: Array, body: int, points_per_part: int) -> Array:
    """Points (..., k, 2) [m] along the axis of a body from the coordinates (..., n), as `centreline` gives them.

    On a panel k is 8 * points_per_part + 1. The kept modes enter with their shapes; what the pseudo-modes and
    foreshortening add is exact at the ends, and a cubic and a linear polynomial between them.
    """
    row = model.bodies[body]
    first = int(row["offset"])
    if row["panel"] == RIGID_BODY:
        local = np.array([0.0j, row["length"]]) - complex(row["centroid_x"], row["centroid_y"])
    else:
        local = _panel_axis(model, row, q[..., first + 3 :], _PARTS * points_per_part + 1)
    centre, turn = q[..., first, None] + 1j * q[..., first + 1, None], np.exp(1j * q[..., first + 2, None])
    line = centre + turn * local
    return np.stack([line.real, line.imag], axis=-1)


def _panel_axis(model: ModalModel, row: np.void, amplitudes: Array, points: int) -> NDArray[np.complex128]:
    """Points of a panel's axis in its frame."""
    panels, d, length = model.panels, row["design"], row["length"]
    groups = [amplitudes[..., start:stop] for start, stop in itertools.pairwise(panels.first)]
    kept = panels.kept
    rows = [panels.rows[d, start:stop] for start, stop in itertools.pairwise(panels.first)]
    # Values of the first end by the pseudo-modes of each group, and by foreshortening.
    rest = [group[..., k:] @ row[k:] for group, k, row in zip(groups, kept, rows, strict=True)]
    low = [
        np.concatenate([groups[g][..., :k], groups[g][..., k:] @ rows[g][k:]], axis=-1)
        for g, k in enumerate(panels.coupled[:2])
    ]
    for g in range(2):
        for partner, form, axial in ((g, ODD_ENDS, AXIAL_ODD), (1 - g, EVEN_ENDS, AXIAL_EVEN)):
            block = panels.forms[d, g, : low[g].shape[-1], : low[partner].shape[-1], form]
            rest[axial][..., 0] += 0.5 * np.einsum("ij,...i,...j->...", block, low[g], low[partner])
    (w, slope), (odd_w, odd_slope) = (np.moveaxis(value, -1, 0) for value in rest[:2])
    u, odd_u = rest[AXIAL_EVEN][..., 0], rest[AXIAL_ODD][..., 0]
    ends = np.stack([w + odd_w, odd_slope + slope, w - odd_w, odd_slope - slope], axis=-1)
    s = np.linspace(0.0, 1.0, points)
    cubic = np.stack([1.0 - 3.0 * s**2 + 2.0 * s**3, length * (s - 2.0 * s**2 + s**3)])
    cubic = np.concatenate([cubic, [1.0 - cubic[0], length * (s**3 - s**2)]])
    unit = 1.0 / math.sqrt(row["mass"])
    # The lowest axial mode is odd, the lowest bending mode even.
    stretched, bent = _axial_shapes(kept[2] + kept[3], points), _bending_shapes(kept[0] + kept[1], points)
    along = unit * (groups[2][..., : kept[2]] @ stretched[1::2] + groups[3][..., : kept[3]] @ stretched[::2])
    along = along + np.stack([u + odd_u, u - odd_u], axis=-1) @ np.stack([1.0 - s, s])
    across = unit * (groups[0][..., : kept[0]] @ bent[::2] + groups[1][..., : kept[1]] @ bent[1::2])
    return (s - 0.5) * length + along + 1j * (across + ends @ cubic)


@lru_cache(maxsize=16)
def _axial_shapes(modes: int, points: int) -> Array:
    """(modes, points) axial modes of a free bar of unit mass at equal distances."""
    numbers = np.arange(1, modes + 1)[:, None]
    return math.sqrt(2.0) * np.cos(numbers * math.pi * np.linspace(0.0, 1.0, points))


@lru_cache(maxsize=16)
def _bending_shapes(modes: int, points: int) -> Array:
    """(modes, points) bending modes of a free beam of unit mass at equal distances."""
    share = np.linspace(0.0, 1.0, points)
    # The second half mirrors the first: growing exponentials would lose all digits there.
    near, far = np.minimum(share, 1.0 - share), share > 0.5
    shapes = np.zeros((modes, points))
    for k in range(modes):
        number = wave_number(k + 1)
        factor = slope_factor(number)
        sigma, z = float(factor), float(number) * near
        shape = 0.5 * float(1 - factor) * np.exp(z) + 0.5 * (1.0 + sigma) * np.exp(-z) + np.cos(z) - sigma * np.sin(z)
        shapes[k] = np.where(far, (-1.0) ** k * shape, shape)
    return shapes
