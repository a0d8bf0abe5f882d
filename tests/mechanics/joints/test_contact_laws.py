"""The contact laws: every row of the table alike, then what is each one's own."""

from __future__ import annotations

import math
from dataclasses import replace
from decimal import Decimal, localcontext

import numpy as np
import pytest
from scipy.integrate import quad

from solar_env.mechanics.equations.build import compile_mechanism
from solar_env.mechanics.integrators.settings import GeneralizedAlpha, Integrator, RungeKutta
from solar_env.mechanics.joints.contact import (
    contact_energy,
    impact_scales,
    normal_force,
)
from solar_env.mechanics.joints.laws import (
    CONTACT_LAWS,
    PowerLaw,
    Surfaces,
    contact_law,
    cylinder,
    exact_damping,
    flores_damping,
    lankarani_damping,
    sphere,
)
from solar_env.mechanics.mechanism.description import Bearing
from solar_env.mechanics.mechanism.textbook import bouncing_block
from solar_env.mechanics.running.simulation import simulate

# A steel journal in a brass bearing.
SURFACES = Surfaces(
    bearing_radius=0.0102,
    journal_radius=0.0100,
    length=1.0,
    bearing_young=105e9,
    bearing_poisson=0.34,
    journal_young=207e9,
    journal_poisson=0.3,
    bracket_stiffness=1e7,
)
MASS, SPEED, CLEARANCE = 6.0, 0.05, 2e-4
EXPLICIT_AND_IMPLICIT: tuple[Integrator, ...] = (RungeKutta(), GeneralizedAlpha(step=2e-6))
EVERY_LAW = pytest.mark.parametrize("name", CONTACT_LAWS)
EVERY_RESTITUTION = pytest.mark.parametrize("coefficient", [0.1, 0.9, 1.0])


def row(law: PowerLaw) -> np.record:
    """Row of the model for a joint with a contact law."""
    return compile_mechanism(bouncing_block(Bearing(CLEARANCE, 0.01, law)))[0].joints[0]


@EVERY_LAW
@EVERY_RESTITUTION
def test_the_compiled_force_is_that_of_the_law_and_rises_from_zero_without_a_jump(
    name: str, coefficient: float
) -> None:
    law = contact_law(name, SURFACES, coefficient)
    joint = row(law)
    for depth in (0.0, -1e-12):
        assert normal_force(joint, depth, SPEED, SPEED) == (0.0, 0.0, 0.0, 0.0)
        assert contact_energy(joint, depth) == 0.0
    assert normal_force(joint, 1e-20, SPEED, SPEED)[0] < 1e-8
    for depth in (1e-9, 1e-6, 1e-4):
        assert contact_energy(joint, depth) == pytest.approx(law.energy(law.parameters(), depth), rel=1e-14)
        for rate in (-2.0 * SPEED, -0.5 * SPEED, 0.0, SPEED):
            expected = law.stiffness * depth**law.exponent * max(1.0 + law.damping * rate / SPEED, 0.0)
            assert normal_force(joint, depth, rate, SPEED)[0] == pytest.approx(expected, rel=1e-13)
    expected = law.impact_scales(law.parameters(), 1.0 / MASS, SPEED)
    assert impact_scales(joint, 1.0 / MASS, SPEED) == pytest.approx(expected, rel=1e-14)


def test_a_linear_contact_has_no_slope_before_it_touches() -> None:
    joint = row(PowerLaw(1e10, 1.0))
    assert normal_force(joint, 0.0, SPEED, SPEED) == (0.0, 0.0, 0.0, 0.0)
    assert normal_force(joint, 1e-12, 0.0, SPEED)[2] == pytest.approx(1e10, rel=1e-14)


@EVERY_LAW
@EVERY_RESTITUTION
def test_the_force_never_attracts_and_its_elastic_part_is_the_force_at_rest(name: str, coefficient: float) -> None:
    law = contact_law(name, SURFACES, coefficient)
    for depth in (1e-9, 1e-6, 1e-4):
        for rate in np.linspace(-50.0, 1.0, 103):
            force, elastic, by_depth, by_rate = normal_force(row(law), depth, rate, SPEED)
            assert min(force, by_depth, by_rate) >= 0.0
            assert elastic == normal_force(row(law), depth, 0.0, SPEED)[0] > 0.0
        assert law.depth_under(elastic) == pytest.approx(depth, rel=1e-14)


