"""A small run of every kind of agent and what is exported of it, for the tests of exporting and of loading."""

from pathlib import Path

import numpy as np

from agents.commands import export
from agents.comparison.evaluation import evaluate
from agents.comparison.report import write_comparison
from agents.environments import DEFAULT_ENV_ID
from agents.learning import learn, runs

COMMAND = "python train.py --seed 7"
QUICK = {"model": "rigid-ideal", "control_period": 0.5, "settling_window": 2.0}
QUICK |= {"observation": "drive", "action": "torque"}
ON_POLICY = {"n_steps": 50, "batch_size": 50}
OFF_POLICY = {"learning_starts": 60, "buffer_size": 500, "batch_size": 16}
DEEP = {"policy_kwargs": {"net_arch": [64, 64]}}
# Name -> algorithm, hyperparameters.
TRAINED = {
    "ppo": ("ppo", {**ON_POLICY, **DEEP}),
    "sac": ("sac", {**OFF_POLICY, **DEEP}),
    "td3": ("td3", {**OFF_POLICY, **DEEP}),
    "cma-es": ("cma-es", {"population": 4}),
    "linear": ("ppo", ON_POLICY),
}


def train_and_export(folder: Path) -> dict[str, tuple[Path, Path]]:
    """Name -> run, and folder of what was exported of it; the linear one has scores."""
    made = {}
    learn.VALIDATION_EPISODES, usual = 2, learn.VALIDATION_EPISODES
    for name, (algo, hyperparameters) in TRAINED.items():
        config = runs.complete(algo, DEFAULT_ENV_ID, QUICK, 7, 1, 100, hyperparameters)
        run = runs.new_run_folder(folder / "runs" / name, config.env_id, algo, config.seed)
        learn.train(learn.Training(config, run, command=COMMAND, progress=False, threads=1))
        if name == "linear":
            rows = evaluate(["passive", f"ppo={run}"], 2, 7, config.env_id, config.env_kwargs, progress=False)
            write_comparison(run, rows, {"command": COMMAND})
        made[name] = run, folder / "policies" / name
        export.export(*made[name])
    learn.VALIDATION_EPISODES = usual
    return made


def random_observations(count, seed=1):
    """Observations (count, 9) of which some entries are clipped."""
    return np.random.default_rng(seed).uniform(-4.0, 4.0, (count, 9)).astype(np.float32)
