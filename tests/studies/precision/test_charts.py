"""The chart command on a plan of moments: tables, then figures from the tables alone."""

import io
import math
import shutil
from dataclasses import replace

import numpy as np
import pytest
from helpers import make_motion
from rich.console import Console

from solar_env.__main__ import main
from solar_env.array import PanelModel
from solar_env.commands.studies import chart
from solar_env.studies.common.plans import FULL, QUICK, Durations, Ensemble
from solar_env.studies.common.tables import Table, read_table
from solar_env.studies.common.timing import Measured
from solar_env.studies.precision import charts, growth, methods, side_by_side
from solar_env.studies.precision.ensembles import CONTESTANTS, LABELS, statistics_of
from solar_env.studies.precision.growth import with_panels

MOMENT = replace(
    QUICK,
    models=("rigid-clearance",),
    duration=0.02,
    before_latch=0.02,
    impacts_duration=Durations(0.02, 0.002),
    settings=1,
    panels=PanelModel("ancf", 1),
    ensemble_size=2,
    ensemble_duration=Durations(0.02, 0.002),
    levels=(Ensemble(None, 1), Ensemble(PanelModel("ancf", 1), 2), Ensemble(PanelModel("modal", 8), 1, 2.0)),
    growth_elements=(1, 2),
    growth_modes=(8, 16),
    growth_panels=(1, 2),
    growth_duration=0.002,
    side_duration=0.02,
)
FIGURES = {
    "work-precision": {"angles.png", "latch.png", "impacts.png", "horizon.png", "energy.png"},
    "ensembles": {"ensembles.png"},
    "levels": {"levels.png", "levels.md"},
    "growth": {"growth.png"},
    "side-by-side": {"side_by_side.md"},
}


@pytest.fixture(scope="module")
def measured(tmp_path_factory):
    """Folder with the tables of all studies, measured for a moment without the peer; and what was said."""
    folder = tmp_path_factory.mktemp("chart")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(charts, "QUICK", MOMENT)
        patch.setattr(methods.importlib.util, "find_spec", lambda name: None)
        console = Console(file=io.StringIO(), width=200)
        charts.measure_charts(tuple(charts.STUDIES), True, folder, console)
    return folder, console.file.getvalue()


def test_every_study_writes_its_tables_with_their_provenance(measured):
    folder, said = measured
    assert methods.MISSING_PEER in said
    names = {name: study for study, details in charts.STUDIES.items() for name in details.tables}
    assert {path.stem for path in folder.iterdir()} == set(names)
    for name, study in names.items():
        command = read_table(folder / f"{name}.csv").provenance["command"]
        assert command == f"solar-env chart --only {study} --quick"


@pytest.mark.parametrize("study", chart.STUDIES)
def test_figures_are_drawn_from_the_tables_alone(study, tmp_path, measured, monkeypatch):
    folder, _ = measured
    monkeypatch.setattr(charts, "measure_charts", None)
    for name in charts.STUDIES[study].tables:
        shutil.copy(folder / f"{name}.csv", tmp_path)
    assert main(["chart", "--draw", "--only", study, "--out", str(tmp_path)]) == 0
    drawn = {path.name for path in tmp_path.iterdir() if path.suffix != ".csv"}
    assert drawn == FIGURES[study]
    assert all((tmp_path / name).stat().st_size > 100 for name in drawn)


def test_the_command_measures_and_draws_and_the_same_table_gives_the_same_figure(tmp_path, monkeypatch):
    monkeypatch.setattr(charts, "QUICK", MOMENT)
    arguments = ["chart", "--only", "growth", "--out", str(tmp_path)]
    assert main([*arguments, "--quick"]) == 0
    figure = (tmp_path / "growth.png").read_bytes()
    assert main([*arguments, "--draw"]) == 0
    assert (tmp_path / "growth.png").read_bytes() == figure


def test_every_method_takes_a_moment_of_the_quick_charts_at_its_finest_setting(monkeypatch):
    monkeypatch.setattr(methods.importlib.util, "find_spec", lambda name: None)
    charts.warm_up(QUICK)


def test_the_command_knows_the_studies():
    assert tuple(charts.STUDIES) == chart.STUDIES


def test_every_method_has_a_row_with_costs_errors_and_energy(measured):
    folder, _ = measured
    table = read_table(folder / "work_precision.csv")
    rows = table.where(scene="deployment")
    own = {"runge-kutta", "modal-radau", "generalized-alpha", "generalized-alpha, adaptive", "paper's scheme"}
    assert own == set(rows.values("method"))
    assert {"SciPy DOP853", "SciPy Radau"} <= set(table.where(scene="impacts").values("method"))
    reference = rows.where(method="runge-kutta", value=1e-12)
    assert reference.column("angle_error_rad")[0] == 0.0
    for name in ("wall_s", "steps", "evaluations", "angle_error_rad", "energy_residual"):
        assert np.isfinite(rows.column(name)).all(), name
    assert np.isnan(rows.column("latch_error_s")).all(), "nothing latches in a moment"
    floors = read_table(folder / "work_precision_floors.csv")
    assert 0.0 < floors.where(scene="deployment").column("angle_error_rad")[0] < 1e-4
    assert floors.where(scene="impacts").column("impacts_in_horizon")[0] >= 1


def test_drawing_without_tables_says_what_to_do(tmp_path, capsys):
    assert main(["chart", "--draw", "--only", "growth", "--out", str(tmp_path)]) == 2
    message = capsys.readouterr().err
    assert "growth.csv" in message
    assert "measure first" in message