def test_a_damped_force_its_slopes_and_its_energy_by_hand() -> None:
    # 2 N/m^1.5 times 4^1.5 = 8 is 16 N; damping adds half the ratio of rate and impact speed, 0.25 of it.
    law = PowerLaw(2.0, 1.5, damping=0.5)
    assert normal_force(row(law), 4.0, 0.3, 0.6) == pytest.approx((20.0, 16.0, 7.5, 16.0 * 0.5 / 0.6), rel=1e-14)
    assert law.energy(law.parameters(), 4.0) == pytest.approx(2.0 * 4.0**2.5 / 2.5, rel=1e-14)
    # With the exponent 2: 2 N/m^2 times 16, and slopes of 2 times 2 times 4.
    law = PowerLaw(2.0, 2.0, damping=0.5)
    assert normal_force(row(law), 4.0, 0.3, 0.6) == pytest.approx((40.0, 32.0, 20.0, 32.0 * 0.5 / 0.6), rel=1e-14)
    assert law.energy(law.parameters(), 4.0) == pytest.approx(2.0 * 4.0**3 / 3.0, rel=1e-14)


@pytest.mark.parametrize("rate", [-1.2, -1.3, -100.0])
def test_surfaces_that_part_faster_than_the_damping_lets_them_feel_no_force(rate: float) -> None:
    # The force would turn round at a rate of minus the impact speed over the damping factor.
    assert normal_force(row(PowerLaw(2.0, 1.5, damping=0.5)), 4.0, rate, 0.6) == (0.0, 16.0, 0.0, 0.0)


@EVERY_LAW
@EVERY_RESTITUTION
def test_the_slopes_are_those_of_the_force(name: str, coefficient: float) -> None:
    law = contact_law(name, SURFACES, coefficient)

    def force(depth: float, rate: float) -> float:
        return normal_force(row(law), depth, rate, SPEED)[0]

    for depth in (1e-9, 1e-6, 1e-4):
        for rate in (-0.02, 0.0, 0.05):
            _, _, by_depth, by_rate = normal_force(row(law), depth, rate, SPEED)
            # Truncation (h / depth)^2 / 24 and rounding eps depth / h are both below 1e-10 with h = 1e-5 depth.
            h = 1e-5 * depth
            difference = (force(depth + h, rate) - force(depth - h, rate)) / (2 * h)
            assert by_depth == pytest.approx(difference, rel=1e-9, abs=1e-9)
            difference = (force(depth, rate + 1e-5) - force(depth, rate - 1e-5)) / 2e-5
            assert by_rate == pytest.approx(difference, rel=1e-8, abs=1e-8 * force(depth, rate))


@EVERY_LAW
def test_the_stored_energy_is_the_work_against_the_elastic_force(name: str) -> None:
    law = contact_law(name, SURFACES, 0.5)
    for depth in (1e-8, 1e-4):
        work, _ = quad(lambda x: normal_force(row(law), x, 0.0, SPEED)[1], 0.0, depth, epsrel=1e-12)
        assert law.energy(law.parameters(), depth) == pytest.approx(work, rel=1e-9)


@EVERY_LAW
@EVERY_RESTITUTION
@pytest.mark.parametrize("integrator", EXPLICIT_AND_IMPLICIT, ids=lambda integrator: integrator.name)
def test_a_block_leaves_the_wall_with_the_speed_that_the_law_claims(
    name: str, coefficient: float, integrator: Integrator
) -> None:
    law = contact_law(name, SURFACES, coefficient)
    # Time for the slowest of bounces, and too little for the far wall.
    run = simulate(
        bouncing_block(Bearing(CLEARANCE, 0.01, law), MASS, SPEED), 2.5 * CLEARANCE / SPEED, integrator=integrator
    )
    assert run.contact_starts[0] == 1
    assert -run.velocities[-1, 0] / SPEED == pytest.approx(law.exit_speed_ratio(), rel=5e-3)


# Those of a block in flight, which are rounding; that of the contact is none of them.
@pytest.mark.filterwarnings("ignore:.*the constraint forces of the integrator are off")
@EVERY_LAW
@pytest.mark.parametrize("integrator", EXPLICIT_AND_IMPLICIT, ids=lambda integrator: integrator.name)
def test_an_undamped_impact_is_as_deep_and_as_long_as_the_law_predicts(name: str, integrator: Integrator) -> None:
    law = contact_law(name, SURFACES, 1.0)
    depth, duration = law.impact_scales(law.parameters(), 1.0 / MASS, SPEED)
    if isinstance(integrator, GeneralizedAlpha):
        integrator = GeneralizedAlpha(step=duration / 200.0)
    assert law.energy(law.parameters(), depth) == pytest.approx(0.5 * MASS * SPEED**2, rel=1e-13)
    block = bouncing_block(Bearing(CLEARANCE, 0.01, law), MASS, SPEED)
    end = CLEARANCE / SPEED + 2.0 * duration
    run = simulate(block, end, integrator=integrator, output_step=duration / 1000)
    assert run.penetration.max() == pytest.approx(depth, rel=2e-4)
    assert run.contacts["end_s"][0] - run.contacts["start_s"][0] == pytest.approx(duration, rel=1e-3)


