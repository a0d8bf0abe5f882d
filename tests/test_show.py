"""A controller's deployment is shown beside the passive one, from the same episode."""

from PIL import Image

from agents import show
from agents.rollout import run_episode
from agents.torque_laws import Passive, VelocityProfileServo


def test_the_command_draws_and_animates_the_same_episode_of_every_controller(tmp_path, capsys, monkeypatch):
    shown = []
    monkeypatch.setattr(show, "run_episode", lambda *given: shown.append(given[1:3]) or run_episode(*given))
    short = ["--env-kwargs", "parameters={'spring_stiffness': 2.0}", "postlock_window=1.0"]
    show.main(["--model", "rigid-clearance", "--out", str(tmp_path), "--quiet", *short])
    assert str(tmp_path) in capsys.readouterr().out
    (first, seed), (second, same) = shown
    assert (type(first), type(second), seed) == (Passive, VelocityProfileServo, same)
    with Image.open(tmp_path / show.FIGURE) as figure:
        assert min(figure.size) > 500
    with Image.open(tmp_path / show.ANIMATION) as animation:
        assert animation.size == (show.WIDTH, 2 * (show.CAPTION + round(show.WIDTH * 540 / 960)))
        assert animation.n_frames > 5
