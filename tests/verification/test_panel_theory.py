"""The theory that modal panels are compared with, against closed forms."""

import math
from dataclasses import replace

import numpy as np
import pytest

from solar_env.mechanics.mechanism.beams import Beam
from solar_env.verification.beams.theory import FineBeam
from solar_env.verification.panels.struck import Impact, struck_bar, struck_beam

LENGTH, MASS, STIFFNESS = 2.0, 3.0, 50.0
BEAM = Beam(LENGTH, MASS / LENGTH, STIFFNESS, STIFFNESS)


def test_flexibility_is_the_sum_over_the_modes() -> None:
    beam = FineBeam(BEAM, modes=2000)
    deflection, slope = beam.left_out(0)
    assert beam.flexibility[0, 0] == pytest.approx(deflection, rel=1e-9)
    # The slope's series falls with the first power of the number of modes.
    assert beam.flexibility[1, 1] == pytest.approx(slope, rel=1e-3)


def test_step_response_starts_from_rest_and_swings_about_the_static_answer() -> None:
    beam = FineBeam(replace(BEAM, damping=1e-3))
    scale = beam.flexibility[0, 0]
    assert abs(beam.step_response(0, 0.0)[0]) < 1e-8 * scale
    # When all has died, what is left is the free flight of a rigid beam about its bent shape.
    assert beam.step_response(0, 100.0)[0] == pytest.approx(0.5 * 100.0**2 * 4.0 / MASS + scale, rel=1e-12)


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