def test_an_unknown_law_and_a_restitution_outside_its_range_are_refused() -> None:
    with pytest.raises(ValueError, match=r"'dubowsky' is unknown; choose from lankarani-nikravesh, .*hertz"):
        contact_law("dubowsky", SURFACES, 0.9)
    for name in CONTACT_LAWS:
        for coefficient in (0.0, -0.1, 1.0001, math.nan, math.inf):
            with pytest.raises(ValueError, match=f"restitution = {coefficient!r}"):
                contact_law(name, SURFACES, coefficient)


@pytest.mark.parametrize("exponent", [1.0, 1.2, 1.5, 2.0])
def test_the_duration_of_an_impact_is_its_quadrature(exponent: float) -> None:
    law = PowerLaw(7e10, exponent)
    depth, duration = law.impact_scales(law.parameters(), 0.4, 0.03)
    # Duration = 2 integral d(depth) / rate, with x = 1 - y^2 to take out the singularity at the turning point.
    integral, _ = quad(lambda y: 4.0 * y / math.sqrt(1.0 - (1.0 - y * y) ** (exponent + 1.0)), 0.0, 1.0)
    assert duration == pytest.approx(integral * depth / 0.03, rel=1e-7)
    if exponent == 1.0:
        # Half a period of a linear spring.
        assert duration == pytest.approx(math.pi / math.sqrt(7e10 * 0.4), rel=1e-14)


@pytest.mark.parametrize("damping", [1e-9, 1e-5, 0.1, 0.75, 1.0, 5.0, 160.0, 1e5])
def test_the_exit_speed_solves_the_separated_equation(damping: float) -> None:
    e = PowerLaw(1.0, damping=damping).exit_speed_ratio()
    assert 0.0 < e <= min(1.0, 1.0 / damping)
    if damping < 10.0:
        left, right = damping * (1.0 + e), math.log1p(damping) - math.log1p(-damping * e)
        assert left == pytest.approx(right, rel=1e-9)


def between(damping: float, ratio: float, shift: float) -> bool:
    """Whether the separated equation holds for an exit speed within `shift` of a ratio.

    To sixty digits, in which the terms of its power series that cancel cannot hide the root.
    """
    with localcontext(prec=60):
        factor, defects = Decimal(damping), []
        for asked in (Decimal(ratio) - Decimal(shift), Decimal(ratio) + Decimal(shift)):
            room = 1 - factor * asked
            # Beyond a pole the defect is infinite.
            defects.append((1 + factor).ln() - room.ln() - factor * (1 + asked) if room > 0 else Decimal("inf"))
        return defects[0] < 0 < defects[1]


@pytest.mark.parametrize("damping", [1e-4, 2.9e-4])
def test_the_exit_speed_of_a_slight_damping_is_right_to_ten_digits(damping: float) -> None:
    assert between(damping, PowerLaw(1.0, damping=damping).exit_speed_ratio(), 5e-11)


def test_damping_factors_are_those_of_the_named_laws() -> None:
    assert contact_law("hertz", SURFACES, 0.3).damping == 0.0
    assert lankarani_damping(0.9) == pytest.approx(0.75 * 0.19, rel=1e-14)
    assert flores_damping(0.5) == pytest.approx(8.0 * 0.5 / (5.0 * 0.5), rel=1e-14)


@pytest.mark.parametrize("e", [1e-3, 0.1, 0.5, 0.9, 0.99, 0.9995, 0.9999, 0.9999999])
def test_the_law_of_exact_restitution_gives_what_it_is_asked_for(e: float) -> None:
    d = exact_damping(e)
    assert PowerLaw(1.0, damping=d).exit_speed_ratio() == pytest.approx(e, abs=1e-9)
    assert between(d, e, 1e-9)


