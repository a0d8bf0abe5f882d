"""The render mode "human" shows every reset and step in a window, at the episode's pace; without a display here."""

import importlib.util
import pickle
import time

import gymnasium
import numpy as np
import pytest
from episodes import assert_same
from gymnasium.utils.env_checker import check_env

from solar_env.environment.registration import DEPLOY_V1

pygame = pytest.importorskip("pygame")
QUICK = {"model": "rigid-ideal", "control_period": 0.02}


def picture():
    return pygame.surfarray.array3d(pygame.display.get_surface()).swapaxes(0, 1)


def test_resets_and_steps_show_the_frames_that_rgb_array_draws_and_the_episode_is_the_same():
    shown, drawn = (gymnasium.make(DEPLOY_V1, render_mode=mode, **QUICK) for mode in ("human", "rgb_array"))
    assert not isinstance(shown, gymnasium.wrappers.HumanRendering)
    assert_same(shown.reset(seed=0), drawn.reset(seed=0))
    folded = picture()
    np.testing.assert_array_equal(folded, drawn.render())
    for _ in range(5):
        assert_same(shown.step([1.0]), drawn.step([1.0]))
        np.testing.assert_array_equal(picture(), drawn.render())
    assert shown.render() is None
    assert not np.array_equal(picture(), folded)
    assert pygame.display.get_surface().get_size() == (960, 540)


def test_frames_are_shown_at_the_pace_of_the_control_periods():
    env = gymnasium.make(DEPLOY_V1, render_mode="human", model="rigid-ideal", control_period=0.1)
    env.reset(seed=0)
    env.step([0.0])
    begun = time.monotonic()
    for _ in range(5):
        env.step([0.0])
    assert time.monotonic() - begun > 0.45


def test_the_window_closes_and_opens_with_the_next_episode():
    env = gymnasium.make(DEPLOY_V1, render_mode="human", **QUICK)
    env.close()
    env.reset(seed=0)
    env.close()
    env.close()
    assert pygame.display.get_surface() is None
    env.reset(seed=1)
    assert pygame.display.get_surface() is not None


def test_a_copy_goes_on_in_the_window_and_gymnasium_finds_no_fault():
    env = gymnasium.make(DEPLOY_V1, render_mode="human", **QUICK).unwrapped
    env.reset(seed=0)
    env.step([1.0])
    twin = pickle.loads(pickle.dumps(env))
    after = env.step([1.0]), picture()
    assert_same((twin.step([1.0]), picture()), after)
    check_env(env)


def test_without_pygame_the_mode_is_refused_with_what_to_install(monkeypatch):
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    with pytest.raises(gymnasium.error.DependencyNotInstalled, match=r"pip install -e '\.\[play\]'"):
        gymnasium.make(DEPLOY_V1, render_mode="human")


def test_without_a_display_the_mode_is_refused_before_the_first_episode(monkeypatch):
    monkeypatch.delenv("SDL_VIDEODRIVER")
    monkeypatch.setattr(pygame.display, "get_driver", lambda: "offscreen")
    with pytest.raises(OSError, match=r"no display .*'offscreen'.*solar-env replay"):
        gymnasium.make(DEPLOY_V1, render_mode="human", **QUICK)
