"""Loads of an ensemble: what a run says, figures with their digits, levels, and the hub's momentum."""

from __future__ import annotations

import json
import math
import re
from dataclasses import replace

import numpy as np
import pytest

from solar_env.array import build, cheapest_level
from solar_env.array.deployment import simulate
from solar_env.array.parameters.file import ParameterFile
from solar_env.mechanics.integrators.methods.table import METHODS
from solar_env.mechanics.integrators.settings import ModalRadau, RungeKutta
from solar_env.mechanics.running.errors import SimulationError
from solar_env.studies.common.motion import Level
from solar_env.studies.common.plans import FAST_PARAMETERS
from solar_env.studies.loads import ensemble
from solar_env.studies.loads.hub import hub_place, hub_velocity, mean_loads, sampled_hinge_loads
from solar_env.studies.loads.page import loads_page
from solar_env.studies.loads.quantities import JOINT_QUANTITIES, QUANTITIES, read_all
from solar_env.studies.loads.report import answer, tables, what_changes
from solar_env.studies.loads.runs import FREQUENCIES, deploy, member_parameters
from solar_env.studies.loads.statistics import Figure, counted, figure_of, high_quantile, rounded, shortened

RIGID = Level("rigid-clearance")
FAST = ParameterFile(FAST_PARAMETERS, {"clearance": ((1.9e-4, 1.9e-4), (2.1e-4, 2.1e-4))})


@pytest.fixture(scope="module")
def fast():
    return deploy(RIGID, FAST_PARAMETERS, 0, 1.0, 60.0)


def test_a_run_ends_where_it_should_and_totals_are_those_of_simulate(fast):
    trajectory = fast.trajectory
    end = float(trajectory.latch_times.max()) + 1.0
    assert end - 1e-3 <= trajectory.time[-1] <= end
    np.testing.assert_allclose(np.diff(trajectory.time), 1e-3, rtol=1e-9)
    # Landing on samples changes no step before the latching, and the motion is chaotic after it.
    usual = simulate(FAST_PARAMETERS, duration=end, integrator=RIGID.integrator(0))
    np.testing.assert_allclose(trajectory.latch_times, usual.latch_times, rtol=1e-6)
    np.testing.assert_allclose(fast.trajectory.postlock_peak_force, usual.postlock_peak_force, rtol=0.3)
    assert trajectory.energy_residual < 1e-4 * trajectory.energy_put_in
    assert fast.hinge_spectrum.shape == (len(FREQUENCIES), 2)
    assert (fast.hinge_spectrum > 0.0).all()


@pytest.mark.parametrize("window", [0.01, 0.1])
def test_a_window_shorter_than_what_is_simulated_between_two_looks_is_kept_to(window):
    trajectory = deploy(RIGID, FAST_PARAMETERS, 1, window, 60.0).trajectory
    end = float(trajectory.latch_times.max()) + window
    assert end - 1e-3 <= trajectory.time[-1] <= end


def test_the_loads_on_the_hub_between_samples_reach_its_peaks_and_are_no_less_than_their_means(fast):
    # Means over 50 us are a little below the first joint's peak; friction of 0.15 adds to the normal force.
    assert 0.7 < fast.hub_peaks[0] / fast.trajectory.peak_force[0] < math.hypot(1.0, 0.15)
    assert fast.hub_peaks[2] == pytest.approx(fast.hub_peaks[0] / FAST_PARAMETERS.body_mass, rel=1e-12)
    assert fast.hub_greatest.shape == (len(fast.trajectory.time) - 1, 2)
    np.testing.assert_allclose(fast.hub_greatest.max(axis=0), fast.hub_peaks[:2], rtol=1e-12)
    means = np.column_stack([np.hypot(fast.hub_loads[:, 0], fast.hub_loads[:, 1]), np.abs(fast.hub_loads[:, 2])])
    assert (fast.hub_greatest >= means - 1e-6 * means.max(axis=0)).all()
    # Nothing is struck before the first latching, up to which samples are a millisecond apart.
    before = fast.trajectory.time[1:] < fast.trajectory.latch_times.min() - 0.6
    np.testing.assert_allclose(fast.hub_greatest[before], means[before], rtol=1e-6, atol=1e-6)


def test_what_the_titles_of_the_hubs_charts_say_is_what_they_draw(loads, fast):
    charts = {chart.title: chart for chart in loads_page(loads, fast, []).charts}
    for load, unit in zip(fast.hub_peaks[:2], ("N", "N m"), strict=True):
        (line,) = charts[f"The nominal hub sees up to {shortened(load, 3)} {unit}"].lines
        assert line.y.max() == pytest.approx(load, rel=1e-12)
        assert len(line.x) == len(line.y)


