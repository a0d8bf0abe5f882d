"""Plan with saved states: simulate torques from the present state to the end of the episode, apply the best, repeat.

Copies of an episode have the same future, including the noise to come. With the simulator itself as the model,
receding-horizon control lacks no knowledge: no controller can beat it by knowing more.
"""

import sys

import gymnasium
import numpy as np
from matplotlib.figure import Figure

import solar_env  # noqa: F401 (registers the environments)

CANDIDATES = np.linspace(-1.0, 1.0, 9, dtype=np.float32)[:, np.newaxis]  # torques in units of the limit
HOLD = 10  # control periods for which a torque is held, before the torque is zero

env = gymnasium.make("solar_env/Deploy-v1")
env.reset(seed=0)
total, chosen, ended = 0.0, [], False
while not ended:
    futures, periods, returns = env.unwrapped.futures(len(CANDIDATES)), 0, np.zeros(len(CANDIDATES))
    while not futures.terminated.all():
        lanes = np.flatnonzero(~futures.terminated)
        futures.step(lanes, CANDIDATES if periods < HOLD else 0.0 * CANDIDATES)
        returns[lanes] += futures.rewards[lanes]
        periods += 1
    for _ in range(HOLD):
        if not ended:
            _, reward, ended, _, _ = env.step(CANDIDATES[returns.argmax()])
            total, chosen = total + float(reward), [*chosen, CANDIDATES[returns.argmax(), 0]]
figure = Figure(figsize=(6.0, 4.0), layout="constrained")
axes = figure.subplots()
axes.step(0.1 * np.arange(len(chosen)), chosen, where="post")
axes.set(xlabel="time [s]", ylabel="torque, in units of the limit", title=f"Looking ahead returns {total:.3f}")
figure.savefig(sys.argv[1] if len(sys.argv) > 1 else "plan_with_saved_states.png", dpi=100)
