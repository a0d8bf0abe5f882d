"""Films and pages of controllers' episodes."""

from __future__ import annotations

import re

import gymnasium
import numpy as np
import pytest
from helpers import page_data
from PIL import Image

from agents.commands import replay
from solar_env.__main__ import main
from solar_env.environment.registration import DEPLOY_V1
from solar_env.environment.showing import recording
from solar_env.environment.showing.recording import RecordTrajectory
from solar_env.pictures import films
from solar_env.studies.common.deployment_page import scenes_of

RIGID = ["--model", "rigid-clearance", "--quiet"]


def passive_episode(env):
    _, ended, total = env.reset(seed=0), False, 0.0
    while not ended:
        _, reward, ended, _, info = env.step(np.full(1, 0.1, dtype=np.float32))
        total += reward
    return total, info["deployment"]


def test_a_recorded_episode_stays_the_same_to_the_bit_and_agrees_with_its_figures():
    plain = gymnasium.make(DEPLOY_V1, model="rigid-clearance", deadline=13.0, settling_window=1.0)
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


def test_what_was_recorded_after_a_state_that_is_restored_did_not_happen():
    tried, plain = (RecordTrajectory(gymnasium.make(DEPLOY_V1, model="rigid-clearance"), 0.05) for _ in range(2))
    for env in (tried, plain):
        env.reset(seed=0)
        for _ in range(5):
            env.step([0.0])
    simulation = tried.unwrapped.simulation
    before = simulation.snapshot()
    for _ in range(5):
        tried.step([1.0])
    after = simulation.snapshot()
    simulation.restore(before)
    for env in (tried, plain):
        for _ in range(5):
            env.step([-1.0])
    one, other = tried.trajectory, plain.trajectory
    assert np.array_equal(one.angles, other.angles)
    assert np.array_equal(one.motor_torque, other.motor_torque)
    assert np.array_equal(one.contacts, other.contacts)
    simulation.restore(after)
    with pytest.raises(RuntimeError, match="nothing recorded has led to it"):
        tried.step([0.0])


def test_there_is_room_for_any_number_of_contacts(monkeypatch):
    monkeypatch.setattr(recording, "_CONTACTS", 2)
    env = RecordTrajectory(gymnasium.make(DEPLOY_V1, model="rigid-clearance", deadline=13.0, settling_window=1.0))
    passive_episode(env)
    assert len(env.trajectory.contacts) == env.trajectory.contact_starts.sum() > 100


def test_a_page_of_no_landing_says_so(tmp_path):
    path = tmp_path / "page.html"
    short = ["--env-kwargs", "deadline=1.0", "settling_window=0.5"]
    assert main(["replay", "--controllers", "passive", *RIGID, *short, "--out", str(path)]) == 0
    assert "Of 1 controllers none lands" in path.read_text(encoding="utf-8")


def test_nothing_recorded_and_a_bad_step_are_refused():
    env = gymnasium.make(DEPLOY_V1, model="rigid-ideal")
    with pytest.raises(gymnasium.error.ResetNeeded, match="nothing recorded"):
        RecordTrajectory(env).trajectory  # noqa: B018
    with pytest.raises(ValueError, match="output_step"):
        RecordTrajectory(env, 0.0)


