"""The window: keys drive the motor, and every episode's result is printed; without a display."""

from __future__ import annotations

import gymnasium
import numpy as np
import pytest

from solar_env.__main__ import main
from solar_env.environment.registration import DEPLOY

pygame = pytest.importorskip("pygame")
QUICK = ["--model", "rigid-ideal", "--env-kwargs", "control_period=0.5"]


def event(kind, **what):
    return pygame.event.Event(kind, **what)


@pytest.mark.parametrize(("key", "action"), [(pygame.K_RIGHT, 1.0), (pygame.K_LEFT, -1.0), (pygame.K_UP, 0.1)])
def test_keys_drive_the_motor_until_the_window_is_closed(key, action, monkeypatch):
    seen, step = [], gymnasium.Wrapper.step
    monkeypatch.setattr(gymnasium.Wrapper, "step", lambda env, action: seen.append(action) or step(env, action))
    pressed, released = event(pygame.KEYDOWN, key=key), event(pygame.KEYUP, key=key)
    polls = iter([[pressed], [released], [event(pygame.QUIT)]])
    monkeypatch.setattr(pygame.event, "get", lambda: next(polls))
    assert main(["play", *QUICK]) == 0
    np.testing.assert_allclose([seen[0], seen[-1]], [[action], [0.0]])


def test_the_result_of_an_episode_is_its_return(monkeypatch, capsys):
    env = gymnasium.make(DEPLOY, model="rigid-ideal", control_period=0.5)
    env.reset(seed=0)
    expected, steps, ended = 0.0, 0, False
    while not ended:
        _, reward, ended, _, _ = env.step(np.zeros(1, dtype=np.float32))
        expected, steps = expected + reward, steps + 1
    polls = iter([*[[]] * steps, [event(pygame.QUIT)]])
    monkeypatch.setattr(pygame.event, "get", lambda: next(polls))
    monkeypatch.setattr(pygame.time, "Clock", lambda: type("Clock", (), {"tick": lambda self, rate: None})())
    assert main(["play", *QUICK]) == 0
    assert capsys.readouterr().out.startswith(f"return {expected:.3f}, peak force after latching")


@pytest.mark.parametrize("driver", ["offscreen", "dummy"])
def test_without_a_display_nothing_is_played_and_it_says_what_to_do_instead(driver, monkeypatch, capsys):
    monkeypatch.delenv("SDL_VIDEODRIVER")
    monkeypatch.setattr(pygame.display, "get_driver", lambda: driver)
    assert main(["play", *QUICK]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    for word in ("no display", repr(driver), "solar-env replay"):
        assert word in line


def test_a_driver_that_does_not_work_is_told_in_the_same_words(monkeypatch, capsys):
    def fail():
        raise pygame.error("x11 not available")

    monkeypatch.setattr(pygame.display, "init", fail)
    assert main(["play", *QUICK]) == 2
    assert "no display for a window (x11 not available); " in capsys.readouterr().err


@pytest.mark.parametrize(
    ("options", "word"),
    [(["--model", "rigid"], "rigid"), (["--env-id", "x/y-v0"], "x/y-v0"), (["--env-kwargs", "torq=1"], "torque_limit")],
)
def test_wrong_input_is_refused(options, word, capsys):
    assert main(["play", *options]) == 2
    assert word in capsys.readouterr().err
