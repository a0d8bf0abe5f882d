"""Command that searches hyperparameters of an agent by CMA-ES on validation returns: `solar-env search`."""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from agents.commands.arguments import CommandRecord, ModelOptions, WorkerOptions
from agents.comparison.suites import RIGID
from agents.environments import DEFAULT_ENV_ID
from agents.laws.baselines import CONFIGS
from agents.learning import configurations, learn, runs
from solar_env.support.files import check_target, make_folder
from solar_env.support.minimisation import minimise
from solar_env.support.plain_arrays import read_json

SIGNIFICANT_DIGITS = 3
SPREAD = 0.1  # of the first generation, as a share of the ranges; a wider one trains agents that only shake the array


@dataclass(frozen=True)
class Range:
    """Range of a hyperparameter that is searched, evenly or, if `logarithmic`, evenly in its logarithm."""

    low: float
    high: float
    logarithmic: bool = False

    def value(self, unit: float) -> float:
        """Return the value at a share of the way from `low` to `high`, to three digits."""
        if self.logarithmic:
            value = self.low * (self.high / self.low) ** unit
        else:
            value = self.low + unit * (self.high - self.low)
        return float(f"{value:.{SIGNIFICANT_DIGITS}g}")

    def share(self, value: float) -> float:
        """Return the share of a value, within [0, 1]; inverse of `value`."""
        if self.logarithmic:
            unit = math.log(value / self.low) / math.log(self.high / self.low)
        else:
            unit = (value - self.low) / (self.high - self.low)
        return min(max(unit, 0.0), 1.0)


_LOG_STD = Range(-4.0, -1.0)  # of the noise on actions, or on weights; the funnel is a hundredth of the range wide
_CRITIC_RATE = Range(1e-4, 1e-2, logarithmic=True)
_ACTOR_RATE = Range(1e-5, 1e-3, logarithmic=True)
# What is inside "policy_kwargs" is searched beside the keywords of the Stable-Baselines3 classes.
SPACES: dict[str, dict[str, Range]] = {
    "ppo": {
        "learning_rate": Range(4e-4, 4e-2, logarithmic=True),
        "log_std_init": _LOG_STD,
        "gae_lambda": Range(0.9, 1.0),
    },
    "sac": {
        "learning_rate": _CRITIC_RATE,
        "actor_learning_rate": _ACTOR_RATE,
        "log_std_init": _LOG_STD,
    },
    "td3": {
        "learning_rate": _CRITIC_RATE,
        "actor_learning_rate": _ACTOR_RATE,
        "exploration_noise": Range(0.02, 0.5, logarithmic=True),
    },
}


@dataclass
class Args(ModelOptions, WorkerOptions, CommandRecord):
    """Search hyperparameters of an agent and write the best to agents/configs.

    The model is rigid-clearance unless another is named.
    """

    algo: str = "ppo"
    """algorithm: ppo, sac or td3"""
    trials: int = 24
    """training runs, in whole generations of 7, and one more of the configuration as it is"""
    timesteps: int = 40_000
    """environment steps of every run"""
    seed: int = 0
    """seed of the search and of the runs"""
    env_id: str = DEFAULT_ENV_ID
    """environment id"""
    repeat: bool = False
    """begin where the search began whose result is in agents/configs, and so repeat it, not at its result"""
    out: str = "search"
    """folder of the runs; those that are complete are not trained again"""


def trial(args: Args, env_kwargs: dict[str, Any], unit: np.ndarray) -> configurations.Configuration:
    """Make the configuration of a point (n,) in [0, 1]."""
    ranges = SPACES[args.algo]
    chosen: dict[str, Any] = {name: r.value(float(u)) for (name, r), u in zip(ranges.items(), unit, strict=True)}
    if "log_std_init" in chosen:  # a keyword of the policy
        chosen["policy_kwargs"] = {"log_std_init": chosen.pop("log_std_init")}
    agent = args.algo, args.env_id, env_kwargs, args.seed
    return configurations.complete(*agent, None, args.timesteps, chosen)


def start(algo: str, env_id: str, repeat: bool = False) -> dict[str, float]:
    """Return the values that a search starts from: those in agents/configs, or to `repeat` a search its first ones.

    Raises:
        ValueError: There is none for the environment, or no search to repeat.
    """
    entry = configurations.entry(algo, env_id)
    if repeat:
        if "search" not in entry:
            raise ValueError(f"{algo}.json records no such search for {env_id!r}; leave --repeat out")
        recorded: dict[str, float] = entry["search"]["start"]
        return recorded
    hyperparameters = entry["hyperparameters"]
    values = {**hyperparameters, **hyperparameters.get("policy_kwargs", {})}
    return {name: values[name] for name in SPACES[algo]}


def point(values: Mapping[str, float], algo: str) -> np.ndarray:
    """Return the point (n,) in [0, 1] of values; `trial` is the inverse."""
    return np.array([r.share(values[name]) for name, r in SPACES[algo].items()])


def score(folder: Path) -> float:
    """Return the mean return of a run's validation episodes in the last third of its validations.

    A training keeps its best validation, but a single one is a noisy score: episodes with clearance scatter.
    """
    means = runs.read_evaluations(folder)["results"].mean(axis=1)
    return float(means[-math.ceil(len(means) / 3) :].mean())


def store(algo: str, env_id: str, config: configurations.Configuration, record: dict[str, Any]) -> Path:
    """Write the best hyperparameters to their file in `CONFIGS`, with the record of the search."""
    path = CONFIGS / f"{algo}.json"
    entries = read_json(path)
    entries[env_id] |= {"hyperparameters": config.hyperparameters, "search": record}
    runs.write_json(path, entries)
    return path


def run_command(args: Args) -> int:
    """Run the command; see `Args`. A ValueError says that there is nothing to search, or the budget is too small."""
    if args.algo not in SPACES:
        raise ValueError(f"nothing to search for {args.algo!r}; choose from {', '.join(SPACES)}")
    env_kwargs = args.keywords(args.env_id, RIGID)
    values = start(args.algo, args.env_id, args.repeat)
    make_folder(args.out)
    check_target(CONFIGS / f"{args.algo}.json")
    scores: dict[Path, float] = {}
    configs: dict[Path, configurations.Configuration] = {}

    def costs(points: Sequence[np.ndarray]) -> list[float]:
        generation = [trial(args, env_kwargs, np.clip(point, 0.0, 1.0)) for point in points]
        folders = [Path(args.out) / f"trial-{len(configs) + k}" for k in range(len(generation))]
        wanted = dict(zip(folders, generation, strict=True))
        learn.train_missing(wanted, args.command, "cpu", args.workers, progress=False)
        configs.update(wanted)
        scores.update({folder: score(folder) for folder in folders})
        return [-scores[folder] for folder in folders]

    first = point(values, args.algo)
    minimise(costs, first, args.trials, args.seed, progress=not args.quiet, spread=SPREAD)
    before = -costs([first])[0]
    best = max(scores, key=scores.__getitem__)
    record = {
        "command": args.command,
        "start": values,
        "env_kwargs": configs[best].env_kwargs,
        "trials": len(scores),
        "timesteps": args.timesteps,
        "validation_return": scores[best],
        "validation_return_before": before,
    }
    path = store(args.algo, args.env_id, configs[best], record)
    print(json.dumps({**record, **configs[best].hyperparameters}, indent=2))
    print(f"written to {path}")
    return 0
