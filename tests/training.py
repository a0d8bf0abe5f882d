"""The training command for tests: quick options for every algorithm."""

import numpy as np

from agents.commands import train
from agents.environments import DEFAULT_ENV_ID
from agents.learning import checkpoints, learn, runs
from agents.policies import shipped
from agents.policies.network import Layer, PolicyNetwork
from agents.policies.shipped import UNITS, Description, ShippedPolicy
from solar_env.commands.arguments import parse_arguments

RIGID = ["--model", "rigid-clearance"]
OFF_POLICY = [*RIGID, "--n-envs", "1"]
OFF_POLICY += ["--hyperparams", "learning_starts=50", "buffer_size=2000", "batch_size=32"]
OFF_POLICY += ["train_freq=50", "gradient_steps=2"]
PPO = ["--algo", "ppo", *RIGID, "--n-envs", "2", "--hyperparams", "n_steps=300", "batch_size=100"]
SMALL = {"ppo": PPO, "sac": OFF_POLICY, "td3": OFF_POLICY}


def run(*arguments):
    words = ["--quiet", "--eval-episodes", "2", *map(str, arguments)]
    words += [] if "--jobs" in words else ["--jobs", "1"]
    return train.run(parse_arguments(train.Args, words, "solar-env train"))


def last_model(folder):
    """The model that the run in a folder has come to."""
    config = runs.read_config(folder)
    return checkpoints.restored(checkpoints.read(folder), config, learn.make_training_env(config, threads=1), folder)


def write_policy(folder, output=None, **changes):
    """Write a policy with a layer of output, by default one that does nothing, and changes of its description."""
    described = {"algorithm": "ppo", "training_steps": 0, "env_id": DEFAULT_ENV_ID, "env_kwargs": {}}
    described |= {"observation_limit": 1.0, "activation": "tanh", "output": "clip", "mean_limit": None}
    described |= {"observation_names": ("theta_1",), **dict.fromkeys(UNITS, 1.0), **changes}
    output = output or Layer(np.zeros((1, len(described["observation_names"])), np.float32), np.zeros(1, np.float32))
    network = PolicyNetwork((output,), 1.0, "tanh", "clip")
    folder.mkdir(exist_ok=True)
    shipped.write_policy(folder, ShippedPolicy(network, Description(**described)))
    return Description(**described)