def test_eq_40_gives_the_stiffness_of_steel_in_brass() -> None:
    # The figure is known to three digits.
    assert sphere(SURFACES, 0.0).stiffness == pytest.approx(7.43e10, abs=0.005e10)
    assert sphere(replace(SURFACES, stiffness=5e10), 0.0).stiffness == 5e10


def test_eq_40_stiffens_as_the_clearance_shrinks() -> None:
    wide, narrow = (sphere(replace(SURFACES, bearing_radius=0.01 + c), 0.0).stiffness for c in (2e-4, 5e-5))
    # Proportional to sqrt(R_b R_j / c).
    assert narrow / wide == pytest.approx(math.sqrt(4.0 * 0.01005 / 0.0102), rel=1e-12)


@pytest.mark.parametrize("clearance", [2e-5, 5e-5, 1e-4, 2e-4, 5e-4, 1e-3])
@pytest.mark.parametrize("load", [1e4, 1e5])
def test_the_cylinders_law_fits_johnsons_line_contact(clearance: float, load: float) -> None:
    """Johnson, Contact Mechanics, 1985: depth = f / (pi E*) (ln(4 pi E* c / f) - 1) at a load of f [N/m]."""
    law = cylinder(replace(SURFACES, bearing_radius=0.01 + clearance), 1.0)
    modulus = 1.0 / SURFACES.compliance
    depth = load / (math.pi * modulus) * (math.log(4.0 * math.pi * modulus * clearance / load) - 1.0)
    # As close as the fit is.
    assert normal_force(row(law), depth, 0.0, SPEED)[0] / load == pytest.approx(1.0, abs=0.15)


def test_the_cylinders_law_is_continuous_in_the_clearance_and_proportional_to_the_length() -> None:
    below, above = (cylinder(replace(SURFACES, bearing_radius=0.01 + c), 0.9) for c in (3.4953e-4, 3.4955e-4))
    assert above.exponent == pytest.approx(below.exponent, rel=1e-4)
    assert above.stiffness == pytest.approx(below.stiffness, rel=1e-3)
    whole, half = (cylinder(replace(SURFACES, length=length), 0.9) for length in (1.0, 0.5))
    assert whole.stiffness == pytest.approx(2.0 * half.stiffness, rel=1e-14)
    # By hand: Y = 1.51 ln(200)^-0.151 = 1.17390, n = Y 0.2^-0.005 = 1.18339.
    assert whole.exponent == pytest.approx(1.18339, abs=1e-5)


def test_the_cylinders_force_at_a_depth_of_one_millimetre_is_the_factor_of_the_formula() -> None:
    # One to whatever power is one: (0.965 c + 0.0965) L E* / c in N, mm and MPa, with c = 0.2 mm and L = 1 m.
    law = cylinder(SURFACES, 1.0)
    expected = (0.965 * 0.2 + 0.0965) * 1000.0 * (1e-6 / SURFACES.compliance) / 0.2
    assert normal_force(row(law), 1e-3, 0.0, SPEED)[0] == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"bearing_radius": 0.01}, "journal radius 0.01 must be positive and below the bearing's 0.01"),
        ({"journal_radius": -0.01}, "journal radius -0.01"),
        ({"journal_radius": 0.0}, "journal radius 0.0"),
        ({"journal_radius": math.nan}, "journal radius nan"),
        ({"bearing_young": 0.0}, "moduli must be positive, got 0.0"),
        ({"journal_young": -1.0}, "moduli must be positive, got .* and -1.0"),
        # The cylinders' law was not fitted to these.
        ({"bearing_radius": 0.01 + 4.9e-6}, "clearance = 4.9e-06 m is outside the range .* 5e-06 to 0.01 m"),
        ({"bearing_radius": 0.0201}, "clearance = 0.0101 m is outside"),
        ({"stiffness": 7e10}, "contact_stiffness = 70000000000.0 holds for spheres"),
    ],
)
def test_surfaces_that_do_not_fit_are_refused(changes: dict[str, float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        contact_law("pereira", replace(SURFACES, **changes), 0.9)


def test_the_law_of_brackets_takes_their_stiffness_and_no_other() -> None:
    assert contact_law("bracket", SURFACES, 0.5).exit_speed_ratio() == pytest.approx(0.5, abs=1e-10)
    with pytest.raises(ValueError, match="bracket_stiffness = None must"):
        contact_law("bracket", replace(SURFACES, bracket_stiffness=None), 0.9)
    with pytest.raises(ValueError, match=r"contact_stiffness = 70000000000.0 .*takes None, and bracket_stiffness"):
        contact_law("bracket", replace(SURFACES, stiffness=7e10), 0.9)