def test_the_page_has_a_folded_table_of_every_parameter_with_its_unit(loads, fast):
    table = loads_page(loads, fast, []).tables[-1]
    assert table.folded
    rows = {name: rest for name, *rest in table.rows}
    assert list(rows) == list(FAST_PARAMETERS.to_dict())
    assert rows["clearance"] == ["0.0002", "m", "yes", "(0.00019, 0.00019) and (0.00021, 0.00021)"]
    assert rows["panel_count"] == ["2", "", "yes", ""]
    assert rows["latch_stiffness"][1] == "N m/rad^exponent"
    assert rows["body_fixed"] == ["no", "", "yes", ""]
    assert rows["cable_torque_ratio"][0] == "from others"


def test_the_same_member_gives_the_same_bits():
    parameters = member_parameters(FAST.parameters, FAST.randomize, 3)
    assert parameters == member_parameters(FAST.parameters, FAST.randomize, 3)
    assert parameters != member_parameters(FAST.parameters, FAST.randomize, 4)
    assert all(1.9e-4 <= value <= 2.1e-4 for value in parameters.clearance)
    first, second = (deploy(RIGID, parameters, 3, 0.2, 60.0) for _ in range(2))
    assert read_all(first) == read_all(second)
    assert np.array_equal(first.hinge_spectrum, second.hinge_spectrum)


@pytest.mark.parametrize(
    ("model", "integrator"), [("rigid-ideal", RungeKutta(rtol=1e-8)), ("flexible-ideal", ModalRadau(rtol=1e-5))]
)
def test_loads_from_the_hubs_momentum_are_those_that_the_root_hinge_exerts(model, integrator):
    parameters = replace(FAST_PARAMETERS, hinge_y=-0.3, initial_spin=0.2)
    trajectory = simulate(parameters, model=model, duration=1.0, integrator=integrator, output_step=1e-4)
    compiled, _ = METHODS[integrator.name].formulation.compile(build(parameters, model))
    place = hub_place(parameters, compiled, trajectory.coordinates)
    velocity = hub_velocity(parameters, compiled, trajectory.coordinates, trajectory.velocities)
    found = mean_loads(parameters, trajectory.time, velocity)
    exerted = sampled_hinge_loads(parameters, trajectory, place)
    gained, given = (np.cumsum(1e-4 * loads, axis=0) for loads in (found, 0.5 * (exerted[1:] + exerted[:-1])))
    # Samples do not resolve the highest modes of flexible panels.
    share = 1e-5 if model == "rigid-ideal" else 1e-2
    assert (np.abs(gained - given).max(axis=0) < share * np.abs(given).max(axis=0)).all()


def test_a_hub_held_in_place_feels_the_loads_of_the_root_hinge():
    held = deploy(RIGID, replace(FAST_PARAMETERS, body_fixed=True), 0, 0.2, 60.0)
    assert np.array_equal(held.place, np.broadcast_to(held.place[0], held.place.shape))
    # Before the joints load it, the hub feels the springs' and the cable's torque on the root: the released preload.
    assert abs(held.hub_loads[:, 2]).max() > 1.0
    assert held.hub_peaks[0] == pytest.approx(np.hypot(*held.hub_loads[:, :2].T).max())


def test_without_latching_only_what_needs_none_is_told():
    short = deploy(RIGID, FAST_PARAMETERS, 0, 1.0, 0.5)
    assert short.trajectory.time[-1] == pytest.approx(0.5)
    told = {name for name, values in read_all(short).items() if np.isfinite(values).all()}
    assert told == {name for name, quantity in QUANTITIES.items() if not quantity.needs_latching}


def test_one_sided_tolerance_factors_are_those_of_the_tables():
    # Factors for 99 % of a normal population with 95 % confidence (R. E. Odeh and D. B. Owen, Tables for normal
    # tolerance limits, 1980): 3.981 for 10 values, 3.295 for 20, 2.684 for 100.
    for count, factor in ((10, 3.981), (20, 3.295), (100, 2.684)):
        logarithms = np.random.default_rng(count).normal(2.0, 0.3, count)
        mean, deviation = logarithms.mean(), logarithms.std(ddof=1)
        quantile, bound = high_quantile(np.exp(logarithms))
        assert (math.log(bound) - mean) / deviation == pytest.approx(factor, abs=6e-4)
        assert (math.log(quantile) - mean) / deviation == pytest.approx(2.3263, abs=1e-4)


