"""Mass, forces, energies and constraints of any body: each function calls its counterpart for the body's kind.

Fixed bodies of every kind have zero accelerations, and add nothing to mass matrix and kinetic energy.
"""

from solar_env.mechanics.bodies import natural_coordinates
from solar_env.mechanics.bodies.cable_element import element, forces
from solar_env.mechanics.bodies.kinds import CABLE_ELEMENTS
from solar_env.mechanics.numerics.jit import kernel


@kernel
def _hold(body, a):
    """Set the body's entries of the accelerations `a` (n,) to zero."""
    for i in range(body.offset, body.offset + body.coordinates):
        a[i] = 0.0


@kernel
def solve_body(body, constants, q, v, force, a, with_velocity):
    """Write a body's accelerations under `force` (n,), without joints, to `a` (n,), and return a Lagrange multiplier.

    The multiplier keeps the distance of a rigid body's two base points constant; it is 0 for beams and fixed bodies.
    `with_velocity` is 1, or 0 to omit velocity terms: `a` is then linear in `force`.
    """
    if body.fixed:
        _hold(body, a)
        return 0.0
    if body.kind == CABLE_ELEMENTS:
        element.solve_mass(body, constants, force, a)
        return 0.0
    return natural_coordinates.solve_body(body, q, v, force, a, with_velocity)


@kernel
def solve_free(body, constants, force, a):
    """Write M^-1 `force` of a body to `a` (n,); ignore joints and the fixed distance of a rigid body's base points."""
    if body.fixed:
        _hold(body, a)
    elif body.kind == CABLE_ELEMENTS:
        element.solve_mass(body, constants, force, a)
    else:
        natural_coordinates.solve_mass(body, force, a)


@kernel
def add_mass_product(body, constants, a, out):
    """Add a body's mass matrix times the accelerations `a` (n,) to `out` (n,); `constants`: beams' mass matrices."""
    if body.fixed:
        return
    if body.kind == CABLE_ELEMENTS:
        element.add_mass_product(body, constants, a, out)
    else:
        natural_coordinates.add_mass_product(body, a, out)


@kernel
def add_mass_matrix(body, constants, elimination, matrix):
    """Add the mass matrix of a body that is not fixed to the sparse matrix `matrix` (`ProfileMatrix`).

    The array `constants` stores beams' mass matrices; `elimination` gives each coordinate's place in `matrix`.
    """
    if body.fixed:
        return
    if body.kind == CABLE_ELEMENTS:
        element.add_mass_matrix(body, constants, 1.0, elimination, matrix)
    else:
        natural_coordinates.add_body_matrix(body, 1.0, 0.0, elimination, matrix)


@kernel
def kinetic_energy(body, constants, v):
    """Return the kinetic energy [J] of a body from the velocities `v` (n,); a fixed body has zero."""
    if body.fixed:
        return 0.0
    if body.kind == CABLE_ELEMENTS:
        return element.kinetic_energy(body, constants, v)
    return natural_coordinates.kinetic_energy(body, v)


@kernel(inlined=False)
def elastic_energy(bodies, q):
    """Return the total strain energy [J] of all bodies at the coordinates `q` (n,)."""
    total = 0.0
    for body in bodies:
        if body.kind == CABLE_ELEMENTS:
            total = forces.add_elastic_energy(body, q, total)
    return total


@kernel
def add_internal_forces(model, q, v, force, element_table):
    """Add internal forces of all bodies to `force` (n,), using scratch `element_table`; return damping power [W]."""
    # Without beams the call alone would take several percent of an evaluation.
    if model.cable_elements.filled.size == 0:
        return 0.0
    return forces.add_elastic_forces(model.cable_elements, q, v, force, element_table)


@kernel
def project_bodies(bodies, q, v):
    """Project each body's `q` and `v` in place onto its own constraint, by the least change in the mass metric."""
    for b in range(bodies.size):
        body = bodies[b]
        if body.constraints:
            natural_coordinates.project_length(body, q, v)
