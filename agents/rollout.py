"""One episode of a controller, reduced to the scalar results that evaluation and tuning compare."""

import math
from collections import defaultdict
from collections.abc import Mapping

import gymnasium
import numpy as np

from agents.torque_laws import Controller
from solar_env.environment.episodes import Info

Figures = dict[str, float | int | bool]
UNITS = ("s", "N", "Nm", "Ns", "J", "m")
"""Ends of the names of figures: `contact_starts` has no unit."""


def run_episode(env: gymnasium.Env, controller: Controller, seed: int) -> Figures:
    """Run one deterministic episode; return a dictionary: "seed", and scalars such as "return" (`episode_figures`)."""
    observation, _ = env.reset(seed=seed)
    state = None
    episode_start = np.ones(1, dtype=bool)
    terms: defaultdict[str, float] = defaultdict(float)
    while True:
        action, state = controller.predict(observation, state, episode_start, deterministic=True)
        observation, _, terminated, truncated, info = env.step(action)
        episode_start[:] = False
        for name, value in info["reward_terms"].items():
            terms[name] += value
        if terminated or truncated:
            return {"seed": seed, **episode_figures(info["deployment"], terms)}


def episode_figures(deployment: Info, reward_terms: Mapping[str, float]) -> Figures:
    """Flatten `info["deployment"]` and the summed reward terms of an episode into named scalars.

    Lists by joint become one entry per joint (`peak_postlock_force_1_N`) and one for the array: the largest
    force and wear depth, the last latch time, the sum of impulse, sliding work and contacts. Post-lock
    quantities and latch torques are NaN if any joint never latched.
    """
    latched = bool(deployment["latched"])
    figures: dict[str, float | int | bool] = {
        "return": float(sum(reward_terms.values())),
        **{f"reward_{name}": float(value) for name, value in reward_terms.items()},
        "latched": latched,
    }
    for name, value in deployment.items():
        if not isinstance(value, list | tuple):
            figures[name] = latched if name == "latched" else float(value)
            continue
        after = not latched and ("postlock" in name or "latch_torque" in name)
        by_joint = [math.nan if v is None or after else float(v) for v in value]
        quantity, _, unit = name.rpartition("_")
        quantity, unit = (quantity, "_" + unit) if unit in UNITS else (name, "")
        reduction = np.max if any(part in name for part in ("peak", "latch_time", "max")) else np.sum
        figures[quantity + unit] = float(reduction(by_joint))
        figures |= {f"{quantity}_{joint}{unit}": v for joint, v in enumerate(by_joint, start=1)}
    return figures
