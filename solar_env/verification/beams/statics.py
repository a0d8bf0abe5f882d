"""Cases of beams at rest under loads: large deflections of a cantilever, and a beam that hangs."""

import cmath
import math
from collections.abc import Iterator

import numpy as np

from solar_env.mechanics.analysis.linearization import static_equilibrium
from solar_env.mechanics.mechanism.beams import PANEL, Beam, cantilever
from solar_env.mechanics.mechanism.description import Mechanism
from solar_env.verification.beams import theory
from solar_env.verification.beams.fields import flexible_body, nodes
from solar_env.verification.checks import Check, compare

HANGING = "exact: rho A g L^2 / (2 E A), a quadratic field, which the element contains"
LOADS = (0.5, 1.0, 2.0, 5.0)
NEWTON = 1e-9  # relative to the length: end of the iteration
ELASTICA = "K. E. Bisshopp and D. C. Drucker, Q. Appl. Math. 3 (1945) 272"
EXTENSIBLE = "extensible elastica by shooting, SciPy's DOP853 at rtol 1e-12"


def solve_tip(mechanism: Mechanism, load_steps: int = 10) -> tuple[complex, float]:
    """Place x + i y [m] and direction [rad], from -pi to pi, of the tip at equilibrium."""
    places, slopes = nodes(flexible_body(mechanism), np.asarray(static_equilibrium(mechanism, load_steps=load_steps)))
    return complex(places[-1]), cmath.phase(complex(slopes[-1]))


def tip_load() -> Iterator[Check]:
    """A cantilever under a transverse dead load at its tip: so slender that it does not stretch, and a panel."""
    # Slenderness E A L^2 / (E I) = 1e6; stretch changes the figures by some load / 1e6.
    slender, elements = Beam(length=1.0, linear_density=1.0, axial_stiffness=1e6, bending_stiffness=1.0), 40
    names = ("deflection w / L", "shortening u / L", "tip angle [rad]")
    for load in LOADS:
        place, angle = solve_tip(cantilever(slender, elements, (0.0, load)))
        bound = abs(theory.element_deflection_error(load, slender.axial_stiffness, elements))
        figures = zip(names, theory.tip_load_elastica(load), (place.imag, 1.0 - place.real, angle), strict=True)
        quantity = f"P L^2 / (E I) = {load:g}: {{}}, {elements} elements"
        yield from compare(figures, quantity, 2.0 * bound + 4.0 * load / slender.axial_stiffness, ELASTICA)
    beam, elements = PANEL, 16
    slenderness = beam.axial_stiffness * beam.length**2 / beam.bending_stiffness
    for load in LOADS:
        force = load * beam.bending_stiffness / beam.length**2
        exact, exact_angle = theory.deflected_tip(beam, 1j * force)
        place, angle = solve_tip(cantilever(beam, elements, (0.0, force)))
        bound = abs(theory.element_deflection_error(load, slenderness, elements))
        panel_figures = (
            (exact.imag / beam.length, place.imag / beam.length, 1.1),
            (1.0 - exact.real / beam.length, 1.0 - place.real / beam.length, 2.0),
            (exact_angle, angle, 2.0),
        )
        for name, (expected, value, factor) in zip(names, panel_figures, strict=True):
            # The leading error of the deflection, which overestimates strong locking.
            quantity = f"panel, P L^2 / (E I) = {load:g}: {name}, {elements} elements"
            yield Check(quantity, expected, value, factor * bound + NEWTON, EXTENSIBLE)


def tip_moment() -> Iterator[Check]:
    """A cantilever that a tip moment rolls up, to a full circle."""
    beam, elements = PANEL, 16
    for turns, name in ((0.25, "quarter"), (0.5, "half"), (1.0, "full")):
        turn = 2.0 * math.pi * turns
        mechanism = cantilever(beam, elements, tip_torque=turn * beam.bending_stiffness / beam.length)
        place, angle = solve_tip(mechanism, load_steps=20)
        x, y = theory.tip_moment_circle(turn)
        missing = turn * (turn / elements) ** 4 / 240.0
        figures = (
            ("x / L of the tip", x, place.real / beam.length),
            ("y / L of the tip", y, place.imag / beam.length),
            ("turn of the tip [rad]", turn, angle + 2.0 * math.pi * round((turn - angle) / (2.0 * math.pi))),
        )
        yield from compare(
            figures,
            f"{name} circle: {{}}, {elements} elements",
            tolerance=1.1 * missing + NEWTON,
            source="exact: circular arc; elements miss E I h^4 kappa^6 / 1440 and turn less by (kappa h)^4 / 240",
        )


def own_weight() -> Iterator[Check]:
    """A beam that hangs, and a cantilever that droops, under their own weight."""
    elements, gravity = 4, 9.81
    beam = Beam(length=2.0, linear_density=3.0, axial_stiffness=500.0, bending_stiffness=20.0)
    hanging, _ = solve_tip(cantilever(beam, elements, angle=-math.pi / 2, gravity=(0.0, -gravity)))
    obtained = -hanging.imag - beam.length
    quantity = "hanging beam: extension [m]"
    tolerance = NEWTON * beam.length
    expected = beam.linear_density * gravity * beam.length**2 / (2.0 * beam.axial_stiffness)
    yield Check(quantity, expected, obtained, tolerance, HANGING)
    elements = 16
    exact, _ = theory.deflected_tip(beam, line_load=-1j * beam.linear_density * gravity)
    drooping, _ = solve_tip(cantilever(beam, elements, gravity=(0.0, -gravity)))
    turn = 0.5 * beam.linear_density * gravity * beam.length**3 / beam.bending_stiffness  # of linear theory, times 3
    bound = beam.length * turn**3 / (384.0 * elements**4)  # h^4 max |r''''| / 384, cubic interpolation
    figures = (("x", exact.real, drooping.real), ("y", exact.imag, drooping.imag))
    yield from compare(figures, f"drooping beam: {{}} of the tip [m], {elements} elements", bound, EXTENSIBLE)
