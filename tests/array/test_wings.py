"""The arrays that come with the package, from published data: they deploy, and as published where that is known."""

import numpy as np
import pytest

from solar_env.array import build
from solar_env.array.construction import build_deployed
from solar_env.array.deployment import simulate
from solar_env.array.motorization import motorization
from solar_env.array.parameters.file import WINGS, named_array
from solar_env.mechanics.analysis.linearization import natural_frequencies


@pytest.mark.parametrize("name", WINGS)
def test_every_array_deploys_and_no_hinge_stalls(name):
    parameters, ranges = named_array(name)
    assert ranges
    assert all(hinge.stalls_at is None for hinge in motorization(parameters))
    for model in ("rigid-clearance", "flexible-clearance"):
        build(parameters, model)
    run = simulate(parameters, duration=15.0)
    assert np.isfinite(run.latch_times).all()
    assert run.energy_residual < 1e-4 * run.energy_put_in


def test_the_wings_of_apple_take_the_published_time_and_vibrate_at_the_published_frequency():
    apple, _ = named_array("apple")
    run = simulate(apple, model="rigid-ideal", duration=8.0)
    assert run.latch_times == pytest.approx([4.5] * 4, abs=0.1)
    held = build_deployed(apple.with_changes({"body_fixed": True}), "flexible-ideal:8 elements")
    assert natural_frequencies(held)[0] == pytest.approx(1.54, abs=0.02)


def test_the_steady_moment_of_the_tapes_is_that_of_the_cited_theory():
    table, _ = named_array("tape-spring")
    young, poisson, thickness, angle = 210e9, 0.3, 1e-4, np.radians(106.0)
    rigidity = young * thickness**3 / (12.0 * (1.0 - poisson**2))
    pair = (1.0 + poisson) * rigidity * angle + (1.0 - poisson) * rigidity * angle
    assert table.spring_torque[0][0][1] == pytest.approx(4.0 * pair, rel=5e-3)
