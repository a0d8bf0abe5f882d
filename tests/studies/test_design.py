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
from solar_env.studies.design.ground_test import Deployment, as_row, clearances_after, wear_campaign

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
    parameters = fast(1e-7)
    campaigns = [list(wear_campaign(parameters, 10, growth, members=4)) for growth in (0.06, 0.0)]
    assert len(campaigns[0]) <= 4
    assert len(campaigns[1]) == 10
    for before, after in itertools.pairwise(campaigns[1]):
        assert after.clearance == pytest.approx(before.clearance + before.wear, rel=1e-15, abs=0.0)
    (extrapolated, error), (direct, other) = (clearances_after(campaign, 10) for campaign in campaigns)
    initial = campaigns[0][0].clearance
    assert np.all(direct > 1.03 * initial)
    assert np.all(np.abs(extrapolated - direct) < 3.0 * np.hypot(error, other) + 0.01 * (direct - initial))


@pytest.mark.usefixtures("short")
def test_wear_that_changes_nothing_is_simulated_once() -> None:
    (only,) = wear_campaign(fast(1e-14), 1000, 0.01, members=2)
    assert only.repeated == 1000
    clearance, _ = clearances_after([only], 1000)
    # 1e-11 m or so, of 2e-4.
    assert clearance - only.clearance == pytest.approx(1000 * only.wear, rel=1e-6, abs=0.0)
    assert np.all(only.wear > 0.0)
    (only,) = wear_campaign(fast(0.0), 7, 0.0, members=2)
    assert (only.repeated, only.wear.tolist()) == (7, [0.0, 0.0])


def test_wear_between_deployments_is_linear() -> None:
    def deployment(number: int, wear: float, repeated: int) -> Deployment:
        one = np.ones(1)
        return Deployment(number, repeated, 100.0 * one, wear * one, 0.5 * one, one, one)

    campaign = [deployment(0, 1.0, 4), deployment(4, 3.0, 6)]
    clearance, error = clearances_after(campaign, 6)
    assert clearance[0] == pytest.approx(100.0 + sum((1.0, 1.5, 2.0, 2.5, 3.0, 3.0)))
    assert error[0] == pytest.approx(0.5 * np.hypot(1.0 + 0.75 + 0.5 + 0.25, 0.25 + 0.5 + 0.75 + 1.0 + 1.0))
    assert [as_row(deployment, "direct")["repeated"] for deployment in campaign] == [4, 6]


@pytest.mark.usefixtures("short")
def test_ground_tests_are_compared_with_direct_simulation(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for name, value in (("WEAR_COEFFICIENT", 1e-14), ("MEMBERS", 2), ("CHECKED", 2)):
        monkeypatch.setattr(ground_test, name, value)
    assert main(["design", "--ground-tests", "3", "--jobs", "1", "--out", str(tmp_path)]) == 0
    assert {path.name for path in tmp_path.iterdir()} == {"ground_test.csv", "ground_test.png"}
    assert read_table(tmp_path / "ground_test.csv").values("kind") == ("extrapolated", "direct")
    assert "clearances after 2 deployments, direct" in capsys.readouterr().out
