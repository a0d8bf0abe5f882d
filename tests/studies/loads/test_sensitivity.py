"""Sensitivities: coefficients against a linear model whose variances are known, and shifts one at a time."""

from dataclasses import replace

import numpy as np
import pytest

from solar_env.array import ArrayParameters
from solar_env.array.parameters.ranges import drawn
from solar_env.studies.loads import ensemble
from solar_env.studies.loads.page import loads_page
from solar_env.studies.loads.report import tables, what_changes
from solar_env.studies.loads.runs import deploy
from solar_env.studies.loads.sensitivity import one_at_a_time, regression, shifts

RANGES = {"body_mass": (1000.0, 2000.0), "clearance": ((1e-4, 1e-4), (2e-4, 4e-4))}


@pytest.fixture(scope="module")
def members():
    return [ArrayParameters().with_changes(drawn(RANGES, np.random.default_rng(k))) for k in range(2000)]


def test_standardised_coefficients_are_the_shares_of_a_linear_figures_deviation(members):
    mass, second = (np.array([m.body_mass for m in members]), np.array([m.clearance[1] for m in members]))
    # Deviations of uniform draws are their widths over sqrt(12): 3 of the mass, 4 of the clearance, 12 of the noise.
    noise = np.random.default_rng(0).uniform(0.0, 12.0, len(members))
    figure = 3e-3 * mass - 4.0 / 3e-4 * second + noise
    found = regression(RANGES, members, {"impulse": figure[:, None]}).effects["impulse"][0]
    middles = {name: 0.5 * (found.low[name] + found.high[name]) for name in found.low}
    assert middles == pytest.approx(
        {"body_mass": 3 / 13, "clearance, joint 1": 0.0, "clearance, joint 2": -4 / 13}, abs=0.06
    )
    assert found.explained == pytest.approx(25 / 169, abs=0.04)
    assert found.ranking[:2] == ["clearance, joint 2", "body_mass"]
    assert all(found.low[name] < middles[name] < found.high[name] for name in middles)


def test_a_figure_of_one_parameter_alone_is_explained_and_a_constant_one_is_not(members):
    mass = np.array([[m.body_mass, 7.0] for m in members])
    alone, constant = regression(RANGES, members, {"impulse": mass}).effects["impulse"]
    assert (alone.ranking, alone.explained) == (["body_mass"], pytest.approx(1.0))
    assert constant.ranking == []
    few = regression(RANGES, members[:5], {"impulse": mass[:5]})
    assert (few.effects, few.missing) == ({}, "3 values are drawn, whose effects take 6 runs or more (--runs)")


def test_shifts_are_of_every_parameter_that_changes_the_model():
    found = shifts(ArrayParameters(), "rigid-clearance")
    assert found[None] == ArrayParameters()
    assert found["spring_stiffness", 1.1].spring_stiffness == pytest.approx((0.11, 0.0825))
    names = {shift[0] for shift in found if shift}
    assert {"body_mass", "latch_damping", "clearance"} <= names
    assert not names & {"hinge_damping", "gravity_angle", "bracket_stiffness", "panel_area_mass"}
    assert ("restitution", 1.1) in found
    assert not names & {"latch_exponent", "friction_speed_full"}, "they belong to the laws"


def test_one_at_a_time_changes_are_relative_and_scatter_is_no_change():
    run = {"quantities": {"impulse": [2.0, 4.0]}}
    runs = {
        None: run,
        ("body_mass", 0.9): {"quantities": {"impulse": [1.0, 4.0]}},
        ("body_mass", 1.1): {"quantities": {"impulse": [2.5, 4.1]}},
        ("clearance", 0.9): {"failed": {"it": "why"}},
        ("clearance", 1.1): {"quantities": {"impulse": [np.nan, 4.0]}},
    }
    first, second = one_at_a_time(runs, {"impulse": np.array([[1.9, 3.5], [2.1, 4.5]])}).effects["impulse"]
    assert (first.low["body_mass"], first.high["body_mass"]) == (-0.5, 0.25)
    assert np.isnan([first.low["clearance"], first.high["clearance"]]).all()
    assert first.ranking == ["body_mass"]
    assert first.noise == pytest.approx(1.96 * 0.1 * np.sqrt(2.0) / 2.0 * np.sqrt(2.0), rel=1e-3)
    assert not first.one_sided("body_mass")
    assert replace(first, low={"body_mass": 0.5}).one_sided("body_mass"), "both changes raise it"
    assert second.ranking == [], "a change of 2.5 % is below the scatter of 35 %"


def test_the_latch_torque_of_an_undrawn_array_rises_as_the_root_of_the_springs_energy(tmp_path):
    """Without damping k d^2 is twice the energy: a tenth more of the springs gives 4.9 % more, of the latch as well."""
    parameters = ArrayParameters(
        panel_count=1, body_fixed=True, spring_stiffness=2.0, latch_damping=0.0, latch_gap=0.0, wear_bins=4
    )
    plan = ensemble.LoadsPlan(ensemble.ParameterFile(parameters, {}), "rigid-clearance", members=4, window=0.5)
    console = ensemble.Console(quiet=True)
    plan_level = replace(plan.levels[0])
    loads = ensemble.measure_loads(plan, tmp_path, 2, console)
    assert what_changes(loads) == "What changes the figures is not known: no parameter has been shifted."
    loads = ensemble.measure_sensitivity(loads, tmp_path, 2, console)
    (found,) = loads.sensitivity.effects["latch_torque"]
    for name in ("spring_stiffness", "latch_stiffness"):
        assert found.high[name] == pytest.approx(np.sqrt(1.1) - 1.0, abs=4e-3)
    assert found.ranking[0] == "spring_preload_angle", "the energy rises with its square"
    assert "10 % less, 10 % more" in what_changes(loads)
    assert tables(loads)[-1].title.startswith("What changes a figure: one parameter 10 % less")
    page = loads_page(loads, deploy(plan_level, parameters, 0, 0.5, 60.0), [])
    assert any(chart.bars and chart.bars[0] == "spring_preload_angle" for chart in page.charts)
