"""Command that searches hyperparameters of an agent by CMA-ES on validation returns: `solar-env search`."""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from agents.commands.arguments import CommandRecord, ModelOptions, WorkerOptions
from agents.comparison.suites import training_model
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


_LOG_STD = Range(-6.0, -2.0)
_CRITIC_RATE = Range(1e-4, 1e-2, logarithmic=True)
_ACTOR_RATE = Range(1e-5, 1e-3, logarithmic=True)
# "residual" and what is inside "policy_kwargs" are searched beside the keywords of the Stable-Baselines3 classes.
SPACES: dict[str, dict[str, Range]] = {
    "ppo": {
        "residual": Range(0.02, 0.2, logarithmic=True),
        "learning_rate": Range(5e-5, 5e-3, logarithmic=True),
        "log_std_init": _LOG_STD,
        "gae_lambda": Range(0.9, 1.0),
    },
    "sac": {
        "residual": Range(0.02, 0.2, logarithmic=True),
        "learning_rate": _CRITIC_RATE,
        "actor_learning_rate": _ACTOR_RATE,
        "log_std_init": _LOG_STD,
    },
    "td3": {
        "residual": Range(0.02, 0.2, logarithmic=True),
        "learning_rate": _CRITIC_RATE,
        "actor_learning_rate": _ACTOR_RATE,
        "exploration_noise": Range(0.005, 0.2, logarithmic=True),
    },
}
# An agent that begins with no torque at all has more to try out than one that begins with a servo.
WHOLE_TORQUE = {"log_std_init": Range(-4.0, 0.0), "exploration_noise": Range(0.02, 2.0, logarithmic=True)}


@dataclass
class Args(ModelOptions, WorkerOptions, CommandRecord):
    """Search hyperparameters of an agent and write the best to agents/configs.

    The model is flexible-clearance, or rigid-clearance for the whole torque, unless another is named.
    """

    algo: str = "ppo"
    """algorithm: ppo, sac or td3"""
    trials: int = 24
    """training runs, in whole generations of 8, or 7 with --whole, and one more of the configuration as it is"""
    timesteps: int = 40_000
    """environment steps of every run"""
    landings: int | None = None
    """episodes of the law alone with whose landings training begins; by default the number in agents/configs"""
    seed: int = 0
    """seed of the search and of the runs"""
    env_id: str = DEFAULT_ENV_ID
    """environment id"""
    whole: bool = False
    """search for the agent that commands the whole torque, not for the one that adds to the tuned servo"""
    repeat: bool = False
    """begin where the search began whose result is in agents/configs, and so repeat it, not at its result"""
    out: str = "search"
    """folder of the runs; those that are complete are not trained again"""


def space(algo: str, whole: bool) -> dict[str, Range]:
    """Return the ranges that are searched; an agent that commands the whole torque has no residual."""
    if not whole:
        return SPACES[algo]
    return {name: WHOLE_TORQUE.get(name, r) for name, r in SPACES[algo].items() if name != "residual"}


def trial(args: Args, env_kwargs: dict[str, Any], unit: np.ndarray) -> configurations.Configuration:
    """Make the configuration of a point (n,) in [0, 1]."""
    ranges = space(args.algo, args.whole)
    chosen: dict[str, Any] = {name: r.value(float(u)) for (name, r), u in zip(ranges.items(), unit, strict=True)}
    residual = chosen.pop("residual", 0.0)
    if "log_std_init" in chosen:  # a keyword of the policy
        chosen["policy_kwargs"] = {"log_std_init": chosen.pop("log_std_init")}
    agent = args.algo, args.env_id, env_kwargs, args.seed
    return configurations.complete(*agent, None, args.timesteps, chosen, residual, args.landings)


def start(algo: str, env_id: str, whole: bool = False, repeat: bool = False) -> dict[str, float]:
    """Return the values that a search starts from: those in agents/configs, or to `repeat` a search its first ones.

    Raises:
        ValueError: There is none for the environment, or no search to repeat.
    """
    entry = configurations.entry(algo, env_id, whole)
    if repeat:
        if "search" not in entry:
            raise ValueError(f"{algo}.json records no such search for {env_id!r}; leave --repeat out")
        return entry["search"]["start"]
    hyperparameters = entry["hyperparameters"]
    values = {**hyperparameters, **hyperparameters.get("policy_kwargs", {}), "residual": entry["residual"]}
    return {name: values[name] for name in space(algo, whole)}


def point(values: Mapping[str, float], algo: str, whole: bool = False) -> np.ndarray:
    """Return the point (n,) in [0, 1] of values; `trial` is the inverse."""
    return np.array([r.share(values[name]) for name, r in space(algo, whole).items()])


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
    found = {"hyperparameters": config.hyperparameters, "search": record}
    if config.residual is None:
        entries[env_id]["whole_torque"] |= found
    else:
        entries[env_id] |= {"residual": config.residual["scale"], **found}
    runs.write_json(path, entries)
    return path


def run_command(args: Args) -> int:
    """Run the command; see `Args`. A ValueError says that there is nothing to search, or the budget is too small."""
    if args.algo not in SPACES:
        raise ValueError(f"nothing to search for {args.algo!r}; choose from {', '.join(SPACES)}")
    env_kwargs = args.keywords(args.env_id, training_model(args.whole))
    values = start(args.algo, args.env_id, args.whole, args.repeat)
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

    first = point(values, args.algo, args.whole)
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
    found = {"residual": configs[best].residual, **configs[best].hyperparameters}
    print(json.dumps({**record, **found}, indent=2))
    print(f"written to {path}")
    return 0
