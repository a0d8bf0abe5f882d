"""Train PPO of Stable-Baselines3 with its defaults, and plot the return of every episode.

PPO (J. Schulman et al., 2017, arXiv:1707.06347) raises the expected return by gradient steps, which it clips where the
probability of an action has changed by a fifth. 100,000 steps take five minutes on one core.
"""

import sys

import gymnasium
import numpy as np
import torch
from matplotlib.figure import Figure
from stable_baselines3 import PPO
from stable_baselines3.common.monitor import Monitor

import solar_env  # noqa: F401 (registers the environments)

STEPS = int(sys.argv[2]) if len(sys.argv) > 2 else 100_000

torch.set_num_threads(1)  # networks this small only lose time to further threads
env = Monitor(gymnasium.make("solar_env/Deploy-v2"))
model = PPO("MlpPolicy", env, n_steps=min(2048, STEPS), seed=0, device="cpu")
model.learn(STEPS)
model.save("ppo_deploy")  # solar-env evaluate --controllers pd ppo_deploy.zip

steps, returns = np.cumsum(env.get_episode_lengths()), np.array(env.get_episode_rewards())
figure = Figure(figsize=(6.0, 4.0), layout="constrained")
axes = figure.subplots()
axes.plot(steps, returns, ".", markersize=3.0)
axes.set(xlabel="environment steps", ylabel="return of an episode", title=f"Best return {returns.max():.2f}")
figure.savefig(sys.argv[1] if len(sys.argv) > 1 else "train_ppo.png", dpi=100)
