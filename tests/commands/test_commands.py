"""The command line does what its help says, and refuses wrong input before the compiler is loaded."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import warnings
from dataclasses import make_dataclass
from types import SimpleNamespace

import numpy as np
import pytest

from solar_env.__main__ import main
from solar_env.array import MODELS
from solar_env.array.deployment import hub_turn, simulate
from solar_env.commands import table
from solar_env.commands.arguments import parse_assignments
from solar_env.commands.studies import figures
from solar_env.environment.registration import DEPLOY
from solar_env.mechanics.integrators.settings import INTEGRATORS
from solar_env.mechanics.running.diagnosis import SimulationWarning
from solar_env.support.readme import PACKAGE

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


def test_simulate_writes_summary_trajectory_and_figure(tmp_path, capsys):
    from solar_env import Trajectory

    model = "flexible-clearance:2 elements"
    files = {name: tmp_path / f"run.{name}" for name in ("json", "npz", "png")}
    status = main(
        ["simulate", "--model", model, "--duration", "4",
         "--set", "clearance=1e-4,2e-4", "friction_coefficient=0.1", "spring_stiffness=2",
         "--json", str(files["json"]), "--out", str(files["npz"]), "--plot", str(files["png"])]
    )  # fmt: skip
    assert status == 0
    summary = json.loads(files["json"].read_text())
    assert set(summary) >= REQUIRED_KEYS
    assert (summary["model"], summary["status"]) == (model, "completed")
    assert None not in summary["latch_times_s"]
    trajectory = Trajectory.load(files["npz"])
    assert trajectory.summary() | {"hub_turn_deg": np.degrees(hub_turn(trajectory)[-1])} == summary
    assert np.array_equal(trajectory.clearance, [1e-4, 2e-4])
    assert trajectory.metadata["model"] == model
    assert trajectory.coordinates.shape[1] == 4 + 2 * 12
    assert files["png"].stat().st_size > 10_000
    shown = capsys.readouterr().out
    for name in ("peak_contact_force_N", "postlock_impulse_Ns"):
        assert ", ".join(f"{entry:.5g}" for entry in summary[name]) in shown


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--model", "rigid"], ["rigid", "rigid-ideal", "flexible-clearance"]),
        (["--model", "flexible-ideal:1001 elements"], ["elements", "1001"]),
        (["--model", "flexible-ideal:modes"], ["flexible-ideal:modes", "8 modes"]),
        (["--model", "rigid-clearance:8 modes"], ["8 modes", "rigid panels", "leave out"]),
        (
            ["--model", "flexible-ideal:2 modes", "--integrator", "rosenbrock"],
            ["2 modes", "rosenbrock", "leave out"],
        ),
        (["--set", "panel_young=0"], ["panel_young", "0"]),
        (["--set", "clearence=1e-4"], ["clearence", "clearance"]),
        (["--set", "clearance"], ["clearance", "key=value", "--help"]),
        (["--set", "clearance=0"], ["clearance", "positive"]),
        (["papers"], ["papers", "paper"]),
        (["array.toml"], ["array.toml", "No such file"]),
        (["--integrator", "euler"], ["euler", "runge-kutta"]),
        (["--integrator", "paper", "--step", "0"], ["step", "0.0"]),
        (["--integrator", "paper", "--rtol", "1e-3"], ["rtol", "step is fixed"]),
        (["--duration", "nan"], ["duration", "nan"]),
        (["--output-step", "1e-9"], ["output_step", "1e-09", "samples", "choose"]),
        (["--step", "nan"], ["step", "nan"]),
        (["--rtol", "-1"], ["rtol", "-1"]),
        (["--out", "no/such/folder/run.npz"], ["folder", "no/such/folder"]),
        (["--out", "run.xlsx"], ["suffix", ".xlsx", ".csv, .npz"]),
        (["--durration", "1"], ["--durration", "--help"]),
    ],
)
def test_wrong_input_exits_with_2_and_names_the_thing_before_anything_is_compiled(
    arguments, words, capsys, monkeypatch
):
    monkeypatch.setattr("solar_env.commands.warmup.warm_up", lambda *_: pytest.fail("kernels are loaded"))
    assert main(["simulate", *arguments]) == 2
    message = capsys.readouterr().err
    for word in words:
        assert word in message


@pytest.mark.parametrize("integrator", ["generalized-alpha", "paper"])
@pytest.mark.parametrize("model", ["rigid-ideal", "flexible-clearance:1 element"])
def test_every_model_runs_with_the_other_integrators_too(model, integrator, capsys):
    arguments = ["--model", model, "--duration", "0.4", "--integrator", integrator]
    clearance = "clearance" in model
    # The step does not resolve impacts. How soon the paper's scheme lets constraint forces alternate hangs on rounding.
    quiet = warnings.catch_warnings(action="ignore", category=SimulationWarning)
    with pytest.warns(SimulationWarning) if clearance else quiet:
        assert main(["simulate", *arguments, "--json", "-"]) == 0
    summary = json.loads(capsys.readouterr().out)
    expected = simulate(model=model, duration=0.4).angles[-1]
    # The fixed step of 0.1 ms is coarse for the first impacts of the journals: steps a thousandth apart come out 5e-4
    # rad apart, and 7e-4 rad from half the step.
    assert summary["theta_end_rad"] == pytest.approx(expected, rel=1e-2, abs=1e-3 if clearance else 0.0)
    assert summary["energy_residual_J"] < 1e-4


def test_simulate_takes_the_default_integrator_of_the_model(capsys):
    for model, integrator, *options in (
        ("rigid-ideal", "runge-kutta"),
        ("flexible-ideal:1 element", "rosenbrock"),
        ("flexible-ideal", "modal-radau"),
        ("flexible-clearance:2 modes", "modal-radau", "paper"),
    ):
        assert main(["simulate", *options, "--model", model, "--duration", "0.1", "--json", "-"]) == 0
        assert json.loads(capsys.readouterr().out)["integrator"] == integrator


def test_warmup_names_every_model_and_environment(capsys, monkeypatch):
    loaded = [(integrator, [0.1] * len(MODELS)) for integrator in INTEGRATORS]
    monkeypatch.setattr("solar_env.commands.warmup.compile_side_by_side", lambda: loaded)
    assert main(["warmup"]) == 0
    printed = capsys.readouterr().out
    for name in (*MODELS, DEPLOY):
        assert name in printed


@pytest.mark.slow
def test_figures_draws_every_picture(tmp_path, monkeypatch):
    assert main(["study", "figures", "--out", str(tmp_path / "new")]) == 0
    assert {path.name for path in (tmp_path / "new").iterdir()} == {path.name for path in figures.PICTURES}
    assert all(path.is_file() for path in figures.PICTURES), "those of the pages"


def test_a_run_that_cannot_go_on_exits_with_2_and_says_when_and_why(capsys):
    assert main(["simulate", "--duration", "2", "--integrator", "paper", "--step", "0.05"]) == 2
    message = capsys.readouterr().err
    assert "at t =" in message
    assert "Newton" in message
    assert "reduce the step" in message


def test_changes_are_parsed_as_numbers_tuples_and_words():
    changes = parse_assignments(["clearance=1e-4,2e-4", "panel_count=3", "contact_law=flores", "body_fixed=True"])
    assert changes == {"clearance": (1e-4, 2e-4), "panel_count": 3, "contact_law": "flores", "body_fixed": True}


def test_help_of_the_packages_commands_needs_no_compiler(run_python):
    program = """
