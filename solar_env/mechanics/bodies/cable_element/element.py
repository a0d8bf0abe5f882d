"""Planar beams of cable elements in the absolute nodal coordinate formulation (ANCF).

Every node has a position r and a slope r' = dr/ds, both in inertial axes, and the centreline is a cubic polynomial
between nodes (J. L. Escalona, H. A. Hussien and A. A. Shabana, J. Sound Vib. 214 (1998) 833,
doi:10.1006/jsvi.1998.1563; Li et al. 2019, Eqs 16-30). The mass matrix is constant and banded. The strains are the
extension eps = |r'| - 1 and the turn of the tangent per undeformed length, kappa = (r' x r'') / |r'|^2 (J. Gerstmayr
and H. Irschik, J. Sound Vib. 318 (2008) 461, doi:10.1016/j.jsv.2008.04.019: other curvature measures couple stretch and
bending falsely). Material damping is proportional to the strain rates, so that rigid rotation is not damped.
"""

import math
from collections.abc import Iterable
from typing import Any, ClassVar

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from solar_env.mechanics.arrays.model import Elements
from solar_env.mechanics.bodies.cable_element import matrices
from solar_env.mechanics.bodies.cable_element.forces import LANES
from solar_env.mechanics.bodies.cable_element.matrices import MASS_BAND
from solar_env.mechanics.bodies.description import AnyBody, FlexibleBody, Point
from solar_env.mechanics.bodies.kind import Array, BodyKind, Fields
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.profile import add_entry


class CableElements(BodyKind[FlexibleBody]):
    """Body kind "flexible beam of equal cable elements"; an instance turns descriptions of such beams into arrays."""

    description = FlexibleBody
    body_fields: ClassVar[Fields] = [
        ("elements", np.int64),
        ("element_length", np.float64),
        ("axial_stiffness", np.float64),
        ("bending_stiffness", np.float64),
        ("damping", np.float64),
        ("mass_band", np.int64),  # index of the mass matrix in the body constants, in rows of MASS_BAND entries
        ("mass_factor", np.int64),  # index of the mass matrix's factors in the body constants
    ]
    deformable = True

    def coordinates(self, body: FlexibleBody) -> int:
        """Return the number of coordinates, four for each node: two of its position and two of its slope."""
        return 4 * (body.elements + 1)

    def fill(self, body: FlexibleBody, row: np.void, constants: list[float]) -> None:
        """Write a beam's lengths, stiffness and damping to `row`; append mass matrix and its factors to `constants`."""
        for name in ("length", "elements", "element_length", "axial_stiffness", "bending_stiffness", "damping"):
            row[name] = getattr(body, name)
        mass = matrices.mass_matrix(body.elements, body.element_length, body.linear_density)
        for place, lumped in body.masses:
            shape = matrices.shape_at(body.elements, body.element_length, place)
            mass += lumped * np.outer(shape, shape)
        for name, band in (("mass_band", matrices.lower_band(mass)), ("mass_factor", matrices.factor_band(mass))):
            row[name] = len(constants)
            constants += band.ravel().tolist()

    def fill_marker(self, body: FlexibleBody, row: np.void, first: int, point: Point) -> None:
        """Write marker `row` for the node at `point`, directed along its slope; `first`: body's first index in q."""
        node = first + 4 * body.node(point)
        row["i1"], row["i2"], row["a1"] = node, node + 2, 1.0

    def initial_motion(self, body: FlexibleBody) -> tuple[Array, Array]:
        """Return the coordinates (n,) and velocities (n,) of a beam at t = 0, when it is straight and unstrained."""
        c, s = math.cos(body.angle), math.sin(body.angle)
        motion = []
        for start, slope in ((body.position, (c, s)), (body.velocity, (-s * body.spin, c * body.spin))):
            nodes = np.empty((body.elements + 1, 4))
            nodes[:, :2] = np.array(start) + np.outer(np.linspace(0.0, body.length, body.elements + 1), slope)
            nodes[:, 2:] = slope
            motion.append(nodes.ravel())
        return motion[0], motion[1]

    def weight(self, body: FlexibleBody, gravity: Point) -> Array:
        """Return the gravity force (n,): shape-function integrals times weight per length, plus lumped weights."""
        step = body.element_length
        mass = body.linear_density * step
        force = np.zeros(self.coordinates(body))
        for e in range(body.elements):
            for k, share in enumerate((0.5, step / 12.0, 0.5, -step / 12.0)):
                for axis in range(2):
                    force[4 * e + 2 * k + axis] += mass * share * gravity[axis]
        for place, lumped in body.masses:
            shape = matrices.shape_at(body.elements, step, place)
            force += lumped * np.outer(shape, gravity).ravel()
        return force

    def error_weight(self, body: FlexibleBody) -> Array:
        """Return error-norm factors (n,) that turn coordinates into lengths: 1 for positions, a length for slopes."""
        # A slope times this length [m] has the same diagonal entry in the element's mass matrix as a position.
        slope = math.sqrt(4.0 / 156.0) * body.length / body.elements
        return np.tile([1.0, 1.0, slope, slope], body.elements + 1)

    def stable_step(self, body: FlexibleBody) -> float:
        """Return the largest step [s] for which explicit Runge-Kutta is stable on the free straight beam."""
        stiffness = body.axial_stiffness, body.bending_stiffness
        return matrices.stable_step(body.elements, body.element_length, body.linear_density, *stiffness, body.damping)

    def rigid_motions(self, q: Array) -> Array:
        """Return coordinate rates (3, n) of unit-speed motion along x and y (slopes fixed), and about the origin."""
        motions = super().rigid_motions(q)
        motions[:2, 2::4] = motions[:2, 3::4] = 0.0
        return motions

    def centreline(self, row: Any, q: Array, points_per_element: int) -> Array:
        """Return equally spaced points (..., k, 2) [m] on the cubic elements, shared nodes once; `row`: beam record."""
        elements = int(row["elements"])
        nodes = q.reshape(*q.shape[:-1], elements + 1, 2, 2)
        places = np.arange(elements + 1) * float(row["element_length"])
        curve = CubicHermiteSpline(places, nodes[..., 0, :], nodes[..., 1, :], axis=-2)
        return np.asarray(curve(np.linspace(0.0, places[-1], elements * points_per_element + 1)))


