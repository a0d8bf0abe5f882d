"""Environments and whole episodes, for tests."""

from __future__ import annotations

import gymnasium
import numpy as np

from solar_env.environment.registration import DEPLOY_V1

RANGES = {"clearance": (1e-4, 3e-4), "friction_coefficient": (0.05, 0.3)}
# Springs that deploy the array within three seconds.
STRONG = {"spring_stiffness": 2.0}
LANES = 5
# The root latches nine seconds after the outer joint.
LATE_ROOT = {"cable_stiffness": 0.02}


def make(model="rigid-clearance", **keywords):
    return gymnasium.make(DEPLOY_V1, model=model, **keywords).unwrapped


def watch(env, actions, seed=0):
    """(steps + 1, entries) observations of an episode's beginning."""
    first, _ = env.reset(seed=seed)
    return np.array([first, *(env.step([action])[0] for action in actions)])


def deploy(env, policy=lambda observation: [0.0], seed=0, options=None):
    """Run one episode; returns its return, steps and the last info."""
    observation, _ = env.reset(seed=seed, options=options)
    total, steps = 0.0, 0
    while True:
        observation, reward, terminated, truncated, info = env.step(policy(observation))
        total, steps = total + reward, steps + 1
        if terminated or truncated:
            return total, steps, info


def main_body_spin(state):
    """Angular velocity of the line through the main body's base points, or of its frame [rad/s]."""
    if hasattr(state, "course"):
        return state.v[2]
    (x, y), (u, v) = state.q[2:4] - state.q[:2], state.v[2:4] - state.v[:2]
    return (x * v - y * u) / (x * x + y * y)


def make_vector(lanes=LANES, **keywords):
    return gymnasium.make_vec(DEPLOY_V1, num_envs=lanes, **keywords)


def random_actions(steps, lanes=LANES, seed=0):
    return np.random.default_rng(seed).uniform(-1.0, 1.0, (steps, lanes, 1)).astype(np.float32)


def assert_same(one, other, where="result"):
    """Equal to the last bit, in type and shape too."""
    assert type(one) is type(other), where
    if isinstance(one, dict):
        assert set(one) == set(other), where
        for key in one:
            assert_same(one[key], other[key], f"{where}[{key!r}]")
    elif isinstance(one, (tuple, list)):
        assert len(one) == len(other), where
        for k, pair in enumerate(zip(one, other, strict=True)):
            assert_same(*pair, f"{where}[{k}]")
    elif isinstance(one, np.ndarray):
        assert (one.dtype, one.shape) == (other.dtype, other.shape), where
        if one.dtype == object:
            assert_same(one.tolist(), other.tolist(), where)
        else:
            assert one.tobytes() == other.tobytes(), where
    else:
        assert one == other, where
