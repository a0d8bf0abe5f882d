"""Archard wear by circumferential bin: the worn volume is booked exactly, wherever it falls."""

from __future__ import annotations

import math

import numpy as np
import pytest

from solar_env.array import ArrayParameters, build
from solar_env.mechanics.integrators import RungeKutta
from solar_env.mechanics.simulation import simulate
from solar_env.mechanics.wear import add_wear, pressed_half_angle


def worn(bins: int, angle: float, half_angle: float, section: float = 1.0, radius: float = 1.0) -> np.ndarray:
    depths = np.zeros(bins)
    add_wear(depths, angle, half_angle, section, radius)
    return depths


@pytest.mark.parametrize("bins", [1, 2, 3, 17, 360])
@pytest.mark.parametrize("half_angle", [0.0, 1e-12, 1e-4, 0.02, 0.5, math.pi / 2, 3.0, 4.0])
def test_the_worn_section_is_kept_whatever_arc_and_bin_count(bins: int, half_angle: float) -> None:
    rng = np.random.default_rng(bins)
    for angle in rng.uniform(-7.0, 7.0, 20):
        radius, section = rng.uniform(0.01, 2.0), rng.uniform(0.1, 1.0)
        depths = worn(bins, angle, half_angle, section, radius)
        assert depths.min() >= 0.0
        # Bin edges are known to eps * angle: relative to the narrowest arc, 2e-9, that is 1e-6.
        rounding = 1e-14 + 8e-16 * 7.0 / max(half_angle, 1e-9)
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


@pytest.mark.parametrize("turns", [-3, -1, 1, 5])
def test_full_turns_make_no_difference(turns: int) -> None:
    assert worn(24, 1.234 + 2 * math.pi * turns, 0.3) == pytest.approx(worn(24, 1.234, 0.3), abs=1e-13)


def test_turning_the_arc_by_one_bin_moves_the_wear_by_one_bin() -> None:
    width = 2 * math.pi / 24
    assert worn(24, 6.2 + width, 0.3) == pytest.approx(np.roll(worn(24, 6.2, 0.3), 1), abs=1e-13)


def test_wear_adds_up() -> None:
    depths = worn(12, 1.0, 0.2)
    add_wear(depths, 4.0, 0.7, 2.0, 1.0)
    assert depths == pytest.approx(worn(12, 1.0, 0.2) + worn(12, 4.0, 0.7, 2.0), rel=1e-14)


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
