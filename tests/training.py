"""The training command for tests: quick options for every algorithm."""

import warnings
from pathlib import Path

import numpy as np

from agents.commands import train
from agents.laws.baselines import UntunedWarning
from agents.learning import training
from agents.policies import shipped
from agents.policies.network import Layer, PolicyNetwork
from agents.policies.shipped import UNITS, Description, ShippedPolicy
from solar_env.commands.arguments import parse_arguments
from solar_env.environment.registration import DEPLOY_V1

training.VALIDATIONS, training.EPISODES = 2, 2  # of every training in tests
QUICK_RUN = ["--model", "rigid-ideal", "--timesteps", "192"]
OFF_POLICY = [*QUICK_RUN, "--hyperparams", "learning_starts=50", "buffer_size=2000", "batch_size=32"]
SMALL = {
    "ppo": [*QUICK_RUN, "--hyperparams", "n_steps=64", "batch_size=32", "n_epochs=2"],
    **dict.fromkeys(("sac", "tqc"), OFF_POLICY),
    "ars": [*QUICK_RUN, "--hyperparams", "n_delta=2"],
    "cma-es": [*QUICK_RUN, "--n-envs", "4", "--hyperparams", "population=4"],
}


def run(*arguments, compare=True):
    """Train as the command does; returns the run folder."""
    words = ["--quiet", "--eval-episodes", "2", *map(str, arguments)]
    args = parse_arguments(train.Args, words + ([] if "--jobs" in words else ["--jobs", "1"]), "solar-env train")
    if compare:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UntunedWarning)
            train.run_command(args)
        return Path(args.out or args.resume)
    config, folder = train.begin(args)
    training.train(config, folder, args.timesteps, progress=False)
    return folder


def write_policy(folder, output=None, **changes):
    """Write a policy with a layer of output, by default one that does nothing, and changes of its description."""
    described = {"algorithm": "ppo", "training_steps": 0, "env_id": DEPLOY_V1, "env_kwargs": {}}
    described |= {"observation_limit": 1.0, "activation": "tanh", "output": "clip", "mean_limit": None}
    described |= {"observation_names": ("theta_1",), **dict.fromkeys(UNITS, 1.0), **changes}
    output = output or Layer(np.zeros((1, len(described["observation_names"])), np.float32), np.zeros(1, np.float32))
    network = PolicyNetwork((output,), 1.0, "tanh", "clip")
    folder.mkdir(exist_ok=True)
    shipped.write_policy(folder, ShippedPolicy(network, Description(**described)))
    return Description(**described)
