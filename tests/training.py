"""The training command for tests: quick options for every algorithm."""

import json
import warnings
import zipfile
from dataclasses import asdict
from io import BytesIO
from pathlib import Path

import torch

from agents.commands import train
from agents.laws.baselines import UntunedWarning
from agents.learning import runs, training
from solar_env.commands.arguments import parse_arguments
from solar_env.environment.registration import DEPLOY

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
    if args.resume:
        config, folder = runs.read_config(args.resume), Path(args.resume)
    else:
        config, folder = train.configuration(args), Path(args.out)
    training.train(config, folder, args.timesteps or config.timesteps, progress=False)
    return folder


def write_run(folder, weights=((0.0,) * 8,), bias=0.0, **changes):
    """Write a run folder whose policy is a line, by default one that does nothing; returns its configuration."""
    described = {"algo": "ppo", "env_id": DEPLOY, "env_kwargs": {}, "seed": 0, "n_envs": 1, "timesteps": 9}
    config = runs.Configuration(**{**described, "hyperparameters": {}, **changes})
    folder.mkdir(exist_ok=True)
    runs.write_json(folder / runs.CONFIG, asdict(config))
    parameters, stored = (
        {"action_net.weight": torch.tensor(weights), "action_net.bias": torch.tensor([bias])},
        BytesIO(),
    )
    torch.save(parameters, stored)
    with zipfile.ZipFile(folder / runs.BEST, "w") as file:
        file.writestr("data", json.dumps({"policy_kwargs": {"squash_output": False}}))
        file.writestr("policy.pth", stored.getvalue())
    return config
