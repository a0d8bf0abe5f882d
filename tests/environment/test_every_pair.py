"""Every two values of the environments' keywords together: a deployment, or a refusal that names both."""

from __future__ import annotations

import warnings

import gymnasium
import numpy as np
import pytest
from pairs import pairwise
from test_every_combination import SURFACE

from solar_env.environment.registration import DEPLOY

KEYWORDS = {
    **SURFACE,
    "model": ("rigid-ideal", "flexible-clearance:4 modes", "flexible-ideal:2 elements"),
    "parameters": (
        {"spring_stiffness": 2.0},
        {"panel_count": 1, "harness_torque": ((0.0, 0.01), (1.6, -0.01))},
        {"panel_count": 3, "body_fixed": True, "panel_length": (0.5, 1.5), "hinge_damping": 0.02, "folding": "wrap"},
        {"panel_count": 1, "wings": 2, "spring_stiffness": (2.0, 1.5)},
        {"fold_angle": 3.0, "lock_angle": (2.0, 2.5), "latching": (1, 0), "release_time": (0.0, 0.2)},
    ),
    "max_episode_steps": (2,),
    "num_threads": (1,),
}
ROWS = list(pairwise(KEYWORDS))


@pytest.mark.parametrize("given", ROWS)
def test_two_keywords_are_kept_together_or_refused_by_their_names(given):
    try:
        env = gymnasium.make_vec(DEPLOY, 2, **given)
    except ValueError as refusal:
        told = str(refusal)
        nested = [name for value in given.values() if isinstance(value, dict) for name in value]
        if sum(name in told for name in (*given, *nested)) < 2:
            raise
        return
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        observations, _ = env.reset(seed=0)
        for _ in range(3):
            assert env.observation_space.contains(observations)
            observations, rewards, *_ = env.step(np.zeros(env.action_space.shape, np.float32))
    assert np.isfinite(rewards).all()
    unwrapped = env.unwrapped
    for name in ("torque_limit", "control_period", "deadline", "settling_window", "driven_joint", "action"):
        assert getattr(unwrapped.task, name) == given.get(name, getattr(unwrapped.task, name)), name
    array = {"clearance": 1.0, **given.get("parameters", {})}
    for parameters in unwrapped.episodes.parameters:
        assert parameters.panel_count == array.get("panel_count", 2)
    env.close()
