"""A controller's deployment is shown beside the passive one, from the same episode."""

import numpy as np
from PIL import Image

from agents.commands.showing import show
from agents.laws.passive import Passive
from agents.laws.servo import VelocityProfileServo
from agents.rollout import run_episode
from solar_env.__main__ import execute


def test_the_command_draws_and_animates_the_same_episode_of_every_controller(tmp_path, capsys, monkeypatch):
    shown, captions, drawn = [], [], []
    scaled, draw = show._scaled, show.deployments_figure
    monkeypatch.setattr(show, "run_episode", lambda *given: shown.append(given[1:3]) or run_episode(*given))
    monkeypatch.setattr(show, "_scaled", lambda frame, name: captions.append(name) or scaled(frame, name))
    monkeypatch.setattr(show, "deployments_figure", lambda *given: drawn.append(given[0]) or draw(*given))
    short = ["--env-kwargs", "parameters={'spring_stiffness': 2.0}", "postlock_window=1.0"]
    execute("show", ["--model", "rigid-clearance", "--out", str(tmp_path), "--quiet", *short])
    assert str(tmp_path) in capsys.readouterr().out
    (first, seed), (second, same) = shown
    assert (type(first), type(second), seed) == (Passive, VelocityProfileServo, same)
    with Image.open(tmp_path / show.FIGURE) as figure:
        assert min(figure.size) > 500
    with Image.open(tmp_path / show.ANIMATION) as animation:
        assert animation.size == (show.WIDTH, 2 * (show.CAPTION + round(show.WIDTH * 540 / 960)))
        frames = max(captions.count("passive"), captions.count("servo"))
        assert frames - 2 <= animation.n_frames <= frames, "a GIF keeps one of several frames that are alike"
        top, bottom = (
            np.asarray(animation.convert("RGB").crop((0, y, show.WIDTH, y + show.CAPTION)), int)
            for y in (0, animation.size[1] // 2)
        )
    names = {
        name: np.asarray(
            scaled(np.full((540, 960, 3), 255, np.uint8), name).crop((0, 0, show.WIDTH, show.CAPTION)), int
        )
        for name in ("passive", "servo")
    }
    for caption, name, other in ((top, "passive", "servo"), (bottom, "servo", "passive")):
        ink, own, others = (picture < 128 for picture in (caption, names[name], names[other]))
        assert (ink != own).mean() < 0.2 * (ink != others).mean()
    assert captions[0] == "passive"
    assert captions[-1] == "servo"
    (episodes,) = drawn
    assert not any(step.action.any() for step in episodes["passive"])
    assert any(step.action.any() for step in episodes["servo"])
