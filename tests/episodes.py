"""Environments and whole episodes, for tests."""

from __future__ import annotations

import gymnasium

ID = "solar_env/Deploy-v0"
ELEMENTS = 2  # few, which is quick
# Springs that deploy the array within three seconds.
STRONG = {"spring_stiffness": 2.0}


def make(model="rigid-clearance", **keywords):
    return gymnasium.make(ID, model=model, elements=ELEMENTS, **keywords).unwrapped


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
    """Angular velocity of the line through the main body's base points [rad/s]."""
    (x, y), (u, v) = state.q[2:4] - state.q[:2], state.v[2:4] - state.v[:2]
    return (x * v - y * u) / (x * x + y * y)
