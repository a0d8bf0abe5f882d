"""Mass, forces, energies and constraints of a body by its kind: every function here calls the kind's.

Fixed bodies, whatever their kind, have neither inertia nor accelerations.
"""

from solar_env.mechanics.bodies import natural_coordinates
from solar_env.mechanics.bodies.cable_element import element, forces
from solar_env.mechanics.bodies.kinds import CABLE_ELEMENTS
from solar_env.mechanics.numerics.jit import kernel


@kernel
def _hold(body, a):
    """Set the body's accelerations to zero."""
    for i in range(body.offset, body.offset + body.coordinates):
        a[i] = 0.0


@kernel
def solve_body(body, constants, q, v, force, a, with_velocity):
    """Write to `a` the accelerations of a body alone under a generalized `force`; return its multiplier.

    With `with_velocity` zero, not one, terms by velocities are left out, which makes the map linear.
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
    """Write to `a` the body's M^-1 force: its accelerations if its constraint did not act."""
    if body.fixed:
        _hold(body, a)
    elif body.kind == CABLE_ELEMENTS:
        element.solve_mass(body, constants, force, a)
    else:
        natural_coordinates.solve_mass(body, force, a)


@kernel
def add_mass_product(body, constants, a, out):
    """Add the body's M a to `out` (n,)."""
    if body.fixed:
        return
    if body.kind == CABLE_ELEMENTS:
        element.add_mass_product(body, constants, a, out)
    else:
        natural_coordinates.add_mass_product(body, a, out)


@kernel
def add_mass_matrix(body, constants, elimination, matrix):
    """Add the body's mass matrix to `matrix`, which lies in a profile."""
    if body.fixed:
        return
    if body.kind == CABLE_ELEMENTS:
        element.add_mass_matrix(body, constants, 1.0, elimination, matrix)
    else:
        natural_coordinates.add_body_matrix(body, 1.0, 0.0, elimination, matrix)


@kernel
def kinetic_energy(body, constants, v):
    """Return the kinetic energy [J] of the body."""
    if body.fixed:
        return 0.0
    if body.kind == CABLE_ELEMENTS:
        return element.kinetic_energy(body, constants, v)
    return natural_coordinates.kinetic_energy(body, v)


@kernel(inlined=False)
def elastic_energy(bodies, q):
    """Return the strain energy [J] of all bodies."""
    total = 0.0
    for body in bodies:
        if body.kind == CABLE_ELEMENTS:
            total = forces.add_elastic_energy(body, q, total)
    return total


@kernel
def add_internal_forces(model, q, v, force, element_table):
    """Add the internal forces of all bodies to `force` (n,); return the power [W] that their damping takes."""
    # Without beams the call alone would take several percent of an evaluation.
    if model.cable_elements.filled.size == 0:
        return 0.0
    return forces.add_elastic_forces(model.cable_elements, q, v, force, element_table)


@kernel
def project_bodies(bodies, q, v):
    """Move every body back to its constraint, and its velocity to the rate's, by the least change in mass metric."""
    for b in range(bodies.size):
        body = bodies[b]
        if body.constraints:
            natural_coordinates.project_length(body, q, v)
