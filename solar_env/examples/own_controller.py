"""Deploy an array by your own controller: open at a constant rate, then slow down near the root hinge's lock angle.

A rate proportional to the remaining angle, d' = -d / T, lets the angle decay exponentially. The action is the scaled
logarithm of the wanted rate. The drive follows with a lag, so the controller uses the angle expected 2.4 s later.
"""

import sys

import gymnasium
import numpy as np
from matplotlib.figure import Figure

import solar_env

CRUISE, AHEAD, DECAY = 0.098, 2.4, 1.5  # rad/s; s; s

env = gymnasium.make("solar_env/Deploy-v2", observation=["theta", "rate", "time_to_deadline"])
lock = solar_env.ArrayParameters().joints[0].lock_angle  # rad, the unit of the observed angle
observation, _ = env.reset(seed=0)
angles, ended = [0.0], False
while not ended:
    distance = max(lock * (1.0 - observation[0]) - AHEAD * CRUISE, 1e-4)
    action = np.array([np.log(distance / DECAY / CRUISE) / 4.5], dtype=np.float32)
    observation, reward, terminated, truncated, info = env.step(action)
    angles.append(lock * float(observation[0]))
    ended = terminated or truncated

figure = Figure(figsize=(6.0, 4.0), layout="constrained")
axes = figure.subplots()
axes.plot(0.5 * np.arange(len(angles)), np.degrees(angles))
axes.axhline(np.degrees(lock), color="black", linestyle=":")
force = max(info["deployment"]["peak_postlock_force_N"])
axes.set(xlabel="time [s]", ylabel="angle of the root hinge [deg]", title=f"It lands with {force:.0f} N")
figure.savefig(sys.argv[1] if len(sys.argv) > 1 else "own_controller.png", dpi=100)
