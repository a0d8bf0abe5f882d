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
from solar_env.verification.arrays.deployments import REDUCTIONS
from solar_env.verification.arrays.theory import latch_time
from solar_env.verification.checks import Check, make_table, to_json
from solar_env.verification.impacts.impact import restitution
from solar_env.verification.linkages.pendulum import exact_pendulum, exact_period

CHECK = Check("length [m]", expected=2.0, obtained=2.02, tolerance=0.05, source="a ruler", case="made up")
# Longer than a few seconds.
SLOW = {"spin-up", "array-impacts", "modal-array-impacts", "modal-spin-up"}


@pytest.mark.parametrize("name", [pytest.param(n, marks=pytest.mark.slow) if n in SLOW else n for n in suite.CASES])
def test_every_case_of_the_suite_passes(name):
    checks = suite.run(name)
    assert checks
    failed = [f"{one.quantity}: {one.obtained:.9g} instead of {one.expected:.9g}" for one in checks if not one.passed]
    assert not failed
    assert json.loads(to_json(checks))["passed"] is True


def test_a_wrong_expectation_fails():
    for check in suite.run("single-impact"):
        shift = 2.0 * check.tolerance * (abs(check.expected) if check.relative else 1.0) + 1e-12
        for wrong in (check.expected + shift, check.expected - shift):
            assert not replace(check, expected=wrong).passed


def test_error_is_absolute_or_relative():
    assert CHECK.error == pytest.approx(0.02)
    assert CHECK.passed
    relative = replace(CHECK, relative=True)
    assert relative.error == pytest.approx(0.01)
    assert not replace(relative, tolerance=0.009).passed


@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_a_number_that_is_not_finite_never_passes(value):
    check = replace(CHECK, obtained=value, tolerance=math.inf)
    assert not check.passed
    assert json.loads(to_json([check]))["rows"][0]["obtained"] is None


def test_table_shows_every_column_and_says_what_failed():
    console = Console(width=120, file=io.StringIO())
    console.print(make_table([CHECK, replace(CHECK, quantity="width [m]", tolerance=0.001, relative=True)]))
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


def test_command_prints_a_table_and_writes_json_to_a_file_or_alone_to_standard_output(tmp_path, capsys):
    path = tmp_path / "rows.json"
    assert run_command("--only", "rolled-beam", "--json", str(path)) == 0
    assert "rolled-beam" in capsys.readouterr().out
    assert run_command("--only", "rolled-beam", "--json", "-") == 0
    data = json.loads(capsys.readouterr().out)
    assert data == json.loads(path.read_text())
    assert set(data["rows"][0]) == {*vars(CHECK), "error", "passed"}


def test_command_fails_if_a_check_fails_and_refuses_unknown_names_and_folders(monkeypatch, capsys, tmp_path):
    monkeypatch.setitem(suite.CASES, "wrong", lambda: iter([replace(CHECK, obtained=1.0)]))
    assert run_command("--only", "wrong") == 1
    assert "FAIL" in capsys.readouterr().out
    with pytest.raises(ValueError, match=r"'pendulums' is unknown; the cases are restitution, "):
        run_command("--only", "pendulums")
    with pytest.raises(ValueError, match="does not exist"):
        run_command("--json", str(tmp_path / "nowhere" / "rows.json"))


class TestTheory:
    """The independent formulations against figures that are known to a few digits."""

    @pytest.mark.parametrize(
        ("law", "coefficient", "ratio"),
        [
            (lankarani_damping, 0.1, 0.6653),
            (lankarani_damping, 0.5, 0.7252),
            (lankarani_damping, 1.0, 1.0),
            (flores_damping, 0.1, 0.0694),
            (flores_damping, 0.9, 0.8939),
        ],
    )
    def test_restitution(self, law, coefficient, ratio):
        assert restitution(law(coefficient)) == pytest.approx(ratio, abs=5e-5)

    def test_pendulum(self):
        assert exact_period() == pytest.approx(2.3678419, abs=1e-7)
        assert exact_pendulum(1.0)[:2] == pytest.approx((-0.98629175, -0.16501085), abs=5e-9)
        assert exact_pendulum(2.0) == pytest.approx((0.79356620, -0.60848393, 17.907683), abs=1e-6)

    def test_latch_times(self):
        for (_, changes), seconds in zip(REDUCTIONS, [12.548, 12.276, 13.95, 13.44, 13.18, 13.62], strict=True):
            assert latch_time(ArrayParameters(**changes)) == pytest.approx(seconds, abs=5e-3)
