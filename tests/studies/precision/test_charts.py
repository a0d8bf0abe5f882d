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
from solar_env.studies.common.plans import FULL, QUICK, Ensemble
from solar_env.studies.common.tables import Table, read_table
from solar_env.studies.common.timing import Measured
from solar_env.studies.precision import charts, methods, side_by_side, work_precision

MOMENT = replace(
    QUICK,
    models=("rigid-clearance",),
    duration=0.02,
    before_latch=0.02,
    settings=1,
    panels="1 element",
    ensemble_size=2,
    ensemble_duration=0.02,
    levels=(Ensemble("", 1), Ensemble("1 element", 2), Ensemble("8 modes", 1, 2.0)),
    side_duration=0.02,
)
FIGURES = {
    "work-precision": {"angles.png", "work_precision.md"},
    "convergence": {"convergence.png", "convergence.md"},
    "side-by-side": {"side_by_side.png", "side_by_side.md"},
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
    assert {path.name for path in folder.iterdir()} == set(map(charts.table_file, charts.STUDIES))
    for study in charts.STUDIES:
        command = read_table(folder / charts.table_file(study)).provenance["command"]
        assert command == f"solar-env study precision --only {study} --quick"


@pytest.mark.parametrize("study", charts.STUDIES)
def test_figures_are_drawn_from_the_tables_alone(study, tmp_path, measured, monkeypatch):
    folder, _ = measured
    monkeypatch.setattr(charts, "measure_charts", None)
    shutil.copy(folder / charts.table_file(study), tmp_path)
    assert main(["study", "precision", "--draw", "--only", study, "--out", str(tmp_path)]) == 0
    drawn = {path.name for path in tmp_path.iterdir() if path.suffix != ".csv"}
    assert drawn == FIGURES[study]
    assert all((tmp_path / name).stat().st_size > 100 for name in drawn)


def test_the_command_measures_and_draws_and_the_same_table_gives_the_same_figure(tmp_path, monkeypatch):
    monkeypatch.setattr(charts, "QUICK", MOMENT)
    arguments = ["study", "precision", "--only", "side-by-side", "--out", str(tmp_path)]
    assert main([*arguments, "--quick"]) == 0
    figure = (tmp_path / "side_by_side.png").read_bytes()
    assert main([*arguments, "--draw"]) == 0
    assert (tmp_path / "side_by_side.png").read_bytes() == figure


def test_every_method_has_a_row_with_costs_errors_and_energy(measured):
    folder, _ = measured
    rows = read_table(folder / "work_precision.csv")
    assert set(rows.values("method")) == {"runge-kutta", "modal-radau", "generalized-alpha", "paper's scheme"}
    reference = rows.where(method="runge-kutta", value=1e-12)
    assert reference.column("angle_error_rad")[0] == 0.0
    for name in ("wall_s", "steps", "evaluations", "angle_error_rad", "energy_residual"):
        assert np.isfinite(rows.column(name)).all(), name
    assert np.isnan(rows.column("latch_error_s")).all(), "nothing latches in a moment"
    assert np.all((rows.column("floor_rad") > 0.0) & (rows.column("floor_rad") < 1e-4))


def method_rows(errors, model="rigid-ideal", floor=1e-12):
    """Rows of a method, ten times as many steps from each to the next."""
    steps = 100.0 * 10.0 ** np.arange(len(errors))
    rows = ({"model": model, "steps": n, "evaluations": math.nan, "angle_error_rad": e, "floor_rad": floor, "wall_s": n}
            for n, e in zip(steps, errors, strict=True))  # fmt: skip
    return Table(tuple(rows), {})


def test_the_observed_order_is_that_of_the_finest_errors_above_the_floor():
    assert work_precision.order(method_rows((1.0, 1e-2, 1e-4, 1e-6))) == pytest.approx(2.0)
    assert work_precision.order(method_rows((5.0, 1e-2, 1e-4, 1e-6))) == pytest.approx(2.0)
    assert work_precision.order(method_rows((1e-3, 1e-6, 1e-9, 2e-12))) == pytest.approx(3.0)
    assert math.isnan(work_precision.order(method_rows((1e-6, 1e-9, 2e-12))))
    assert math.isnan(work_precision.order(method_rows((1.0, 1e-2, 1e-4), model="rigid-clearance")))


def test_the_cheapest_setting_is_one_within_the_goal():
    assert work_precision.cheapest(method_rows((1e-2, 5e-5, 1e-6)))["angle_error_rad"] == 5e-5
    assert work_precision.cheapest(method_rows((1e-2, 0.0))) is None


def test_drawing_without_tables_says_what_to_do(tmp_path, capsys):
    assert main(["study", "precision", "--draw", "--only", "side-by-side", "--out", str(tmp_path)]) == 2
    message = capsys.readouterr().err
    assert "side_by_side.csv" in message
    assert "measure first" in message


@pytest.mark.parametrize("study", charts.STUDIES)
def test_the_runs_of_a_study_have_names_of_their_own_and_the_quick_plan_is_the_smaller(study):
    full, quick = ([job.name for job in charts.STUDIES[study].runs(plan).values()] for plan in (FULL, QUICK))
    assert len(set(full)) == len(full) > len(quick) > 0


def test_the_ratio_is_taken_with_the_cheapest_own_run_of_no_larger_error():
    def row(peer, wall, angle, latch):
        return {"model": "m", "peer": peer, "wall_s": wall, "angle_error_rad": angle, "latch_error_s": latch}

    table = Table((row(0, 0.1, 1e-2, 1e-6), row(0, 0.2, 1e-5, 1e-6), row(0, 0.5, 1e-9, 1e-9)), {})
    assert side_by_side.ratio_at_equal_error(table, row(1, 8.0, 1e-4, 1e-5)) == pytest.approx(40.0)
    assert side_by_side.ratio_at_equal_error(table, row(1, 8.0, 1e-7, 1e-5)) == pytest.approx(16.0)
    assert math.isnan(side_by_side.ratio_at_equal_error(table, row(1, 8.0, 1e-12, 1e-5)))


def test_forces_are_those_of_the_members_over_those_of_the_converged_ensemble():
    def run(*forces):
        return Measured(replace(make_motion(), totals={"peak_force_N": np.array(forces)}), (1.0,))

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
