"""A small run of every kind of agent and what is exported of it, for the tests of exporting and of loading."""

from pathlib import Path

import numpy as np
from training import SMALL, run

from agents.commands import export

COMMAND = "solar-env train --quiet"
QUICK = {"model": "rigid-ideal", "control_period": 0.5, "settling_window": 2.0}
QUICK |= {"observation": "drive", "action": "torque"}
AS_QUICK = ["--env-id", "solar_env/Deploy-v1", "--env-kwargs", *(f"{name}={value}" for name, value in QUICK.items())]
# Name -> algorithm.
TRAINED = {"ppo": "ppo", "sac": "sac", "cma-es": "cma-es", "scored": "ppo"}


def train_and_export(folder: Path) -> dict[str, tuple[Path, Path]]:
    """Name -> run, and folder of what was exported of it; one has scores."""
    made = {}
    for name, algo in TRAINED.items():
        words = ["--algo", algo, *SMALL[algo][2:], "--seed", 7, *AS_QUICK]
        run_folder = run(*words, "--out", folder / "runs" / name, compare=name == "scored")
        made[name] = run_folder, folder / "policies" / name
        export.export(*made[name])
    return made


def random_observations(count, seed=1):
    """Observations (count, 9)."""
    return np.random.default_rng(seed).uniform(-4.0, 4.0, (count, 9)).astype(np.float32)