@pytest.mark.parametrize("wall", ["0", "0.0", "soon", ""])
def test_a_wall_time_that_is_none_is_told_with_its_line(wall, tmp_path, measured, capsys):
    folder, _ = measured
    lines = (folder / "side_by_side.csv").read_text().splitlines()
    head = next(number for number, line in enumerate(lines) if not line.startswith("# "))
    cells = lines[head + 1].split(",")
    cells[lines[head].split(",").index("wall_s")] = wall
    (tmp_path / "side_by_side.csv").write_text("\n".join([*lines[: head + 1], ",".join(cells), *lines[head + 2 :]]))
    assert main(["chart", "--draw", "--only", "side-by-side", "--out", str(tmp_path)]) == 2
    told = capsys.readouterr().err
    assert told.count("\n") == 1
    assert f"side_by_side.csv, line {head + 2}: wall_s is " in told


def test_plans_differ_in_size_alone():
    assert FULL.dear
    assert not QUICK.dear
    for plan in (FULL, QUICK):
        assert all(study.jobs(plan) for study in charts.STUDIES.values())
    # Without the peer a study of what costs most may be as small as the quick one.
    counts = [(len(study.jobs(FULL)), len(study.jobs(QUICK))) for study in charts.STUDIES.values()]
    assert all(full >= quick for full, quick in counts)
    assert sum(full for full, _ in counts) > 2 * sum(quick for _, quick in counts)


@pytest.mark.parametrize("study", charts.STUDIES)
def test_the_runs_of_a_study_have_names_of_their_own(study):
    names = [job.name for job in charts.STUDIES[study].jobs(FULL).values()]
    assert len(set(names)) == len(names)


def test_statistics_count_what_follows_the_first_latching():
    impacts = [(0, 0.1, 90.0), (0, 0.6, 10.0), (0, 0.7, 30.0), (1, 0.2, 5.0)]
    first, second = statistics_of(make_motion(impacts=impacts))
    assert (first["impacts"], first["median_force_N"]) == (2.0, 20.0)
    assert second["impacts"] == 0.0
    assert math.isnan(second["median_force_N"])
    assert math.isnan(first["sliding_work_J"]), "the program does not say"
    assert set(first) == set(LABELS)


def test_the_fitted_exponent_is_that_of_a_power_law():
    counts = np.array([2.0, 4.0, 8.0, 16.0])
    assert growth.fitted_exponent(counts, 3.0 * counts**1.5) == pytest.approx(1.5)


@pytest.mark.parametrize("count", [1, 2, 5])
def test_further_panels_are_like_the_last(count):
    parameters = with_panels(QUICK.parameters, count)
    assert parameters.panel_count == count
    assert parameters.by_joint("spring_stiffness", count - 1) == (2.5 if count == 1 else 1.875)


def test_the_ratio_is_taken_with_the_cheapest_own_run_of_no_larger_error():
    def row(peer, wall, angle, latch):
        return {"model": "m", "peer": peer, "wall_s": wall, "angle_error_rad": angle, "latch_error_s": latch}

    table = Table((row(0, 0.1, 1e-2, 1e-6), row(0, 0.2, 1e-5, 1e-6), row(0, 0.5, 1e-9, 1e-9)), {})
    assert side_by_side.ratio_at_equal_error(table, row(1, 8.0, 1e-4, 1e-5)) == pytest.approx(40.0)
    assert side_by_side.ratio_at_equal_error(table, row(1, 8.0, 1e-7, 1e-5)) == pytest.approx(16.0)
    assert math.isnan(side_by_side.ratio_at_equal_error(table, row(1, 8.0, 1e-12, 1e-5)))


@pytest.mark.parametrize("model", CONTESTANTS)
def test_no_ensemble_is_compared_with_itself_or_with_a_coarser_one(model):
    """The first with the same panels is the reference of the others."""
    contestants = CONTESTANTS[model]
    assert len(set(contestants)) == len(contestants)
    scene = FULL.deployment(model)
    finest: dict[str, tuple[str, float]] = {}
    for chosen in contestants:
        method, reference = finest.setdefault(
            methods.find_method(chosen.method).size(scene), (chosen.method, chosen.value)
        )
        assert method != chosen.method or reference <= chosen.value


def test_forces_are_those_of_the_members_over_those_of_the_converged_ensemble():
    def run(*forces):
        return Measured(replace(make_motion(), totals={"peak_force": np.array(forces)}), (1.0,))

    own, peer, right = (side_by_side.Case("m", name) for name in ("runge-kutta", "Exudyn", "converged ensemble"))
    results = {
        own: run(20.0, 30.0),
        replace(own, member=1): run(22.0, 30.0),
        peer: Measured(make_motion(), (1.0,)),
        replace(peer, watched=True): run(11.0, 20.0),
        right: run(9.0, 10.0),
        replace(right, member=1): run(11.0, 10.0),
    }
    ratios = side_by_side._force_ratios(own, results)
    assert (ratios["force_ratio_1"], ratios["force_ratio_2"]) == pytest.approx((2.1, 3.0))
    assert (ratios["force_ratio_1_error"], ratios["force_ratio_2_error"]) == pytest.approx((math.hypot(0.1, 0.21), 0.0))
    single = side_by_side._force_ratios(peer, results)
    assert single["force_ratio_1"] == pytest.approx(1.1)
    assert single["force_ratio_1_error"] == pytest.approx(math.hypot(0.1 * math.sqrt(2.0), 0.11))
    assert all(math.isnan(value) for value in side_by_side._force_ratios(replace(own, model="other"), results).values())
