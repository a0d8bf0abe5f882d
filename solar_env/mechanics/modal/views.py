"""What controllers and pictures see of rigid bodies and modal panels: joints, and the axes of the bodies."""

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.bodies.beam_modes import RESIDUAL_BLOCKS, slope_factor, wave_number
from solar_env.mechanics.equations.formulation import Array, JointView
from solar_env.mechanics.modal.arrays import RIGID_BODY, ModalModel
from solar_env.mechanics.numerics.jit import kernel

# Parts of a panel's axis, each with as many points as an element of a beam.
_PARTS = 8


@kernel(inner=True)
def attachment_place(model, q, v, number):
    """Place (x, y) [m] of an attachment, angle [rad] and spin [rad/s] of the body there."""
    attachment, panels = model.attachments[number], model.panels
    body = model.bodies[attachment.body]
    x, y, first = attachment.x, attachment.y, body.offset
    turn, spin = q[first + 2], v[first + 2]
    c, s = math.cos(turn), math.sin(turn)
    if body.panel != RIGID_BODY:
        d, end = body.design, attachment.end
        along, across = panels.axial_rows[d, end], panels.bending_rows[d, 2 * end]
        slope, shortening = panels.bending_rows[d, 2 * end + 1], panels.ends[d, end]
        axial, middle = first + 3, first + 3 + along.size
        for k in range(along.size):
            x += along[k] * q[axial + k]
        for k in range(across.size):
            y += across[k] * q[middle + k]
            turn += slope[k] * q[middle + k]
            spin += slope[k] * v[middle + k]
        for r in range(shortening.shape[0]):
            for k in range(shortening.shape[1]):
                x += 0.5 * shortening[r, k] * q[middle + r] * q[middle + k]
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
    axial, modes = panels.axial_frequency.shape[1], panels.bending_frequency.shape[1]
    a, b = amplitudes[..., :axial], amplitudes[..., axial : axial + modes]
    kept, stretched = modes - 4 * RESIDUAL_BLOCKS, axial - 2 * RESIDUAL_BLOCKS
    coupled = b[..., : panels.ends.shape[2]]
    ends = a[..., stretched:] @ panels.axial_rows[d, :, stretched:].T
    ends = ends + 0.5 * np.einsum("eij,...i,...j->...e", panels.ends[d], coupled, coupled)
    s = np.linspace(0.0, 1.0, points)
    cubic = np.stack([1.0 - 3.0 * s**2 + 2.0 * s**3, length * (s - 2.0 * s**2 + s**3)])
    cubic = np.concatenate([cubic, [1.0 - cubic[0], length * (s**3 - s**2)]])
    unit = 1.0 / math.sqrt(row["mass"])
    along = unit * a[..., :stretched] @ _axial_shapes(stretched, points) + ends @ np.stack([1.0 - s, s])
    across = unit * b[..., :kept] @ _bending_shapes(kept, points)
    across = across + b[..., kept:] @ panels.bending_rows[d, :, kept:].T @ cubic
    return (s - 0.5) * length + along + 1j * across


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