def test_replay_shows_controllers_side_by_side(tmp_path, capsys):
    path = tmp_path / "page.html"
    assert main(["replay", "--controllers", "passive", "damper", *RIGID, "--out", str(path)]) == 0
    text = path.read_text(encoding="utf-8")
    data = page_data(text)
    assert [motion["name"] for motion in data["motions"]] == ["passive", "damper"]
    assert any(chart["title"].startswith("Contact") or "lands softest" in chart["title"] for chart in data["charts"])
    charts = {chart["y"]: chart for chart in data["charts"]}
    (forces,) = (chart for chart in data["charts"] if chart["logarithmic"])
    assert forces["limits"] == [0.01, 1000.0]
    for chart in (forces, charts["stored energy [J]"]):
        assert [line["name"] for line in chart["lines"]] == ["passive", "damper"]
    assert min(min(line["y"]) for line in forces["lines"]) > 0.0, "a logarithm shows no zero"
    assert "Made by: solar-env replay" in text
    assert "reward peak impact" in text
    answer = re.search(r'<section id="answer"><p>(.*?)</p>', text)[1]
    rows = {
        row[0]: row[1:]
        for row in (re.findall("<td>(.*?)</td>", line) for line in re.findall("<tr>(.*?)</tr>", text))
        if row
    }
    forces = [float(cell) for cell in rows["peak post-lock force [N]"]]
    softest = ("passive", "damper")[int(np.argmin(forces))]
    assert f"Of 2 controllers {softest} lands softest, with at most {min(forces):.3g} N" in answer


@pytest.mark.parametrize("suffix", replay.FILMS)
def test_a_film_shows_all_controllers_in_their_time(suffix, tmp_path):
    encoder = pytest.importorskip("imageio_ffmpeg")
    path, (width, speed) = tmp_path / f"film{suffix}", replay.FILMS[suffix]
    short = [*RIGID, "--env-kwargs", "deadline=0.9", "settling_window=0.3"]
    assert main(["replay", "--controllers", "passive", "damper", *short, "--out", str(path)]) == 0
    frames = 1 + round(1.8 / (speed / films.FRAMES_PER_SECOND))
    if suffix == ".mp4":
        assert encoder.count_frames_and_secs(str(path)) == (frames, pytest.approx(0.1 * frames, abs=0.11))
        return
    with Image.open(path) as shown:
        assert shown.n_frames == frames
        assert shown.info["duration"] == 100
        assert shown.size == (width, 2 * (films.CAPTION + round(width * 540 / 960)))


def test_a_film_shows_what_happens_while_the_drive_alone_settles_the_array():
    """The step in which the last joint latches lasts until the episode ends."""
    env = RecordTrajectory(gymnasium.make("solar_env/Deploy-v2", model="rigid-clearance", settling_window=2.0))
    env.reset(seed=0)
    while not env.step(np.zeros(1, np.float32))[2]:
        pass
    trajectory, scenes = env.trajectory, scenes_of(env.trajectory, 0.1)
    latched = trajectory.latch_times.max()
    after = [scene for scene in scenes if scene.time > latched]
    assert len(after) == pytest.approx(20, abs=1)
    assert all(scene.latched.all() for scene in after)
    last = scenes[-1]
    history = last.force_history[last.force_times > latched]
    assert len(history) == len(after)
    assert last.force_history.max() == pytest.approx(trajectory.peak_force.max(), rel=1e-6)
    np.testing.assert_allclose(last.panels[0][0], last.hinges[0] + last.eccentricity[0])


def test_every_episode_of_a_film_stands_under_its_controllers_name(tmp_path):
    blank = np.full((540, 960, 3), 255, np.uint8)
    shown_films = [[films.captioned(blank, name, 640)] * count for name, count in (("passive", 1), ("servo", 3))]
    films.write_film(shown_films, tmp_path / "film.gif")
    with Image.open(tmp_path / "film.gif") as shown:
        picture = np.asarray(shown.convert("L"), int)
    for top, (alone, *_) in zip((0, picture.shape[0] // 2), shown_films, strict=True):
        own = np.asarray(alone.convert("L"), int)[: films.CAPTION]
        assert np.abs(picture[top : top + films.CAPTION] - own).mean() < 2.0


@pytest.mark.parametrize(
    ("options", "word"),
    [
        (["--out", "film.avi"], ".html, .mp4, .gif"),
        (["--out", "no/such/page.html"], "no/such"),
        (["--controllers", "nobody"], "nobody"),
    ],
)
def test_wrong_input_is_refused_before_an_episode(options, word, capsys):
    assert main(["replay", *options, "--quiet"]) == 2
    assert word in capsys.readouterr().err