def element_blocks(bodies: Iterable[tuple[int, AnyBody]]) -> Elements:
    """Return the beams' elements in blocks of LANES; `bodies` yields pairs (index of first coordinate, body)."""
    rows = [
        (
            first + 4 * e,
            1.0 / body.element_length,
            body.axial_stiffness * body.element_length,
            body.bending_stiffness / body.element_length,
            body.damping,
        )
        for first, body in bodies
        if isinstance(body, FlexibleBody)
        for e in range(body.elements)
    ]
    blocks = -(-len(rows) // LANES)
    offset = np.full((blocks, LANES), rows[0][0] if rows else 0, dtype=np.int64)
    inverse_length = np.ones((blocks, LANES))
    constants = np.zeros((blocks, 3, LANES))
    filled = np.zeros(blocks, dtype=np.int64)
    for i, row in enumerate(rows):
        block, lane = divmod(i, LANES)
        offset[block, lane], inverse_length[block, lane] = row[0], row[1]
        constants[block, :, lane] = row[2:]
        filled[block] = lane + 1
    return Elements(offset, inverse_length, constants.reshape(blocks, 3 * LANES), filled)


@kernel(inlined=False)
def add_mass_product(body, constants, a, out):
    """Add the mass matrix of beam `body`, which `constants` stores, times the accelerations `a` (n,) to `out` (n,)."""
    rows = body.coordinates // 2
    for i in range(rows):
        x = body.offset + 2 * i
        weight = constants[body.mass_band + MASS_BAND * i + MASS_BAND - 1]
        out[x] += weight * a[x]
        out[x + 1] += weight * a[x + 1]
        for k in range(max(0, MASS_BAND - 1 - i), MASS_BAND - 1):
            weight = constants[body.mass_band + MASS_BAND * i + k]
            z = x - 2 * (MASS_BAND - 1 - k)
            out[x] += weight * a[z]
            out[x + 1] += weight * a[z + 1]
            out[z] += weight * a[x]
            out[z + 1] += weight * a[x + 1]


@kernel(inlined=False)
def solve_mass(body, constants, force, a):
    """Write M^-1 times a beam's generalized `force` to `a` (n,), using the stored factors of the banded M."""
    rows, first = body.coordinates // 2, body.mass_factor
    fx, fy, gx, gy, hx, hy = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(rows):
        k = body.offset + 2 * i
        f = first + MASS_BAND * i
        l0, l1, l2 = constants[f], constants[f + 1], constants[f + 2]
        x = force[k] - l0 * fx - l1 * gx - l2 * hx
        y = force[k + 1] - l0 * fy - l1 * gy - l2 * hy
        a[k], a[k + 1] = x, y
        fx, fy, gx, gy, hx, hy = gx, gy, hx, hy, x, y
    # Solutions h, g, f of the first, second and third row after row i, and the factors l, m, n of these rows.
    fx, fy, gx, gy, hx, hy = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    l0, l1, l2, m0, m1, n0 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(rows - 1, -1, -1):
        k = body.offset + 2 * i
        f = first + MASS_BAND * i
        inverse = constants[f + 3]
        x = a[k] * inverse - l2 * hx - m1 * gx - n0 * fx
        y = a[k + 1] * inverse - l2 * hy - m1 * gy - n0 * fy
        a[k], a[k + 1] = x, y
        fx, fy, gx, gy, hx, hy = gx, gy, hx, hy, x, y
        n0, m0, m1 = m0, l0, l1
        l0, l1, l2 = constants[f], constants[f + 1], constants[f + 2]


@kernel(inlined=False)
def kinetic_energy(body, constants, v):
    """Return a beam's kinetic energy [J] from the mechanism's velocities `v` (n,); `constants` has mass matrices."""
    total = 0.0
    for i in range(body.coordinates // 2):
        x = body.offset + 2 * i
        weight = 0.5 * constants[body.mass_band + MASS_BAND * i + MASS_BAND - 1]
        total += weight * (v[x] * v[x] + v[x + 1] * v[x + 1])
        for k in range(max(0, MASS_BAND - 1 - i), MASS_BAND - 1):
            z = x - 2 * (MASS_BAND - 1 - k)
            total += constants[body.mass_band + MASS_BAND * i + k] * (v[x] * v[z] + v[x + 1] * v[z + 1])
    return total


@kernel(inlined=False)
def add_mass_matrix(body, constants, weight, elimination, matrix):
    """Add `weight` times the mass matrix of the beam `body` to the sparse matrix `matrix` (`ProfileMatrix`).

    The array `constants` stores all beams' mass matrices; `elimination` gives each coordinate's place in `matrix`.
    """
    for i in range(body.coordinates // 2):
        for k in range(max(0, MASS_BAND - 1 - i), MASS_BAND):
            j = i - (MASS_BAND - 1) + k
            value = weight * constants[body.mass_band + MASS_BAND * i + k]
            for axis in range(2):
                row, column = body.offset + 2 * i + axis, body.offset + 2 * j + axis
                add_entry(elimination, matrix, row, column, value)
                if row != column:
                    add_entry(elimination, matrix, column, row, value)