import sys
from solar_env.__main__ import main
from solar_env.commands import table
assert main(["--help"]) == 0
assert "agents.commands.train" not in sys.modules
for name, module in table.rows(table.COMMANDS).items():
    assert module.startswith("agents") or main([name, "--help"]) == 0
assert "numba" not in sys.modules
"""
    run_python(program)


# What `pip install solar-env` does not bring along, by the names that are imported.
OPTIONAL = (
    *("onnx", "onnxruntime", "pygame", "moviepy", "Basilisk", "exudyn", "pdoc"),
    *("hypothesis", "importlinter", "mypy", "pytest"),
)


def test_help_of_every_command_needs_no_optional_package(run_python):
    program = """
import contextlib, io, sys
sys.modules.update(dict.fromkeys(sys.argv[1:]))  # None: not to be imported
from solar_env.__main__ import main
from solar_env.commands import table
for name in table.rows(table.COMMANDS):
    with contextlib.redirect_stdout(io.StringIO()) as shown:
        assert main([name, "--help"]) == 0, name
    assert f"usage: solar-env {name}" in shown.getvalue(), name
    print(name)
"""
    assert run_python(program, *OPTIONAL).split() == list(table.rows(table.COMMANDS))


def test_a_missing_or_unknown_command_is_an_error(capsys):
    assert main([]) == 2
    assert "usage: solar-env COMMAND" in capsys.readouterr().err
    assert main(["simulte"]) == 2
    assert "command 'simulte' is unknown; did you mean 'simulate'?" in capsys.readouterr().err


def test_help_names_every_command_and_version_the_version(capsys):
    assert main(["--help"]) == 0
    printed = capsys.readouterr().out
    for name, summary in table.summaries(table.COMMANDS, "Args").items():
        assert re.search(rf"^  {name} +{re.escape(summary)}$", printed, re.MULTILINE), name
    assert max(map(len, printed.splitlines())) <= 80
    assert main(["--version"]) == 0
    assert re.fullmatch(r"solar-env \d+\.\d+\.\d+\n", capsys.readouterr().out)


def test_commands_are_what_is_installed_and_beside_the_source_what_that_says(monkeypatch, tmp_path):
    rows = table.rows(table.COMMANDS)
    assert {"simulate", "train", "study"} <= set(rows)
    monkeypatch.setattr(table, "entry_points", lambda group: [SimpleNamespace(name="of-another", value="another")])
    assert table.rows(table.COMMANDS) == dict(sorted({**rows, "of-another": "another"}.items()))
    monkeypatch.setattr(table, "PACKAGE", tmp_path / "installed")
    assert table.rows(table.COMMANDS) == {"of-another": "another"}


def test_a_folder_of_the_users_called_agents_hides_nothing(tmp_path):
    (tmp_path / "agents").mkdir()
    (tmp_path / "agents" / "__init__.py").write_text("")
    words = [sys.executable, "-m", "solar_env", "tune", "--help"]
    environment = {**os.environ, "PYTHONPATH": str(PACKAGE.parent)}
    done = subprocess.run(words, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert "usage: solar-env tune" in done.stdout, done.stderr


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["pappr"], "study 'pappr' is unknown; did you mean 'paper'? (solar-env study --help lists them)"),
        (["stability", "--only", "impacts"], "part of the study stability 'impacts' is unknown; choose from impact-"),
        (["figures", "--draw", "--jobs", "2"], "study figures takes no --jobs; it takes --out, --readme"),
        (["paper", "--readme", "--out", "here"], "--readme writes into the page of the study: leave out --out, or"),
    ],
)
def test_a_study_refuses_what_it_does_not_have_or_take(words, told, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["study", *words]) == 2
    assert told in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_quiet_leaves_out_the_progress(tmp_path, capsys):
    assert main(["simulate", "--duration", "0.2", "--json", str(tmp_path / "run.json"), "--quiet"]) == 0
    assert capsys.readouterr().err == ""


def test_simulate_reads_a_file_of_parameters_and_writes_a_table(tmp_path, capsys):
    (tmp_path / "my.toml").write_text("clearance = 1e-4\nbody_mass = 2000\n[randomize]\nclearance = [9e-5, 1.1e-4]\n")
    files = ["--json", "-", "--out", str(tmp_path / "run.csv")]
    assert main(["simulate", str(tmp_path / "my.toml"), "--duration", "0.2", "--set", "body_mass=1900", *files]) == 0
    told = json.loads(capsys.readouterr().out)
    expected = simulate({"clearance": 1e-4, "body_mass": 1900}, duration=0.2)
    assert told["theta_end_rad"] == expected.angles[-1].tolist()
    columns = np.genfromtxt(tmp_path / "run.csv", delimiter=",", names=True)
    np.testing.assert_array_equal(columns["angle_rad_1"], expected.angles[:, 0])
    np.testing.assert_array_equal(columns["kinetic_J"], expected.energies["kinetic"])
    np.testing.assert_array_equal(columns["gap_m_1"], -expected.penetration[:, 0])


def test_stability_measures_a_map_draws_it_and_exits_with_1_if_a_failure_passed_in_silence(tmp_path, capsys):
    arguments = ["study", "stability", "--only", "friction", "--out", str(tmp_path)]
    assert main([*arguments, "--quick"]) == 0
    assert {path.name for path in tmp_path.iterdir()} == {"friction.csv", "friction.png"}
    printed = capsys.readouterr().out
    assert "friction: 2 stiff, 16 creeps, 10 refused, 2 fine" in printed
    assert "take v0 = 0" in printed
    # Drawn again, from the table alone.
    measured = tmp_path / "friction.csv"
    measured.write_text(measured.read_text().replace(",error,", ",,"))
    assert main([*arguments, "--draw"]) == 1
    assert "passed without a word" in capsys.readouterr().out


def test_a_missing_table_exits_with_2(tmp_path, capsys):
    assert main(["study", "stability", "--draw", "--out", str(tmp_path)]) == 2
    assert "impact-implicit.csv" in capsys.readouterr().err


def test_a_warning_is_shown_on_one_line(monkeypatch, capsys):
    def run_command(args):
        print(warnings.formatwarning("an impact got 3 steps", UserWarning, "file.py", 1), end="")
        return 0

    monkeypatch.setattr(
        table, "load", lambda *_: SimpleNamespace(Args=make_dataclass("Args", []), run_command=run_command)
    )
    assert main(["simulate"]) == 0
    assert capsys.readouterr().out == "warning: an impact got 3 steps\n"
