"""Every two options of a command together: it does its work, or refuses in one sentence that names both."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from pairs import pairwise

from agents.commands import tune
from agents.configs import CONFIGS
from agents.laws import baselines
from solar_env.__main__ import main
from solar_env.array.methods import INTEGRATOR_NAMES

ARRAY = "parameters={'spring_stiffness':2.0}"
# Of each command: what it is always given, and its options with values.
COMMANDS = {
    "simulate": (
        ["--quiet", "--duration", "0.02"],
        {
            "--model": ("rigid-ideal", "rigid-clearance", "flexible-clearance:4 modes", "flexible-ideal:2 elements"),
            "--set": ("clearance=1e-4", "panel_count=1", "body_fixed=true"),
            "--integrator": INTEGRATOR_NAMES,
            "--step": ("1e-4",),
            "--rtol": ("1e-4",),
            "--output-step": ("0.005",),
            "--plot": ("plot.svg",),
            "--out": ("data.npz", "data.csv"),
            "--json": ("-", "summary.json"),
        },
    ),
    "evaluate": (
        ["--quiet", "--jobs", "1", "--episodes", "1"],
        {
            "--controllers": ("passive", "servo-untuned", "rigid"),
            "--model": ("rigid-ideal", "rigid-clearance"),
            "--env-kwargs": (ARRAY, "driven_joint=1", "observation=history", "action=torque"),
            "--env-id": ("solar_env/DeployRandomised-v2", "solar_env/Deploy-v1"),
            "--seed": ("3",),
            "--out": ("folder",),
        },
    ),
    "replay": (
        ["--quiet"],
        {
            "--controllers": ("passive", "rigid"),
            "--model": ("rigid-ideal",),
            "--env-kwargs": (ARRAY, "deadline=15.0"),
            "--env-id": ("solar_env/DeployRandomised-v2", "solar_env/Deploy-v1"),
            "--out": ("page.html",),
            "--seed": ("3",),
        },
    ),
}
# These need seconds for each case.
SLOW_COMMANDS = {
    "loads": (
        ["one.toml", "--quiet", "--runs", "2", "--window", "0.1"],
        {
            "--model": ("rigid-ideal", "rigid-clearance", "flexible-clearance:2 modes", "flexible-ideal:1 elements"),
            "--deadline": ("5.0", "30.0"),
            "--html": ("page.html",),
            "--hub": ("hub.csv",),
            "--out": ("folder",),
            "--jobs": ("1", "2"),
        },
    ),
    "design": (
        ["one.toml", "--quiet", "--points", "2"],
        {
            "--change": ("latch_damping", "hinge_damping=0,0.1", "spring_stiffness=0.1,0.2"),
            "--keep": ("latch_time < 50", "peak_force < 1"),
            "--least": ("latch_torque", "hub_excursion"),
            "--runs": ("1",),
            "--jobs": ("1", "2"),
            "--seed": ("3",),
            "--out": ("folder",),
        },
    ),
    "compare": (
        ["one.toml", "--quiet", "--points", "6", "--episodes", "1"],
        {
            "--model": ("rigid-ideal", "rigid-clearance"),
            "--env-kwargs": ("torque_limit=0.3", "driven_joint=1", "observation=history", "action=torque"),
            "--jobs": ("1", "2"),
            "--seed": ("3",),
            "--out": ("folder",),
        },
    ),
    "train": (
        ["--quiet", "--jobs", "1", "--timesteps", "64", "--eval-episodes", "1"],
        {
            "--algo": ("ppo", "sac", "cma-es"),
            "--model": ("rigid-ideal",),
            "--env-kwargs": (ARRAY, "driven_joint=1", "observation=history", "action=torque"),
            "--env-id": ("solar_env/DeployRandomised-v2", "solar_env/Deploy-v1"),
            "--hyperparams": ("learning_rate=1e-3", "n_steps=32"),
            "--n-envs": ("2",),
            "--seed": ("3",),
            "--out": ("folder",),
        },
    ),
    "tune": (
        ["--quiet", "--jobs", "1", "--episodes", "8", "--episodes-per-candidate", "1", "--validation-episodes", "1"],
        {
            "--controller": ("pd", "damper"),
            "--model": ("rigid-ideal",),
            "--env-kwargs": (ARRAY, "driven_joint=1", "observation=history", "action=log_rate"),
            "--env-id": ("solar_env/DeployRandomised-v2", "solar_env/Deploy-v1"),
            "--refine": ("solar_env/Deploy-v2",),
            "--seed": ("3",),
        },
    ),
}
CASES = [
    pytest.param([command, *always, *(word for option in row.items() for word in option)], marks=marks)
    for commands, marks in ((COMMANDS, ()), (SLOW_COMMANDS, pytest.mark.slow))
    for command, (always, options) in commands.items()
    for row in pairwise(options)
]


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("words", CASES, ids=" ".join)
def test_two_options_go_together_or_are_refused_by_their_names(words, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("one.toml").write_text("panel_count = 1\n", encoding="utf-8")
    configs = shutil.copytree(CONFIGS, tmp_path / "configs")
    for module in (baselines, tune):
        monkeypatch.setattr(module, "CONFIGS", configs)
    status, printed = main(words), capsys.readouterr()
    if status == 2:
        errors = [line for line in printed.err.splitlines() if line.startswith("error: ")]
        assert len(errors) == 1, printed.err
        given = [word.partition("=")[0].lstrip("-").replace("-", "_") for word in words[1:]]
        told = errors[0].replace("-", "_")
        assert len({word for word in given if word in told}) > 1, errors[0]
        return
    assert status == 0, printed.err
    for option in ("--plot", "--out", "--json"):
        if option in words and words[words.index(option) + 1] != "-":
            assert (tmp_path / words[words.index(option) + 1]).exists()
