"""Designs: ranges, conditions, the level that answers, a map and a search whose best design is known."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rich.console import Console

from solar_env.__main__ import main
from solar_env.array import ArrayParameters, ParameterFile
from solar_env.commands.design import ranges
from solar_env.mechanics.running.errors import SimulationError
from solar_env.studies.common.motion import Level
from solar_env.studies.common.tables import read_table
from solar_env.studies.design import points
from solar_env.studies.design.plan import DesignPlan, parse_condition
from solar_env.studies.design.points import Bench
from solar_env.studies.design.search import Design, answer, find_design
from solar_env.studies.loads import ensemble

# One panel on a hub that is held, whose latch has no damping: the peak torque is sqrt(2 k E) of the springs' energy E.
ARRAY = ArrayParameters(
    panel_count=1,
    panel_young=7e10,
    body_fixed=True,
    spring_stiffness=2.0,
    latch_damping=0.0,
    latch_gap=0.0,
    wear_bins=4,
)
FILE = ParameterFile(ARRAY, {})


@pytest.fixture(autouse=True)
def short(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(points, "WINDOW", 0.2)


def plan(change: dict[str, Any], *keep: str, least: str = "latch_torque", **options: Any) -> DesignPlan:
    return DesignPlan(FILE, change, tuple(map(parse_condition, keep)), least, **options)


def found(tmp_path: Path, asked: DesignPlan) -> Design:
    return find_design(Bench(asked, tmp_path, 2, Console(quiet=True)), 0, False)


def test_conditions_are_read_with_spaces_and_count_by_how_much_they_are_missed() -> None:
    condition = parse_condition("latch time < 30")
    assert (str(condition), condition.excess(29.0), condition.excess(33.0)) == (
        "latch_time < 30 s",
        0.0,
        pytest.approx(0.1),
    )
    assert parse_condition("hub_turn>-2e1").bound == -20.0
    for text in ("latch time", "latch_time < soon", "latch_time <= 3", "< 3"):
        with pytest.raises(ValueError, match=r"cannot read the condition|is unknown"):
            parse_condition(text)


def test_ranges_reach_ten_times_either_way_and_a_damper_until_a_minute_is_taken() -> None:
    damping, stiffness = plan({"hinge_damping": None, "latch_stiffness": None}).changes
    assert (stiffness.low, stiffness.high, stiffness.logarithmic) == (100.0, 1e4, True)
    # The mean torque is 2 pi / 4; a quarter turn in a minute, where nothing bounds the latch time.
    assert (damping.low, damping.high, damping.logarithmic) == (0.0, 60.0, False)
    for change in (damping, stiffness):
        for share in (0.0, 0.3, 1.0):
            assert change.share(change.value(share)) == pytest.approx(share, abs=1e-3)
    by_joint = DesignPlan(ParameterFile(ArrayParameters(), {}), {"spring_stiffness": (0.5, 2.0)}, (), "latch_torque")
    assert by_joint.parameters({"spring_stiffness": 2.0}).spring_stiffness == (0.2, 0.15)
    assert by_joint.today() == {"spring_stiffness": 1.0}
    (exponent,) = plan({"latch_exponent": None}).changes
    assert (exponent.low, exponent.high) == (1.0, 10.0), "less is refused"
    assert ranges(["latch_damping", "hinge_damping=0,5"]) == {"latch_damping": None, "hinge_damping": (0, 5)}


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({}, "nothing is to change"),
        ({"latch_dampin": None}, "unknown"),
        ({"contact_law": None}, "is not a real number"),
        ({"hinge_friction_torque": None}, r"give one, hinge_friction_torque=LOW,HIGH"),
        ({"latch_stiffness": (5.0, 1.0)}, "two numbers LOW,HIGH"),
        ({"latch_stiffness": 5.0}, "two numbers LOW,HIGH"),
        ({"latch_stiffness": (-1.0, 1.0)}, "latch_stiffness = -1.0 must be positive"),
    ],
)
def test_changes_without_sense_are_refused(change: dict[str, Any], told: str) -> None:
    with pytest.raises(ValueError, match=told):
        plan(change)


def test_what_a_file_draws_cannot_be_chosen() -> None:
    drawn = ParameterFile(ARRAY, {"latch_stiffness": (1.0, 2.0)})
    with pytest.raises(ValueError, match="latch_stiffness is drawn from a range of the file"):
        DesignPlan(drawn, {"latch_stiffness": None}, (), "latch_torque")
    with pytest.raises(ValueError, match="runs = 0 must be at least 1"):
        plan({"latch_stiffness": None}, members=0)


def test_a_map_finds_the_softest_latch_that_holds_and_says_which_designs_fail(tmp_path: Path) -> None:
    asked = plan({"latch_stiffness": (250.0, 1000.0), "hinge_damping": (0.0, 40.0)}, "latch_time < 3", points=9)
    design = found(tmp_path, asked)
    assert design.level == Level("rigid-clearance"), "one panel on a stiff latch hardly bends"
    assert len(design.points) == 9
    by_place = {tuple(point.values.values()): point for point in design.points}
    energy = 0.5 * ARRAY.spring_stiffness * (np.pi / 2) ** 2
    for stiffness in (250.0, 625.0, 1000.0):
        assert by_place[stiffness, 0.0].figures["latch_torque"] == pytest.approx(
            np.sqrt(2.0 * stiffness * energy), rel=0.01
        )
        assert by_place[stiffness, 40.0].failing == "no latching within 3 s"
    assert design.best is not None
    assert design.best.figures["latch_torque"] == min(p.figures["latch_torque"] for p in design.points if not p.failing)
    assert design.best.values["latch_stiffness"] == 250.0
    lines = answer(design)
    assert lines[0].startswith("latch_stiffness = 250, hinge_damping = ")
    assert lines[1] == "Motorization of this design: joint 1: nothing to overcome."
    assert "It lies at the end of the range of latch_stiffness" in lines[2]
    assert "of 9 designs fail (no latching within 3 s: " in lines[3]
    again = Bench(asked, tmp_path, 1, Console(quiet=True))
    assert again.measured([(design.points[0].values, design.level, 0)]) == [design.points[0]]


def test_a_search_of_three_comes_to_the_corner_where_the_torque_is_least(tmp_path: Path) -> None:
    change = {"latch_stiffness": (250.0, 1000.0), "spring_stiffness": (1.0, 4.0), "panel_density": (190.0, 210.0)}
    design = found(tmp_path, plan(change, "latch_time < 2.5", members=1, points=120))
    assert design.best is not None
    assert design.best.values["latch_stiffness"] == pytest.approx(250.0, rel=0.05)
    # Latching takes a quarter of the free oscillation's period: pi/2 sqrt(I / k), which the condition bounds.
    inertia = design.best.values["panel_density"] * 0.02 * 1.5 * (1.5**2 / 3.0 + 0.02**2 / 12.0)
    assert design.best.figures["latch_time"] == pytest.approx(
        np.pi / 2 * np.sqrt(inertia / design.best.values["spring_stiffness"]), rel=0.01
    )
    assert 2.2 < design.best.figures["latch_time"] < 2.5, "the softest springs that are fast enough"


def test_members_that_fail_and_designs_that_keep_nothing_are_told(tmp_path: Path, monkeypatch: Any) -> None:
    deploy = ensemble.deploy

    def fails(level: Level, parameters: ArrayParameters, *rest: Any) -> Any:
        if parameters.latch_stiffness > 500.0 and level.model == "rigid-clearance":
            raise SimulationError("at t = 1 s the state is no longer finite", 1.0, "not_finite")
        return deploy(level, parameters, *rest)

    monkeypatch.setattr(ensemble, "deploy", fails)
    monkeypatch.setattr(points, "CANDIDATES", ("rigid-clearance",))
    asked = plan({"latch_stiffness": (400.0, 800.0)}, "latch_torque < 1", points=2, members=1)
    design = find_design(Bench(asked, tmp_path, 1, Console(quiet=True)), 0, False)
    assert design.level == Bench(asked, tmp_path, 1, Console(quiet=True)).finest, "the cheaper one fails"
    assert design.best is None
    assert answer(design)[0] == "None of 2 designs keeps latch_torque < 1 N m."


def test_the_command_writes_table_and_picture_and_refuses_in_one_sentence(tmp_path: Path, capsys: Any) -> None:
    file = tmp_path / "array.toml"
    file.write_text("panel_count = 1\nbody_fixed = true\nspring_stiffness = 2.0\nlatch_gap = 0.0\n")
    words = ["design", str(file), "--change", "latch_stiffness=500,1000", "--points", "3", "--runs", "1", "--jobs", "1"]
    assert main([*words, "--out", str(tmp_path / "out"), "--quiet"]) == 0
    assert "latch_stiffness = " in capsys.readouterr().out
    assert {path.name for path in (tmp_path / "out").iterdir()} == {"design.csv", "design.jsonl", "design.png"}
    table = read_table(tmp_path / "out" / "design.csv")
    assert table.column("latch_stiffness").tolist() == [1000.0, 500.0, 750.0, 1000.0], "first the array as it is"
    for wrong, told in ((["--least", "noise"], "noise"), (["--keep", "soon"], "cannot read the condition 'soon'")):
        assert main([*words, *wrong]) == 2
        error = capsys.readouterr().err
        assert told in error
        assert error.count("\n") == 1