def test_no_digit_is_shown_that_is_not_known():
    for uncertainty, text in ((41.0, "520"), (17.0, "516"), (3.0, "516"), (math.nan, "520"), (0.0, "515.528")):
        assert rounded(515.528, uncertainty) == text
    for value, uncertainty, text in ((0.0571234, 0.004, "0.057"), (1.6e7, 2.5e6, "1.6e+07"), (-2.6, 0.3, "-2.6")):
        assert rounded(value, uncertainty) == text
    assert rounded(math.nan, 1.0) == "-"
    assert (rounded(0.3, 41.0), rounded(2412.0, 20_000.0)) == ("0.3", "2000"), "but none is rounded away"


def test_a_figure_compares_the_same_members_and_says_what_it_cannot():
    level = np.array([10.0, 11.0, 12.0, 13.0, np.nan])
    figure = figure_of(level, level + 2.0)
    assert (figure.mean, figure.model_error, figure.runs) == (11.5, 2.0, 4)
    assert figure.model_half_width == 0.0
    assert figure.half_width == pytest.approx(0.5 * (figure.high - figure.low))
    few = figure_of(level[:3], level[:3])
    assert math.isnan(few.low)
    assert math.isnan(few.quantile)
    assert math.isnan(few.half_width)
    assert figure_of(np.array([np.nan]), np.zeros(0)).runs == 0


def test_an_ensemble_runs_at_a_level_with_clearance_and_at_the_finest():
    assert [level.name for level in ensemble.LoadsPlan(FAST).levels] == [
        "flexible-clearance, 32 modes",
        "flexible-clearance, 48 modes, rtol / 10",
    ]
    assert ensemble.LoadsPlan(FAST).levels[0].model == cheapest_level("peak-force", 0.15)
    fitted = ParameterFile(FAST_PARAMETERS.with_changes({"panel_masses": [[1, 0.5, 0.2]]}), {})
    assert ["elements" in level.name for level in ensemble.LoadsPlan(fitted).levels] == [True, True]
    for wrong in ({"members": 0}, {"window": 0.0}, {"deadline": math.nan}, {"model": "rigid-ideal"}):
        with pytest.raises(ValueError, match=r"must be|ideal joints"):
            ensemble.LoadsPlan(FAST, **wrong)


@pytest.fixture(scope="module")
def loads():
    """Of four members, whose finer level is the same with other tolerances."""
    plan = ensemble.LoadsPlan(FAST, RIGID.model, members=4, window=0.5)
    shared = {"model": RIGID.model, "window": 0.5, "deadline": 60.0}
    shared |= {"parameters": FAST_PARAMETERS.to_dict(), "randomize": dict(FAST.randomize)}
    others = ({"parameters": form.parameters.to_dict()} for form in plan.forms.values())
    asked = ({"tighter": 1.0}, {"tighter": 3.0}, *({"tighter": 1.0} | other for other in others))
    cells = [shared | {"member": k} | changes for k in range(1, 5) for changes in asked]
    results = [ensemble.run_member(cell) for cell in cells]
    assert json.loads(json.dumps(results)) == results
    return ensemble.gathered(plan, results)


def test_a_few_lines_answer_and_tables_hold_every_quantity(loads):
    lines = answer(loads)
    assert len(lines) == 6
    assert lines[0].startswith("The latch of joint ")
    assert "is bent hardest, by" in lines[0]
    assert "Level: rigid-clearance; the discretisation error of a figure" in lines[5]
    assert "4 runs of each level" in lines[5]
    assert "clearance" in lines[5]
    assert what_changes(loads) == (
        "What changes the figures is not known: 2 values are drawn, whose effects take 5 runs or more (--runs)."
    )
    names = [row[0] for table in tables(loads)[:2] for row in table.rows]
    of_forms = [f"peak pin force, contact law of {contact}" for contact in loads.plan.forms]
    assert len(of_forms) == 2
    assert [name for name in names if name not in of_forms] == 2 * [row.name for row in JOINT_QUANTITIES.values()]
    assert all(names.count(form) == 2 for form in of_forms)
    assert all(len(row) == len(table.columns) for table in tables(loads) for row in table.rows)
    hit = max(loads.figures["peak_force"], key=lambda figure: figure.mean)
    assert hit.low < hit.mean < hit.high < hit.quantile_bound


