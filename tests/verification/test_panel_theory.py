"""The theory that modal panels are compared with, against closed forms."""

import math
from dataclasses import replace

import numpy as np
import pytest

from solar_env.mechanics.mechanism.beams import Beam
from solar_env.verification.beams.theory import axial_frequencies
from solar_env.verification.panels import theory
from solar_env.verification.panels.impact_theory import Impact, struck_bar, struck_beam
from solar_env.verification.panels.theory import FineBeam

LENGTH, MASS, STIFFNESS = 2.0, 3.0, 50.0
BEAM = Beam(LENGTH, MASS / LENGTH, STIFFNESS, STIFFNESS)


def test_flexibility_is_symmetric_and_the_sum_over_the_modes() -> None:
    flexibility = theory.bending_flexibility(LENGTH, STIFFNESS)
    assert flexibility == pytest.approx(flexibility.T, rel=1e-12)
    # Equal and opposite moments bend a beam to a circle: the ends turn apart by M L / (E I).
    turn = flexibility @ np.array([0.0, -1.0, 0.0, 1.0])
    assert turn[3] - turn[1] == pytest.approx(LENGTH / STIFFNESS, rel=1e-12)
    beam = FineBeam(BEAM, modes=2000)
    summed = beam.left_out(0)
    assert summed == pytest.approx(np.diag(flexibility)[:2], rel=1e-3)
    # The slope's series falls with the first power of the number of modes.
    assert flexibility[0, 0] == pytest.approx(summed[0], rel=1e-9)


def test_axial_flexibility_is_the_sum_over_the_modes() -> None:
    omega = 2.0 * math.pi * axial_frequencies("free-free", BEAM, 20_000)
    signs = (-1.0) ** np.arange(1, omega.size + 1)
    found = theory.axial_flexibility(LENGTH, STIFFNESS)
    assert found[0, 0] == pytest.approx(np.sum(2.0 / MASS / omega**2), rel=1e-4)
    assert found[0, 1] == pytest.approx(np.sum(signs * 2.0 / MASS / omega**2), rel=1e-4)


def test_step_response_starts_from_rest_and_swings_about_the_static_answer() -> None:
    beam = FineBeam(replace(BEAM, damping=1e-3))
    value, rate = beam.step_response(0, 0.0)
    scale = theory.bending_flexibility(LENGTH, STIFFNESS)[0, 0]
    assert abs(value[0]) < 1e-8 * scale
    assert np.abs(rate).max() == 0.0
    # When all has died, what is left is the free flight of a rigid beam about its bent shape.
    late, _ = beam.step_response(0, 100.0)
    assert late[0] == pytest.approx(0.5 * 100.0**2 * 4.0 / MASS + scale, rel=1e-12)


def test_bar_struck_without_compliance_is_that_of_st_venant() -> None:
    impact, impedance, wave_speed = Impact(2.0, 0.5, 1e9), 40.0, 100.0
    struck = struck_bar(impact, LENGTH, impedance, wave_speed)
    round_trip = 2.0 * LENGTH / wave_speed
    inside = (struck.time > 0.01 * round_trip) & (struck.time < 0.999 * round_trip)
    exact = impedance * impact.speed * np.exp(-impedance * struck.time / impact.mass)
    assert struck.force[inside] == pytest.approx(exact[inside], rel=2e-3)
    # The returning tension parts the two at once, at the striker's speed by then.
    assert struck.time[-1] == pytest.approx(round_trip, rel=1e-2)
    assert struck.exit_speed == pytest.approx(impact.speed * math.exp(-impedance * round_trip / impact.mass), rel=1e-2)


def test_struck_beam_converges_with_second_order_and_balances_momentum() -> None:
    impact, beam = Impact(0.3, 0.2, 1e6), FineBeam(BEAM, modes=400)
    runs = [struck_beam(impact, beam, 0.02, steps) for steps in (500, 1000, 8000)]
    coarse, fine, exact = (run.exit_speed for run in runs)
    assert abs(fine - exact) < 0.35 * abs(coarse - exact)
    impulse = np.trapezoid(runs[-1].force, runs[-1].time)
    assert impulse == pytest.approx(impact.mass * (impact.speed - exact), rel=1e-9)


def test_spin_raises_the_squared_frequency_by_some_two_squared_spins() -> None:
    # The second Legendre polynomial, an eigenfunction of the centrifugal tension alone, would give 3 - 1.
    assert theory.spin_stiffening() == pytest.approx(2.05, abs=0.005)
