"""The window: keys move the torque, the episode goes on, pauses and begins anew; without a display."""

from __future__ import annotations

import gymnasium
import numpy as np
import pytest

from solar_env.__main__ import main
from solar_env.environment.registration import DEPLOY_V1

pygame = pytest.importorskip("pygame")


@pytest.fixture
def player():
    from solar_env.commands.play import Player

    env = gymnasium.make(DEPLOY_V1, render_mode="rgb_array", model="rigid-ideal")
    yield Player(env, seed=0)
    pygame.quit()


def press(player, *keys):
    for key in keys:
        player.press(key)


def picture(player):
    player.draw()
    return pygame.surfarray.array3d(pygame.display.get_surface())


def test_keys_turn_the_torque_and_the_window_shows_it(player):
    before = picture(player)
    assert before.shape == (960, 540 + 64, 3)
    press(player, *[pygame.K_RIGHT] * 3)
    assert player.torque == pytest.approx(0.15)
    assert not np.array_equal(picture(player), before)
    press(player, *[pygame.K_LEFT] * 30)
    assert player.torque == -1.0
    press(player, pygame.K_0)
    assert player.torque == 0.0


def test_neither_sound_nor_joysticks_are_asked_for(player):
    assert pygame.display.get_init()
    assert pygame.font.get_init()
    assert pygame.mixer.get_init() is None
    assert not pygame.joystick.get_init()


def test_an_episode_is_paused_played_and_begun_anew(player):
    simulation = player._env.unwrapped
    player.tick()
    assert simulation.simulation.time == 0.0, "it begins paused"
    press(player, pygame.K_RIGHT, pygame.K_SPACE)
    player.tick()
    assert simulation.simulation.time == pytest.approx(0.1)
    assert simulation.simulation.state.joints["motor_torque"][0] == pytest.approx(0.05 * simulation.task.torque_limit)
    for _ in range(5):
        player.tick()
    assert simulation.simulation.time == pytest.approx(0.6)
    press(player, pygame.K_r)
    assert (simulation.simulation.time, player.score, player.torque) == (0.0, 0.0, 0.0)


def test_an_episode_that_has_ended_stays_and_its_score_is_the_return(player):
    press(player, pygame.K_SPACE)
    env = gymnasium.make(DEPLOY_V1, model="rigid-ideal")
    env.reset(seed=0)
    expected, ended = 0.0, False
    while not ended:
        _, reward, ended, _, _ = env.step(np.zeros(1, dtype=np.float32))
        expected += reward
        player.tick()
    assert player.ended
    assert player.score == expected
    player.tick()
    assert player.score == expected


def test_the_command_ends_when_its_window_is_closed(monkeypatch, capsys):
    polls = iter([[], [pygame.event.Event(pygame.KEYDOWN, key=pygame.K_SPACE)], [pygame.event.Event(pygame.QUIT)]])
    monkeypatch.setattr(pygame.event, "get", lambda: next(polls))
    assert main(["play", "--model", "rigid-ideal"]) == 0
    assert "return" in capsys.readouterr().out


@pytest.mark.parametrize("driver", ["offscreen", "dummy"])
def test_without_a_display_nothing_is_played_and_it_says_what_to_do_instead(driver, monkeypatch, capsys):
    monkeypatch.delenv("SDL_VIDEODRIVER")
    monkeypatch.setattr(pygame.display, "get_driver", lambda: driver)
    monkeypatch.setattr(pygame.event, "get", lambda: [pygame.event.Event(pygame.QUIT)])
    assert main(["play", "--model", "rigid-ideal"]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    for word in ("no display", repr(driver), "solar-env replay"):
        assert word in line


def test_a_driver_that_does_not_work_is_told_in_the_same_words(monkeypatch, capsys):
    def fail():
        raise pygame.error("x11 not available")

    monkeypatch.setattr(pygame.display, "init", fail)
    assert main(["play", "--model", "rigid-ideal"]) == 2
    assert "no display for a window (x11 not available); " in capsys.readouterr().err


@pytest.mark.parametrize(
    ("options", "word"),
    [(["--model", "rigid"], "rigid"), (["--env-id", "x/y-v0"], "x/y-v0"), (["--env-kwargs", "torq=1"], "torque_limit")],
)
def test_wrong_input_is_refused(options, word, capsys):
    assert main(["play", *options]) == 2
    assert word in capsys.readouterr().err