def test_force_impulse_and_wear_are_each_told_with_interval_quantile_and_their_own_model_error(loads):
    first = {
        "peak_force": [Figure(222.3, 214.0, 230.0, 268.0, 291.0, 10.4, 11.0, 16)],
        "impulse": [
            Figure(31.0, 30.9, 31.1, 31.5, 31.7, 0.2, 0.1, 16),
            Figure(55.024, 54.94, 55.1, 55.6, 55.8, -1.13, 0.07, 16),
        ],
        "wear_depth": [Figure(3.02e-14, 2.9e-14, 3.14e-14, 3.8e-14, 4.2e-14, 3e-15, 2e-15, 16)],
    }
    cylinder = (Figure(780.0, 730.0, 830.0, 900.0, 990.0, -557.0, 40.0, 16),)
    forms = {
        "a cylinder in its bush": cylinder,
        "bracket and bush": (replace(cylinder[0], mean=178.0, low=170.0, high=186.0),),
    }
    _, force, impulse, wear, *_, basis = answer(replace(loads, figures=loads.figures | first, forms=forms))
    assert force == (
        "The pin of joint 1 is hit hardest: 222 \u00b1 8 N, 99 % of deployments stay below 270 N (with 95 % confidence "
        "below 290 N), discretisation error +10 \u00b1 11 N; 780 \u00b1 50 N at joint 1 by the contact law of a "
        "cylinder in its bush, 178 \u00b1 8 N at joint 1 by the contact law of bracket and bush: the model form leaves "
        "it between 180 and 780 N (size on the greatest, or measure bracket_stiffness and take contact_law = bracket)."
    )
    assert impulse == (
        "Within 0.5 s of the last latching joint 2 exchanges most momentum: 55.02 \u00b1 0.08 N s, 99 % of deployments "
        "stay below 55.60 N s (with 95 % confidence below 55.80 N s), discretisation error -1.13 \u00b1 0.07 N s."
    )
    assert "30.2 \u00b1 1.2 fm" in wear
    assert "discretisation error +3 \u00b1 2 fm; which is negligible: 33,000,000 deployments to 1 micrometre," in wear
    assert "the discretisation error of a figure is its difference from the finest level" in basis
    undrawn = replace(loads.plan, array=ParameterFile(loads.plan.array.parameters, {}))
    assert "an assumed scatter of the release alone" in answer(replace(loads, plan=undrawn))[0]
    nan = math.nan
    alone = (Figure(222.3, nan, nan, nan, nan, 10.4, nan, 1),)
    line = answer(replace(loads, figures=loads.figures | {"peak_force": alone}, forms={}))[1]
    assert line == (
        "The pin of joint 1 is hit hardest: 220 N, discretisation error unknown; model form unknown, for no other "
        "contact law takes this array."
    )


def test_great_numbers_are_told_in_two_digits():
    assert [counted(number) for number in (40.0, 17_300.0, 3.31e7)] == ["40", "17,000", "33,000,000"]
    assert counted(math.inf) == "infinitely many"


def test_what_is_read_scatters_but_the_energy_that_is_lost_does_not_hang_on_the_tolerance(loads):
    assert loads.hinge_spectrum.shape == (2, 4, len(FREQUENCIES), 2)
    for figure in loads.figures["latch_time"]:
        assert abs(figure.model_error) < 1e-4
    for figure in loads.figures["impulse"]:
        assert abs(figure.model_error) < 0.3 * figure.mean


def test_a_member_that_fails_is_named_with_its_parameters_and_left_out(monkeypatch):
    def fails(level, parameters, member, window, deadline):
        raise SimulationError("at t = 1 s the state is no longer finite", 1.0, "not_finite")

    monkeypatch.setattr(ensemble, "deploy", fails)
    shared = {"model": RIGID.model, "tighter": 1.0, "window": 1.0, "deadline": 9.0, "member": 7}
    drawn = {"parameters": FAST.parameters.to_dict(), "randomize": {"body_mass": (900.0, 901.0)}}
    failed = ensemble.run_member({**shared, **drawn})
    (name,) = failed["failed"]
    assert re.fullmatch(r"run 7 of .*, body_mass = 900\.\d+", name)
    unlike = {name: [1.0, 2.0] if name in JOINT_QUANTITIES else [1.0] for name in QUANTITIES}
    run = {"latched": True, "quantities": unlike, "hinge_spectrum": [], "hub_spectrum": [], "warnings": []}
    plan = ensemble.LoadsPlan(FAST, RIGID.model, members=6)
    loads = ensemble.gathered(plan, [failed, *[run] * 23])
    assert loads.figures["peak_force"][0].runs == 5
    assert f"1 of 24 runs failed and are left out ({name}: at t = 1 s" in answer(loads)[-1]
    with pytest.raises(ValueError, match="3 of 24 runs failed, more than the 10%"):
        ensemble.gathered(plan, [failed, *[run] * 21, *({"failed": {name: "too"}} for name in "ab")])


def test_an_ensemble_that_never_latches_says_what_to_do():
    plan = ensemble.LoadsPlan(FAST, RIGID.model, members=1, deadline=0.3)
    run = {"latched": False, "quantities": {}, "hinge_spectrum": [], "hub_spectrum": [], "warnings": []}
    with pytest.raises(ValueError, match=r"in none of 1 runs all joints latch within 0\.3 s; give a longer --deadline"):
        ensemble.gathered(plan, [run] * 4)
