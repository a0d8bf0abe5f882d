"""Maps of designs, and campaigns in which wear is carried over."""

import itertools
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from solar_env.__main__ import main
from solar_env.array import ArrayParameters
from solar_env.studies.common.plans import FAST_PARAMETERS
from solar_env.studies.common.tables import read_table
from solar_env.studies.design import design_map, ground_test
from solar_env.studies.design.ground_test import wear_campaign

FAST_DURATION = 4.0


def fast(wear_coefficient: float, **changes: Any) -> ArrayParameters:
    return FAST_PARAMETERS.with_changes({"wear_coefficient": wear_coefficient, **changes})


@pytest.fixture
def short(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ground_test, "DURATION", FAST_DURATION)


def test_a_cell_holds_every_member_of_its_ensemble(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(design_map, "DURATION", 0.5)
    cell = {"preset": "default", "map": "clearances", "x": 1e-4, "y": 3e-4, "members": 2}
    result = design_map.measure_cell(cell)
    assert np.shape(result["wear_m"]) == np.shape(result["force_N"]) == (2, 2)
    assert result == design_map.measure_cell(cell)
    assert result["wear_m"] != design_map.measure_cell({**cell, "x": 3e-4})["wear_m"]


def test_both_axes_of_both_maps_are_varied() -> None:
    assert design_map.MAPS["clearances"].changes(1e-4, 3e-4) == {"clearance": (1e-4, 3e-4)}
    parameters = ArrayParameters().with_changes(design_map.MAPS["stiffnesses"].changes(300.0, 40.0))
    assert (parameters.latch_stiffness, parameters.cable_stiffness) == (300.0, 40.0)


def test_the_design_command_measures_resumes_and_draws(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    clearances, stiffnesses = design_map.MAPS.values()
    small = {
        "clearances": replace(clearances, x_values=(1e-4, 2e-4), y_values=(1e-4,), marked=((2e-4, 1e-4),)),
        "stiffnesses": replace(stiffnesses, x_values=(1e3,), y_values=(10.0, 20.0)),
    }
    for module in ("design_map", "plots"):
        monkeypatch.setattr(f"solar_env.studies.design.{module}.MAPS", small)
    monkeypatch.setattr(design_map, "DURATION", 13.0)
    command = ["design", "--members", "1", "--jobs", "1", "--out", str(tmp_path)]
    assert main(command) == 0
    assert {path.name for path in tmp_path.iterdir()} == {"design.csv", "design.jsonl", "design.png"}
    table = read_table(tmp_path / "design.csv")
    assert len(table.rows) == 4
    joints = np.stack([table.column("force_N_joint_1"), table.column("force_N_joint_2")])
    assert table.column("force_N") == pytest.approx(joints.max(axis=0))

    def refuse(cell: Any) -> None:
        raise AssertionError(cell)

    refuse.__module__, refuse.__qualname__ = design_map.__name__, "measure_cell"
    monkeypatch.setattr(design_map, "measure_cell", refuse)
    assert main(command) == 0, "nothing is measured again"
    assert main([*command, "paper"]) == 2
    assert "other settings" in capsys.readouterr().err


@pytest.mark.usefixtures("short")
def test_extrapolated_wear_is_that_of_ten_direct_deployments() -> None:
    extrapolated, direct = (list(wear_campaign(fast(1e-7), 10, growth, members=4)) for growth in (0.06, 0.0))
    assert len(extrapolated) <= 4
    assert [deployment.number for deployment in direct] == list(range(10))
    for before, after in itertools.pairwise(direct):
        assert after.clearance == pytest.approx(before.clearance + before.wear, rel=1e-15, abs=0.0)
    ends = [last.clearance + last.repeated * last.wear for last in (extrapolated[-1], direct[-1])]
    grown = ends[1] - direct[0].clearance
    assert np.all(grown > 0.03 * direct[0].clearance)
    errors = [sum(d.repeated * d.wear_error for d in campaign) for campaign in (extrapolated, direct)]
    assert np.all(np.abs(ends[0] - ends[1]) < np.hypot(*errors) + 0.01 * grown)


def test_wear_between_deployments_is_linear(monkeypatch: pytest.MonkeyPatch) -> None:
    wear = iter([1e-5, 1e-5, 3e-5, 3e-5, 3e-5, 3e-5])
    monkeypatch.setattr(ground_test, "_deploy", lambda run: [[next(wear)] * 2, [1.0, 1.0]])
    first, second, third = itertools.islice(wear_campaign(ArrayParameters(clearance=1e-4), 9, 0.41, members=2), 3)
    assert [(one.number, one.repeated) for one in (first, second, third)] == [(0, 4), (4, 1), (5, 2)]
    assert second.clearance == pytest.approx(np.full(2, 1.4e-4)), "as the first predicts"
    # What the first four wore is corrected to 1, 1.5, 2 and 2.5 times 1e-5.
    assert third.clearance == pytest.approx(np.full(2, 1e-4 + 7e-5 + 3e-5))


@pytest.mark.usefixtures("short")
def test_wear_that_changes_nothing_is_simulated_once() -> None:
    (only,) = wear_campaign(fast(1e-14), 1000, 0.01, members=2)
    assert only.repeated == 1000
    assert np.all(only.wear > 0.0)
    (only,) = wear_campaign(fast(0.0), 7, 0.0, members=2)
    assert (only.repeated, only.wear.tolist()) == (7, [0.0, 0.0])


@pytest.mark.usefixtures("short")
def test_ground_tests_are_written_and_drawn(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name, value in (("WEAR_COEFFICIENT", 1e-7), ("MEMBERS", 2)):
        monkeypatch.setattr(ground_test, name, value)
    assert main(["design", "--ground-tests", "3", "--jobs", "1", "--out", str(tmp_path)]) == 0
    assert {path.name for path in tmp_path.iterdir()} == {"ground_test.csv", "ground_test.png"}
    assert read_table(tmp_path / "ground_test.csv").column("repeated").sum() == 3
    assert main(["design", "--ground-tests", "-1", "--out", str(tmp_path)]) == 2
