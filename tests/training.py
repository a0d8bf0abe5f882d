"""The training command for tests: quick options for every algorithm."""

import io

import numpy as np

from agents.commands import train
from agents.learning import checkpoints, runs
from solar_env.commands.arguments import parse_arguments

RIGID = ["--model", "rigid-clearance"]
OFF_POLICY = [*RIGID, "--n-envs", "1"]
OFF_POLICY += ["--hyperparams", "learning_starts=50", "buffer_size=2000", "batch_size=32"]
OFF_POLICY += ["train_freq=50", "gradient_steps=2"]
SMALL = {
    "ppo": [
        "--algo",
        "ppo",
        *RIGID,
        "--n-envs",
        "2",
        "--hyperparams",
        "n_steps=300",
        "batch_size=100",
    ],
    "sac": OFF_POLICY,
    "td3": OFF_POLICY,
}


def run(*arguments):
    words = ["--quiet", "--eval-episodes", "2", *map(str, arguments)]
    return train.run(parse_arguments(train.Args, words, "solar-env train"))


def write_history(folder, results, timesteps=None):
    """Write the history of a run's validations, (n, episodes) returns."""
    results = np.asarray(results, dtype=float)
    steps = np.arange(len(results)) if timesteps is None else timesteps
    np.savez(folder / runs.EVALUATIONS, timesteps=steps, results=results, ep_lengths=np.ones(results.shape, dtype=int))


def last_model(folder):
    """The model that the run in a folder has come to."""
    return runs.algorithm(runs.read_config(folder)["algo"]).load(io.BytesIO(checkpoints.read(folder).model))
