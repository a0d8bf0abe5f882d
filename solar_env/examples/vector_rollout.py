"""Roll out 128 arrays at once, and plot how the return depends on a constant action.

Environment i of the vector gives the results of a single environment with seed i, to the last bit. All environments
advance in one compiled call, and an environment with many impacts does not keep the others waiting.
"""

import sys
import time

import gymnasium
import numpy as np
from matplotlib.figure import Figure

import solar_env  # noqa: F401 (registers the environments)

LANES = 128

envs = gymnasium.make_vec("solar_env/Deploy-v2", num_envs=LANES, randomize={"clearance": (5e-5, 5e-4)})
actions = np.linspace(-1.0, 1.0, LANES, dtype=np.float32)[:, np.newaxis]
envs.reset(seed=0)
returns, running, steps, begun = np.zeros(LANES), np.ones(LANES, dtype=bool), 0, time.perf_counter()
while running.any():
    _, rewards, terminations, truncations, _ = envs.step(actions)
    returns += np.where(running, rewards, 0.0)
    steps += int(running.sum())
    running &= ~(terminations | truncations)
rate = steps / (time.perf_counter() - begun)

figure = Figure(figsize=(6.0, 4.0), layout="constrained")
axes = figure.subplots()
axes.plot(actions[:, 0], returns, ".", markersize=4.0)
best = actions[returns.argmax(), 0]
axes.set(xlabel="constant action", ylabel="return", title=f"The best constant action is {best:.2f}")
figure.savefig(sys.argv[1] if len(sys.argv) > 1 else "vector_rollout.png", dpi=100)
print(f"{rate:,.0f} environment steps a second")
