"""Score constant actions by a reward of your own: a function of physical quantities before and after a step.

A difference of potentials, phi(after) - phi(before), adds up to phi(end) - phi(start) over an episode: it guides
learning without changing which policy is best (A. Y. Ng, D. Harada and S. Russell, ICML 1999, 278-287).
"""

import sys
from collections.abc import Mapping

import gymnasium
import numpy as np
from matplotlib.figure import Figure

import solar_env  # noqa: F401 (registers the environments)


def opening_less_wear(before: Mapping[str, float], after: Mapping[str, float]) -> float:
    """Return the opening gained in a step, as a fraction of the lock angle, minus the sliding work in units of 5 mJ."""
    worn, opened = (after[name] - before[name] for name in ("wear", "opening"))
    return opened - worn / 5e-3


env = gymnasium.make("solar_env/Deploy-v2", reward=opening_less_wear)
actions = np.linspace(-0.6, 0.6, 9, dtype=np.float32)
returns = []
for action in actions:
    env.reset(seed=0)
    total, ended = 0.0, False
    while not ended:
        _, reward, terminated, truncated, _ = env.step(np.array([action]))
        total, ended = total + float(reward), terminated or truncated
    returns.append(total)

figure = Figure(figsize=(6.0, 4.0), layout="constrained")
axes = figure.subplots()
axes.plot(actions, returns, "o-")
axes.set(xlabel="constant action", ylabel="return", title=f"An action of {actions[np.argmax(returns)]:.2f} is the best")
figure.savefig(sys.argv[1] if len(sys.argv) > 1 else "own_reward.png", dpi=100)
