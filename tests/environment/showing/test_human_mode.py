"""The render mode "human" is Gymnasium's window of our frames; without a display here."""

import gymnasium
import numpy as np
import pytest
from episodes import assert_same

from solar_env.environment.registration import DEPLOY

pygame = pytest.importorskip("pygame")
QUICK = {"model": "rigid-ideal", "control_period": 0.02}


@pytest.mark.filterwarnings("ignore:.*natively support.*")
def test_resets_and_steps_show_the_frames_that_rgb_array_draws_and_the_episode_is_the_same():
    shown, drawn = (gymnasium.make(DEPLOY, render_mode=mode, **QUICK) for mode in ("human", "rgb_array"))
    assert shown.metadata["render_fps"] == 50
    assert_same(shown.reset(seed=0), drawn.reset(seed=0))
    for _ in range(3):
        assert_same(shown.step([1.0]), drawn.step([1.0]))
        picture = pygame.surfarray.array3d(pygame.display.get_surface()).swapaxes(0, 1)
        np.testing.assert_array_equal(picture, drawn.render())
    shown.close()
