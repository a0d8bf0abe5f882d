"""The command loads: files that it writes, what it refuses before it runs, and how it goes on."""

from __future__ import annotations

import re

import numpy as np
import pytest
from helpers import page_data

from solar_env.__main__ import main
from solar_env.array import read_parameters
from solar_env.studies.common.motion import Level
from solar_env.studies.loads import ensemble
from solar_env.studies.loads.runs import deploy

FAST = """
body_mass = 1200
body_inertia = 300
spring_stiffness = [2.5, 1.875]
cable_preload_force = 1250.0
[randomize]
clearance = [1.9e-4, 2.1e-4]
"""


@pytest.fixture
def array(tmp_path):
    (tmp_path / "my_array.toml").write_text(FAST)
    return tmp_path / "my_array.toml"


def test_it_answers_and_writes_page_data_and_loads_on_the_hub(array, tmp_path, capsys, monkeypatch):
    files = {name: tmp_path / name for name in ("loads.html", "hub.csv")}
    monkeypatch.setattr(ensemble, "FINEST", Level("rigid-clearance", tighter=2.0))
    options = ["--model", "rigid-clearance", "--runs", "1", "--window", "0.3", "--jobs", "1"]
    usual = ["loads", str(array), *options, "--out", str(tmp_path / "runs")]
    assert main([*usual, "--html", str(files["loads.html"])]) == 0
    first = capsys.readouterr().out
    assert "is hit hardest" in first
    assert "Fewer than 4 runs have no interval" in " ".join(first.split())
    assert "acceleration of the hub [m/s2]" in first, "brackets are no markup"
    text = files["loads.html"].read_text(encoding="utf-8")
    assert "is hit hardest" in text
    (wear,) = (chart for chart in page_data(text)["charts"] if chart["polar"])
    assert wear["y"] == "fm"
    deepest = max(max(line["y"]) for line in wear["lines"])
    assert f"{float(f'{deepest:.3g}'):g} fm" in wear["title"], "in the unit of its axis"
    assert re.search(r"solar-env \d.*numba", text)
    # The runs are there: the second time only reads them.
    kept = (tmp_path / "runs" / "loads.jsonl").read_bytes()
    assert main([*usual, "--hub", str(files["hub.csv"])]) == 0
    assert (tmp_path / "runs" / "loads.jsonl").read_bytes() == kept
    assert capsys.readouterr().out == first

    trajectory = deploy(Level("rigid-clearance"), read_parameters(array).parameters, 0, 0.3, 60.0).trajectory
    table = np.genfromtxt(files["hub.csv"], delimiter=",", names=True)
    turned = (table["torque_z_Nm"] * (table["end_s"] - table["start_s"])).cumsum() / table["hub_inertia_kgm2"]
    assert set(table["hub_mass_kg"]) == {1200.0}, "of the file's array"
    assert set(table["hub_inertia_kgm2"]) == {300.0}
    last = trajectory.velocities[-1, :4]
    ends = trajectory.coordinates[-1, :4]
    along = ends[2:] - ends[:2]
    spin = (along[0] * (last[3] - last[1]) - along[1] * (last[2] - last[0])) / (along @ along)
    assert turned[-1] == pytest.approx(spin, rel=1e-6)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--hub", "hub.npz"], ["suffix", ".npz", ".csv"]),
        (["--html", "page.pdf"], ["suffix", ".pdf", ".html"]),
        (["--html", "no/such/page.html"], ["folder", "no/such/page.html"]),
        (["--runs", "-1"], ["runs", "-1"]),
        (["--model", "rigid-ideal"], ["rigid-ideal", "clearance"]),
        (["--window", "-1"], ["window", "-1"]),
        (["--window", "nan"], ["window", "nan"]),
        (["--jobs", "0"], ["jobs", "0"]),
    ],
)
def test_wrong_input_is_refused_before_anything_is_compiled(options, words, array, capsys, monkeypatch):
    monkeypatch.setattr("solar_env.commands.warmup.warm_up", lambda *_: pytest.fail("kernels are loaded"))
    assert main(["loads", str(array), *options]) == 2
    message = capsys.readouterr().err
    for word in words:
        assert word in message


def test_without_runs_motorization_and_frequencies_are_told(array, capsys):
    assert main(["loads", str(array), "--runs", "0"]) == 0
    told = capsys.readouterr().out
    assert told.startswith("Motorization: ")
    assert "Hz with its hub held" in told


def test_a_wing_on_the_ground_has_margins_and_frequencies_and_tolerances_weaken_springs(tmp_path, capsys):
    file = tmp_path / "ground.toml"
    file.write_text("body_fixed = true\ngravity = 1.0\noffloading_share = 0.9999\nhinge_friction_torque = 0.01\n")
    file.write_text(file.read_text() + "spring_preload_angle = [2.5, 4.5]\n")
    assert main(["loads", str(file), "--runs", "0"]) == 0
    nominal = capsys.readouterr().out
    file.write_text(file.read_text() + "[tolerance]\nspring_stiffness = [0.02, 0.02]\n")
    assert main(["loads", str(file), "--runs", "0"]) == 0
    shares = [float(re.search(r"joint 1: ([\d.]+) times", text)[1]) for text in (nominal, capsys.readouterr().out)]
    assert shares[1] == pytest.approx(0.8 * shares[0], rel=0.05)


def test_an_array_whose_springs_stall_is_refused_before_the_ensemble(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(ensemble, "measure_loads", lambda *_: pytest.fail("runs the ensemble"))
    file = tmp_path / "dead.toml"
    file.write_text("spring_preload_angle = [0.8, 1.6]\ncable_stiffness = 0.0\n")
    assert main(["loads", str(file), "--deadline", "20", "--quiet", "--out", str(tmp_path / "out")]) == 2
    assert "not all joints latch within 20 s; joint 1: no torque left from 0.8" in capsys.readouterr().err
