"""Films and pages of controllers' episodes."""

from __future__ import annotations

import re

import gymnasium
import numpy as np
import pytest
from helpers import page_data
from PIL import Image

from agents.commands.showing import record
from solar_env.__main__ import main
from solar_env.environment.registration import DEPLOY
from solar_env.environment.showing.recording import RecordTrajectory

RIGID = ["--model", "rigid-clearance", "--quiet"]


def passive_episode(env):
    _, ended, total = env.reset(seed=0), False, 0.0
    while not ended:
        _, reward, ended, _, info = env.step(np.full(1, 0.1, dtype=np.float32))
        total += reward
    return total, info["deployment"]


def test_a_recorded_episode_stays_the_same_to_the_bit_and_agrees_with_its_figures():
    plain = gymnasium.make(DEPLOY, model="rigid-clearance", deadline=13.0, postlock_window=1.0)
    recorded = RecordTrajectory(plain, output_step=0.002)
    expected = passive_episode(plain)
    assert passive_episode(recorded) == expected
    trajectory, figures = recorded.trajectory, expected[1]
    assert trajectory.latch_times.tolist() == figures["latch_times_s"]
    assert trajectory.postlock_peak_force.tolist() == figures["peak_postlock_force_N"]
    assert trajectory.contact_starts.tolist() == figures["contact_starts"]
    assert len(trajectory.contacts) == trajectory.contact_starts.sum()
    assert trajectory.time[-1] == pytest.approx(figures["duration_s"], abs=0.002)
    assert np.ptp(trajectory.motor_torque[1:, 0]) == 0.0
    assert trajectory.energy_residual < 1e-3 * trajectory.energy_put_in


def test_nothing_recorded_and_a_bad_step_are_refused():
    env = gymnasium.make(DEPLOY, model="rigid-ideal")
    with pytest.raises(gymnasium.error.ResetNeeded, match="nothing recorded"):
        RecordTrajectory(env).trajectory  # noqa: B018
    with pytest.raises(ValueError, match="output_step"):
        RecordTrajectory(env, 0.0)


def test_replay_shows_controllers_side_by_side(tmp_path, capsys):
    path = tmp_path / "page.html"
    assert main(["replay", "--controllers", "passive", "brake", *RIGID, "--html", str(path)]) == 0
    text = path.read_text(encoding="utf-8")
    data = page_data(text)
    assert [motion["name"] for motion in data["motions"]] == ["passive", "brake"]
    assert any(chart["title"].startswith("Contact") or "lands softest" in chart["title"] for chart in data["charts"])
    (forces,) = (chart for chart in data["charts"] if chart["logarithmic"])
    assert forces["limits"] == [0.01, 1000.0]
    assert [line["name"] for line in forces["lines"]] == ["passive", "brake"]
    assert min(min(line["y"]) for line in forces["lines"]) > 0.0, "a logarithm shows no zero"
    charts = {chart["y"]: chart for chart in data["charts"]}
    assert [line["name"] for line in charts["stored energy [J]"]["lines"]] == ["passive", "brake"]
    assert "Made by: solar-env replay" in text
    assert "reward peak impact" in text
    answer = re.search(r'<section id="answer"><p>(.*?)</p>', text)[1]
    rows = {
        row[0]: row[1:]
        for row in (re.findall("<td>(.*?)</td>", line) for line in re.findall("<tr>(.*?)</tr>", text))
        if row
    }
    forces = [float(cell) for cell in rows["peak force after latching [N]"]]
    softest = ("passive", "brake")[int(np.argmin(forces))]
    assert f"Of 2 controllers {softest} lands softest, with at most {min(forces):.3g} N" in answer


@pytest.mark.parametrize("suffix", [".gif", ".mp4"])
def test_record_writes_films_of_any_controller(suffix, tmp_path, monkeypatch):
    if suffix == ".mp4":
        pytest.importorskip("imageio_ffmpeg")
    path = tmp_path / f"film{suffix}"
    kept = record.write_film
    monkeypatch.setattr(record, "write_film", lambda frames, *rest: kept(frames[:12], *rest))
    options = ["--model", "rigid-ideal", "--quiet", "--env-kwargs", "deadline=0.9", "postlock_window=0.1"]
    assert main(["record", "--controller", "passive", *options, "--out", str(path)]) == 0
    if suffix == ".gif":
        with Image.open(path) as film:
            assert film.n_frames == 9
            assert film.info["duration"] == 100
    else:
        import imageio_ffmpeg

        count, seconds = imageio_ffmpeg.count_frames_and_secs(str(path))
        assert count == 9
        assert seconds == pytest.approx(0.9, abs=0.11)


@pytest.mark.parametrize(
    ("command", "word"),
    [
        (["record", "--out", "film.avi"], ".mp4, .gif"),
        (["record", "--speed", "0"], "speed"),
        (["record", "--controller", "nobody"], "nobody"),
        (["replay", "--controllers", "nobody"], "nobody"),
        (["replay", "--html", "no/such/page.html"], "no/such"),
    ],
)
def test_wrong_input_is_refused_before_an_episode(command, word, capsys):
    assert main([*command, "--quiet"]) == 2
    assert word in capsys.readouterr().err
