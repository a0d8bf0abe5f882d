"""Search hyperparameters of an agent by CMA-ES on its validation returns: `python -m agents.search`."""

import json
import math
import shlex
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from agents import runs
from agents.arguments import parse_arguments, run_command
from agents.comparison.suites import TRAINING_MODEL, WHOLE_TORQUE_MODEL
from agents.environments import DEFAULT_ENV_ID, with_model
from agents.laws.baselines import CONFIGS
from agents.learning import configurations, learn
from agents.tune import minimise
from solar_env.support.campaigns import Workers

SIGNIFICANT_DIGITS = 3
SPREAD = 0.1  # of the first generation, as a share of the ranges: much further out agents shake the array to pieces


@dataclass(frozen=True)
class Range:
    """Values of a hyperparameter that are searched, evenly or, if `logarithmic`, evenly in its logarithm."""

    low: float
    high: float
    logarithmic: bool = False

    def value(self, unit: float) -> float:
        """The value at a share of the way from `low` to `high`, to three digits."""
        if self.logarithmic:
            value = self.low * (self.high / self.low) ** unit
        else:
            value = self.low + unit * (self.high - self.low)
        return float(f"{value:.{SIGNIFICANT_DIGITS}g}")

    def share(self, value: float) -> float:
        """Inverse of `value`, within [0, 1]."""
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
class Args:
    """Search hyperparameters of an agent and write the best to agents/configs."""

    algo: str = "ppo"
    """algorithm: ppo, sac or td3"""
    trials: int = 24
    """training runs, in whole generations of 8, or 7 with --whole, and one more of the configuration as it is"""
    timesteps: int = 40_000
    """environment steps of every run"""
    seed: int = 0
    """seed of the search and of the runs"""
    env_id: str = DEFAULT_ENV_ID
    """environment id"""
    whole: bool = False
    """those of the agent that commands the whole torque, not of the one that adds to the tuned servo"""
    model: str | None = None
    """rigid-ideal, rigid-clearance, flexible-ideal or flexible-clearance; None: flexible-clearance with 4 elements, or
    rigid-clearance for the whole torque"""
    elements: int | None = None
    """beam elements of each panel of a flexible model; None: 4, or 6 for a model that was named"""
    env_kwargs: dict[str, Any] = field(default_factory=dict)
    """environment keywords"""
    landings: int | None = None
    """as for train.py"""
    repeat: bool = False
    """begin where the search began whose result is in agents/configs, and so repeat it, not at its result"""
    out: str = "search"
    """folder of the runs; those that are complete are not trained again"""
    jobs: int | None = None
    """processes; None: one a processor"""
    cluster: str | None = None
    """ray: run on the Ray cluster that this machine belongs to"""
    quiet: bool = False
    """no progress bar"""


def space(algo: str, whole: bool) -> dict[str, Range]:
    """What is searched; an agent that commands the whole torque has no residual."""
    if not whole:
        return SPACES[algo]
    return {name: WHOLE_TORQUE.get(name, r) for name, r in SPACES[algo].items() if name != "residual"}


def trial(args: Args, env_kwargs: dict[str, Any], unit: np.ndarray) -> configurations.Configuration:
    """The run of a point (n,) in [0, 1]."""
    ranges = space(args.algo, args.whole)
    chosen = {name: r.value(float(u)) for (name, r), u in zip(ranges.items(), unit, strict=True)}
    return configurations.configuration(
        args.algo,
        args.env_id,
        env_kwargs,
        args.seed,
        timesteps=args.timesteps,
        residual=chosen.pop("residual", 0.0),
        hyperparameters=_nested(chosen),
        landings=args.landings,
    )


def _nested(chosen: dict[str, float]) -> dict[str, Any]:
    """What was chosen, with what belongs to the policy in its place."""
    outer: dict[str, Any] = {name: value for name, value in chosen.items() if name != "log_std_init"}
    if "log_std_init" in chosen:
        outer["policy_kwargs"] = {"log_std_init": chosen["log_std_init"]}
    return outer


def start(algo: str, env_id: str, whole: bool = False, repeat: bool = False) -> dict[str, float]:
    """Values of the configuration as it is, or, to `repeat` the search that led there, as that one found it.

    Raises:
        ValueError: there is none for the environment, or no search to repeat.
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
    """The point (n,) in [0, 1] of some values; inverse of what `trial` makes of one."""
    return np.array([r.share(values[name]) for name, r in space(algo, whole).items()])


def score(folder: Path) -> float:
    """Mean return of a run's validation episodes in the last third of its validations.

    What counts in the end is the best of them, but one alone is luck: episodes with clearance scatter.
    """
    with np.load(folder / "evaluations.npz") as history:
        means = history["results"].mean(axis=1)
    return float(means[-math.ceil(len(means) / 3) :].mean())


def store(algo: str, env_id: str, config: configurations.Configuration, record: dict[str, Any]) -> Path:
    """Write the best hyperparameters to their file in `CONFIGS`, with what is known of the search."""
    path = CONFIGS / f"{algo}.json"
    entries = json.loads(path.read_text())
    found = {"hyperparameters": config.hyperparameters, "search": record}
    if config.residual is None:
        entries[env_id]["whole_torque"] |= found
    else:
        entries[env_id] |= {"residual": config.residual["scale"], **found}
    runs.write_json(path, entries)
    return path


def main(argv: Sequence[str] | None = None) -> None:
    """The command line; see `Args`.

    Raises:
        ValueError: there is nothing to search for, the budget holds no generation, or as
            `configurations.configuration`.
    """
    args = parse_arguments(Args, argv, prog="python -m agents.search")
    if args.algo not in SPACES:
        raise ValueError(f"nothing to search for {args.algo!r}; choose from {', '.join(SPACES)}")
    default = WHOLE_TORQUE_MODEL if args.whole else TRAINING_MODEL
    env_kwargs = with_model(args.env_kwargs, args.model, args.elements, args.env_id, default)
    command = shlex.join(["python", "-m", "agents.search", *(sys.argv[1:] if argv is None else argv)])
    scores: dict[Path, float] = {}
    configs: dict[Path, configurations.Configuration] = {}

    def costs(points: Sequence[np.ndarray]) -> list[float]:
        generation = [trial(args, env_kwargs, np.clip(point, 0.0, 1.0)) for point in points]
        folders = [Path(args.out) / f"trial-{len(configs) + k}" for k in range(len(generation))]
        wanted = dict(zip(folders, generation, strict=True))
        learn.train_missing(wanted, command, "cpu", Workers(args.jobs, args.cluster), progress=False)
        configs.update(wanted)
        scores.update({folder: score(folder) for folder in folders})
        return [-scores[folder] for folder in folders]

    values = start(args.algo, args.env_id, args.whole, args.repeat)
    first = point(values, args.algo, args.whole)
    minimise(costs, first, args.trials, args.seed, progress=not args.quiet, spread=SPREAD)
    before = -costs([first])[0]
    best = max(scores, key=scores.__getitem__)
    record = {
        "command": command,
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


if __name__ == "__main__":
    run_command(main)
