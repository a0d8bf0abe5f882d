"""Matrix of Newton's equations, [[a M + b C + c K, Phi_q^T], [Phi_q, 0]], assembled from its parts.

Mass M, damping C and stiffness K share one profile (`profile.py`), so that a weighted sum takes one pass over their
entries. A change of step size changes only the weights a, b and c, and needs no new tangents.
"""

from typing import NamedTuple

from solar_env.mechanics.arrays.model import Model
from solar_env.mechanics.bodies.dispatch import add_mass_matrix
from solar_env.mechanics.bodies.natural_coordinates import add_body_matrix, add_length_border
from solar_env.mechanics.equations.system import Workspace
from solar_env.mechanics.equations.tangent import TangentScratch, fill_tangents, make_tangent_scratch
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.profile import ProfileMatrix, add_entry, make_profile_matrix


class NewtonMatrices(NamedTuple):
    """Mass, stiffness and damping parts of Newton's matrix, and the matrix itself or its factors."""

    mass: ProfileMatrix  # constant
    stiffness: ProfileMatrix  # negative derivative of the applied forces by coordinates
    damping: ProfileMatrix  # negative derivative of the applied forces by velocities
    matrix: ProfileMatrix
    tangent: TangentScratch


def make_newton_matrices(model: Model, work: Workspace) -> NewtonMatrices:
    """Allocate `NewtonMatrices` and fill in the mass matrix; damping, stiffness and Newton's matrix are still empty."""
    mass = make_profile_matrix(model.elimination)
    fill_mass(model, mass)
    return NewtonMatrices(
        mass=mass,
        stiffness=make_profile_matrix(model.elimination),
        damping=make_profile_matrix(model.elimination),
        matrix=make_profile_matrix(model.elimination),
        tangent=make_tangent_scratch(work),
    )


@kernel(inlined=False)
def fill_mass(model, matrix):
    """Add the mass matrices of all bodies to the profile matrix `matrix`."""
    for b in range(model.bodies.size):
        add_mass_matrix(model.bodies[b], model.body_constants, model.elimination, matrix)


@kernel(inlined=False)
def linearize_forces(model, joint_states, q, v, newton):
    """Compute stiffness and damping in `newton` at `q`, `v`; call `applied_forces` there first, for the joint loads."""
    fill_tangents(model, joint_states, q, v, newton.tangent, newton.stiffness, newton.damping)


@kernel
def _weighted_sum(mass, damping, stiffness, weights, out):
    """Write the weighted sum of three arrays (blocks, 16) to a fourth array `out`."""
    a, b, c = weights
    for i in range(out.shape[0]):
        for k in range(out.shape[1]):
            out[i, k] = a * mass[i, k] + b * damping[i, k] + c * stiffness[i, k]


@kernel(inlined=False)
def assemble(model, q, multipliers, row_value, newton, weights):
    """Write the sum a M + b C + c K, bordered by the constraints' gradients, to `newton.matrix`.

    M, C and K are mass, damping and stiffness in `newton`, and `weights` is (a, b, c). `row_value` has the gradients of
    the linear constraints. The length constraints' Hessians times their `multipliers` are added to K.
    """
    elimination, constraints, matrix = model.elimination, model.constraints, newton.matrix
    mass, damping, stiffness = newton.mass, newton.damping, newton.stiffness
    _weighted_sum(mass.diagonal, damping.diagonal, stiffness.diagonal, weights, matrix.diagonal)
    _weighted_sum(mass.lower, damping.lower, stiffness.lower, weights, matrix.lower)
    _weighted_sum(mass.upper, damping.upper, stiffness.upper, weights, matrix.upper)
    n, m = q.size, constraints.size.size
    for r in range(m):
        for k in range(constraints.size[r]):
            i, value = constraints.coordinate[r, k], row_value[r, k]
            add_entry(elimination, matrix, n + r, i, value)
            add_entry(elimination, matrix, i, n + r, value)
    for body_index in range(model.bodies.size):
        body = model.bodies[body_index]
        if body.constraints:
            add_body_matrix(body, 0.0, weights[2] * multipliers[m + body_index], elimination, matrix)
            add_length_border(body, q, n + m + body_index, elimination, matrix)
