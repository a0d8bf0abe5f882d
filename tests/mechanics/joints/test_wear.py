"""Archard wear by circumferential bin: the worn volume is booked exactly, where the surfaces press."""

from __future__ import annotations

import math

import numpy as np
import pytest

from solar_env.array import ArrayParameters, build
from solar_env.mechanics.integrators.settings import ModalRadau, RungeKutta
from solar_env.mechanics.joints.laws import PowerLaw
from solar_env.mechanics.joints.wear import add_wear, pressed_half_angle
from solar_env.mechanics.mechanism.description import GROUND, Bearing, Body, Joint, Mechanism
from solar_env.mechanics.running.simulation import simulate
from solar_env.mechanics.running.trajectory import Trajectory


def worn(
    bins: int, angle: float, pressed: float, moved: float = 0.0, section: float = 1.0, radius: float = 1.0
) -> np.ndarray:
    depths = np.zeros(bins)
    add_wear(depths, angle, pressed, moved, section, radius)
    return depths


@pytest.mark.parametrize("bins", [1, 2, 3, 17, 360])
@pytest.mark.parametrize("half_angle", [0.0, 1e-12, 1e-4, 0.02, 0.5, math.pi / 2, 3.0, 4.0])
@pytest.mark.parametrize("moved", [0.0, 1e-6, 0.5])
def test_the_worn_section_is_kept_whatever_arcs_and_bin_count(bins: int, half_angle: float, moved: float) -> None:
    rng = np.random.default_rng(bins)
    for angle in rng.uniform(-7.0, 7.0, 20):
        radius, section = rng.uniform(0.01, 2.0), rng.uniform(0.1, 1.0)
        depths = worn(bins, angle, half_angle, moved, section, radius)
        assert depths.min() >= 0.0
        # Bin edges are known to eps * angle: relative to the narrowest arc, 2e-9, that is 1e-6.
        rounding = 1e-14 + 8e-16 * 7.0 / max(half_angle, moved, 1e-9)
        assert depths.sum() * radius * 2 * math.pi / bins == pytest.approx(section, rel=rounding)


def test_bins_inside_the_arc_wear_evenly_and_those_outside_not_at_all() -> None:
    depths = worn(36, math.pi, 0.6, section=0.3, radius=0.5)
    middles = (np.arange(36) + 0.5) * 2 * math.pi / 36
    inside = np.abs(middles - math.pi) < 0.6 - math.pi / 36
    outside = np.abs(middles - math.pi) > 0.6 + math.pi / 36
    assert depths[inside] == pytest.approx(0.3 / (1.2 * 0.5), rel=1e-13)
    assert not depths[outside].any()
    assert inside.sum() == 6


def test_an_arc_across_zero_wears_the_last_and_the_first_bin() -> None:
    depths = worn(8, 0.0, 0.1)
    assert depths[0] == pytest.approx(depths[7], rel=1e-13)
    assert np.count_nonzero(depths) == 2
    lopsided = worn(8, 0.05, 0.1)
    assert lopsided[0] == pytest.approx(3.0 * lopsided[7], rel=1e-13)


def test_an_arc_that_moves_wears_as_many_short_steps_of_it_do() -> None:
    for pressed, moved in ((0.3, 0.2), (0.2, 0.3), (0.1, 1e-3), (1e-3, 0.4)):
        steps = np.linspace(-moved, moved, 20_001)
        steps = 0.5 * (steps[1:] + steps[:-1])
        summed = np.mean([worn(90, 2.0 + step, pressed) for step in steps], axis=0)
        assert worn(90, 2.0, pressed, moved) == pytest.approx(summed, abs=1e-4 * summed.max())


def test_the_pressed_arc_opens_with_the_square_root_of_the_depth() -> None:
    clearance = 2e-4
    assert pressed_half_angle(0.0, clearance) == 0.0
    # arccos(1 / (1 + x)) = sqrt(2 x) (1 - 5 x / 12 + ...).
    assert pressed_half_angle(1e-6, clearance) == pytest.approx(math.sqrt(0.01) * (1 - 5 * 0.005 / 12), rel=1e-5)
    angles = [pressed_half_angle(depth, clearance) for depth in np.logspace(-9, 1, 40)]
    assert np.all(np.diff(angles) > 0.0)
    assert angles[-1] < math.pi / 2


