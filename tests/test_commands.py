"""The command line does what its help says, and refuses wrong input before the compiler is loaded."""

from __future__ import annotations

import json
import subprocess
import sys

import numpy as np
import pytest

from solar_env.__main__ import main
from solar_env.commands.simulate import parse_changes

REQUIRED_KEYS = {
    "model",
    "status",
    "latch_times_s",
    "peak_contact_force_N",
    "peak_postlock_force_N",
    "contact_starts",
    "sliding_work_J",
    "wear_depth_max_m",
    "energy_residual_J",
    "steps",
    "rejected_steps",
    "wall_time_s",
    "theta_end_rad",
}


def test_simulate_writes_summary_trajectory_and_figure(tmp_path):
    from solar_env import Trajectory

    files = {name: tmp_path / f"run.{name}" for name in ("json", "npz", "png")}
    status = main(
        ["simulate", "--duration", "14", "--set", "clearance=1e-4,2e-4", "friction_coefficient=0.1",
         "--json", str(files["json"]), "--out", str(files["npz"]), "--plot", str(files["png"])]
    )  # fmt: skip
    assert status == 0
    summary = json.loads(files["json"].read_text())
    assert set(summary) >= REQUIRED_KEYS
    assert (summary["model"], summary["status"]) == ("rigid-clearance", "completed")
    trajectory = Trajectory.load(files["npz"])
    assert trajectory.summary() == summary
    assert np.array_equal(trajectory.clearance, [1e-4, 2e-4])
    assert files["png"].stat().st_size > 10_000


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--model", "rigid"], ["rigid", "rigid-ideal"]),
        (["--set", "clearence=1e-4"], ["clearence", "clearance"]),
        (["--set", "clearance"], ["clearance", "key=value"]),
        (["--set", "clearance=0"], ["clearance", "positive"]),
        (["--set", "body_mass=-1"], ["body_mass", "-1"]),
        (["--set", "clearance=nan"], ["clearance", "finite"]),
        (["--set", "clearance=1e-4,1e-4,1e-4"], ["clearance", "panels"]),
        (["--preset", "papers"], ["papers", "paper"]),
        (["--integrator", "euler"], ["euler", "runge-kutta"]),
        (["--integrator", "paper", "--step", "0"], ["step", "0.0"]),
        (["--integrator", "paper", "--rtol", "1e-3"], ["rtol", "paper"]),
        (["--rtol", "-1"], ["rtol", "-1"]),
        (["--duration", "-1"], ["duration", "-1"]),
        (["--duration", "nan"], ["duration", "nan"]),
        (["--out", "no/such/folder/run.npz"], ["folder", "no/such/folder"]),
    ],
)
def test_wrong_input_exits_with_2_and_names_the_thing(arguments, words, capsys):
    assert main(["simulate", *arguments]) == 2
    message = capsys.readouterr().err
    for word in words:
        assert word in message


def test_a_run_that_cannot_go_on_exits_with_2_and_says_when_and_why(capsys):
    assert main(["simulate", "--duration", "2", "--integrator", "paper", "--step", "0.05"]) == 2
    message = capsys.readouterr().err
    assert "at t =" in message
    assert "Newton" in message
    assert "reduce the step" in message


def test_changes_are_parsed_as_numbers_tuples_and_words():
    changes = parse_changes(["clearance=1e-4,2e-4", "panel_count=3", "contact_law=flores", "body_fixed=True"])
    assert changes == {"clearance": (1e-4, 2e-4), "panel_count": 3, "contact_law": "flores", "body_fixed": True}


def test_help_of_every_command_needs_no_compiler():
    program = (
        "import sys\n"
        "from solar_env.__main__ import COMMANDS, main\n"
        "for name in COMMANDS:\n"
        "    try:\n"
        "        main([name, '--help'])\n"
        "    except SystemExit as stop:\n"
        "        assert stop.code == 0\n"
        "assert 'numba' not in sys.modules\n"
    )
    subprocess.run([sys.executable, "-c", program], check=True, capture_output=True)


def test_a_missing_command_is_an_error():
    with pytest.raises(SystemExit) as stop:
        main([])
    assert stop.value.code == 2
