"""The example of planning with saved states lands softer than the springs alone."""

from __future__ import annotations

import runpy
from pathlib import Path

import gymnasium
import numpy as np

from solar_env.environment.registration import DEPLOY_V1

EXAMPLE = Path(__file__).resolve().parents[1] / "examples" / "plan_with_saved_states.py"


def test_looking_ahead_beats_the_springs_alone():
    env = gymnasium.make(DEPLOY_V1, model="rigid-ideal", settling_window=2.0)
    env.reset(seed=0)
    planned = runpy.run_path(str(EXAMPLE))["plan"](env)
    env.reset(seed=0)
    passive, ended = 0.0, False
    while not ended:
        _, reward, ended, _, _ = env.step(np.zeros(1, dtype=np.float32))
        passive += reward
    assert planned > 0.75 * passive