def test_the_volume_worn_in_a_run_is_the_coefficient_times_the_sliding_work() -> None:
    p = ArrayParameters(wear_bins=50, bearing_width=0.7)
    run = simulate(build(p), 2.0, integrator=RungeKutta(rtol=1e-5))
    volume = p.wear_coefficient * run.sliding_work[-1]
    assert volume.min() > 0.0
    for depths, radius in ((run.wear_journal, p.journal_radius), (run.wear_bearing, p.journal_radius + 2e-4)):
        booked = depths.sum(axis=1) * radius * 2 * math.pi / 50 * p.bearing_width
        # Rounding of thousands of sums, and of bin edges against arcs of some 0.01 rad.
        assert booked == pytest.approx(volume, rel=1e-10, abs=0.0)


LOAD, FRICTION, RATE, BINS = 10.0, 0.15, 20.0, 360
SLIDING = Bearing(
    clearance=2e-4,
    journal_radius=0.01,
    contact=PowerLaw(7.39e10, damping=0.6),
    friction_coefficient=FRICTION,
    wear_coefficient=1e-13,
    width=0.05,
)
# Where a journal presses that is loaded downwards and turns counter-clockwise, seen from the ground.
PRESSED = 1.5 * math.pi - math.atan(FRICTION)


def two_turns(
    journal_angle: float, journal_rate: float, housing_angle: float, housing_rate: float, integrator: RungeKutta
) -> Trajectory:
    """A loaded journal in a housing, which turn about the same centre; friction hardly slows their inertia."""
    normal = LOAD / math.hypot(1.0, FRICTION)
    reach = SLIDING.clearance + SLIDING.contact.depth_under(normal)
    place = (reach * math.cos(PRESSED), reach * math.sin(PRESSED))
    centred = {"mass": 1.0, "inertia": 1e6, "length": 1.0, "centroid": (0.0, 0.0)}
    mechanism = Mechanism(
        bodies=(
            Body("housing", angle=housing_angle, spin=housing_rate, **centred),
            Body("journal", angle=journal_angle, spin=journal_rate, position=place, **centred),
        ),
        joints=(
            Joint("axle", GROUND, "housing", (0.0, 0.0), (0.0, 0.0)),
            Joint("bearing", "housing", "journal", (0.0, 0.0), (0.0, 0.0), bearing=SLIDING),
        ),
        gravity=(0.0, -LOAD),
        wear_bins=BINS,
    )
    return simulate(mechanism, 4.0 * math.pi / RATE, integrator=integrator)


def assert_worn_only_where_pressed(depths: np.ndarray, place: float) -> None:
    width = 2.0 * math.pi / BINS
    middles = (np.arange(BINS) + 0.5) * width
    half = pressed_half_angle(SLIDING.contact.depth_under(LOAD / math.hypot(1.0, FRICTION)), SLIDING.clearance)
    # The two bins that the arc covers in part count at their middles.
    assert depths @ middles / depths.sum() == pytest.approx(place, abs=width**2 / (16.0 * half))
    assert not depths[np.abs(middles - place) > half + width].any()


def assert_worn_evenly(depths: np.ndarray) -> None:
    # The first and the last step wear arcs at once.
    assert depths.max() < 1.03 * depths.mean()
    assert depths.min() > 0.97 * depths.mean()


@pytest.mark.parametrize(
    "integrator", [RungeKutta(rtol=1e-9), ModalRadau(rtol=1e-3)], ids=["short steps", "long steps"]
)
@pytest.mark.parametrize("angle", [0.0, 1.0, -1.2])
def test_a_turning_bearing_wears_evenly_round_and_its_journal_where_it_is_pressed(
    angle: float, integrator: RungeKutta
) -> None:
    run = two_turns(angle, 0.0, 0.0, -RATE, integrator)
    assert_worn_evenly(run.wear_bearing[1])
    assert_worn_only_where_pressed(run.wear_journal[1], PRESSED - angle)
