import io
import json
import math
from dataclasses import replace

import pytest
from rich.console import Console

from solar_env.array import ArrayParameters
from solar_env.commands import verify as command
from solar_env.commands.arguments import parse_arguments
from solar_env.mechanics.joints.laws import flores_damping, lankarani_damping
from solar_env.verification import suite
from solar_env.verification.arrays.latching import REDUCTIONS
from solar_env.verification.arrays.theory import latch_time, latch_time_by_quadrature
from solar_env.verification.checks import Check, Row
from solar_env.verification.impacts.impact_theory import restitution
from solar_env.verification.linkages.pendulum import exact_pendulum, exact_period
from solar_env.verification.report import make_table, to_json

ROW = Row(case="made up", quantity="length [m]", expected=2.0, obtained=2.02, tolerance=0.05, source="a ruler")


# Longer than a few seconds.
SLOW = {
    "panel-counts",
    "spin-up",
    "flexible-agreement",
    "flexible-impacts",
    "array-impacts",
    "flexible-array-impacts",
    "modal-array-impacts",
}


@pytest.mark.parametrize("name", [pytest.param(n, marks=pytest.mark.slow) if n in SLOW else n for n in suite.CASES])
def test_every_case_of_the_suite_passes(name):
    rows = suite.run(name)
    assert rows
    failed = [f"{row.quantity}: {row.obtained:.9g} instead of {row.expected:.9g}" for row in rows if not row.passed]
    assert not failed
    assert json.loads(to_json(rows))["passed"] is True


@pytest.mark.parametrize("name", ["pendulum", "single-impact", "latch-times"])
def test_a_wrong_expectation_fails(name):
    for row in suite.run(name):
        shift = 2.0 * row.tolerance * (abs(row.expected) if row.relative else 1.0) + 1e-12
        for wrong in (row.expected + shift, row.expected - shift):
            assert not replace(row, expected=wrong).passed


def test_error_is_absolute_or_relative():
    assert ROW.error == pytest.approx(0.02)
    assert ROW.passed
    relative = replace(ROW, relative=True)
    assert relative.error == pytest.approx(0.01)
    assert not replace(relative, tolerance=0.009).passed


@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_a_number_that_is_not_finite_never_passes(value):
    row = replace(ROW, obtained=value, tolerance=math.inf)
    assert not row.passed
    assert row.to_dict()["obtained"] is None


def test_unknown_case_is_refused_with_the_names():
    with pytest.raises(ValueError, match=r"'pendulums' is unknown; the cases are restitution, "):
        suite.run("pendulums")


def test_json_holds_every_column():
    data = json.loads(to_json([ROW]))
    assert data["passed"] is True
    assert data["rows"] == [
        {
            "case": "made up",
            "quantity": "length [m]",
            "expected": 2.0,
            "obtained": 2.02,
            "error": pytest.approx(0.02),
            "tolerance": 0.05,
            "measure": "absolute",
            "source": "a ruler",
            "passed": True,
        }
    ]


def test_table_shows_every_column_and_says_what_failed():
    console = Console(width=120, file=io.StringIO())
    console.print(make_table([ROW, replace(ROW, quantity="width [m]", tolerance=0.001, relative=True)]))
    text = console.file.getvalue()
    assert "2 checks, 1 failed" in text
    assert "made up" in text
    assert text.count("a ruler") == 1
    lines = {line.split()[0]: line.split()[2:] for line in text.splitlines() if "[m]" in line}
    assert lines == {
        "length": ["2", "2.02", "2.0e-02", "5.0e-02", "pass"],
        "width": ["2", "2.02", "1.0e-02r", "1.0e-03r", "FAIL"],
    }


def run_command(*arguments):
    return command.run_command(parse_arguments(command.Args, arguments))


def test_command_prints_a_table_writes_json_and_succeeds(tmp_path, capsys):
    path = tmp_path / "rows.json"
    assert run_command("--only", "contact-stiffness", "--json", str(path)) == 0
    assert "contact-stiffness" in capsys.readouterr().out
    assert json.loads(path.read_text())["passed"] is True


def test_command_keeps_standard_output_clean_for_json(capsys):
    assert run_command("--only", "contact-stiffness", "--json", "-") == 0
    assert json.loads(capsys.readouterr().out)["rows"]


def test_command_fails_if_a_row_fails(monkeypatch, capsys):
    wrong = Check(quantity="half of two", expected=3.0, obtained=1.0, tolerance=0.1, source="a bad guess")
    monkeypatch.setitem(suite.CASES, "wrong", lambda: iter([wrong]))
    assert run_command("--only", "wrong") == 1
    assert "FAIL" in capsys.readouterr().out


def test_command_refuses_a_missing_folder_before_it_runs(tmp_path):
    with pytest.raises(ValueError, match="does not exist"):
        run_command("--json", str(tmp_path / "nowhere" / "rows.json"))


class TestTheory:
    """The independent formulations against figures that are known to a few digits."""

    @pytest.mark.parametrize(
        ("law", "coefficient", "ratio"),
        [
            (lankarani_damping, 0.1, 0.6653),
            (lankarani_damping, 0.5, 0.7252),
            (lankarani_damping, 0.9, 0.9132),
            (lankarani_damping, 1.0, 1.0),
            (flores_damping, 0.1, 0.0694),
            (flores_damping, 0.5, 0.4704),
            (flores_damping, 0.9, 0.8939),
        ],
    )
    def test_restitution(self, law, coefficient, ratio):
        assert restitution(law(coefficient)) == pytest.approx(ratio, abs=5e-5)

    def test_pendulum(self):
        assert exact_period() == pytest.approx(2.3678419, abs=1e-7)
        assert exact_pendulum(1.0)[:2] == pytest.approx((-0.98629175, -0.16501085), abs=5e-9)
        assert exact_pendulum(2.0) == pytest.approx((0.79356620, -0.60848393, 17.907683), abs=1e-6)

    @pytest.mark.parametrize(
        ("changes", "seconds", "digits"),
        list(
            zip(
                [changes for _, changes in REDUCTIONS],
                [12.548, 12.276, 13.95, 13.44, 13.18, 13.62],
                [5e-4, 5e-4, 5e-3, 5e-3, 5e-3, 5e-3],
                strict=True,
            )
        ),
        ids=[name for name, _ in REDUCTIONS],
    )
    def test_latch_times(self, changes, seconds, digits):
        assert latch_time(ArrayParameters(**changes)) == pytest.approx(seconds, abs=digits)

    @pytest.mark.parametrize("fixed", [True, False])
    def test_quadrature_and_equation_of_motion_agree_on_the_latch_time(self, fixed):
        parameters = ArrayParameters(body_fixed=fixed)
        assert latch_time_by_quadrature(parameters) == pytest.approx(latch_time(parameters), abs=1e-9)
