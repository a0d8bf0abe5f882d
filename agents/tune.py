"""Tune the baselines by CMA-ES on the environment's return: `python -m agents.tune`."""

import json
import math
import shlex
import sys
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field, fields
from pathlib import Path
from typing import Any

import cma
import numpy as np
from tqdm import tqdm

from agents import runs
from agents.arguments import parse_arguments, run_command
from agents.comparison.episodes import mean_returns
from agents.environments import DEFAULT_ENV_ID, episode_seeds, make_env, with_model, with_sampling
from agents.laws.baselines import CONFIGS, TUNABLE, Parameters, episodes_spent, load_parameters
from solar_env.support.campaigns import Workers


@dataclass
class Args:
    """Tune a baseline by CMA-ES on the mean return and write its parameters for the model to agents/configs."""

    controller: str = "servo"
    """baseline to tune: brake, damper, servo, shaped, open-loop or soft-start"""
    episodes: int = 1600
    """budget of training episodes"""
    episodes_per_candidate: int = 4
    """episodes a candidate is judged by, the same for all of a generation"""
    validation_episodes: int = 20
    """episodes that decide between the candidates left at the end"""
    wear_cost: float = 0.0
    """what 1e-15 m of the deepest wear cost beside the return, which charges for wear after latching alone"""
    refine: str | None = None
    """environment id whose parameters for the model to start from instead of the default ones, searching closer to
    them"""
    seed: int = 0
    """seed of the search and of its episodes"""
    env_id: str = DEFAULT_ENV_ID
    """environment id"""
    model: str | None = None
    """rigid-ideal, rigid-clearance, flexible-ideal, flexible-clearance, or auto (see the environment); None:
    rigid-clearance"""
    elements: int | None = None
    """beam elements of each panel of a flexible model; None: 6"""
    env_kwargs: dict[str, Any] = field(default_factory=dict)
    """environment keywords"""
    jobs: int | None = None
    """processes; None: one a processor"""
    cluster: str | None = None
    """ray: run on the Ray cluster that this machine belongs to"""
    quiet: bool = False
    """no progress bar"""


def bounds(cls: type[Parameters]) -> np.ndarray:
    """(numbers, 2) least and greatest value of every number among the parameters, field by field."""
    numbers: list[tuple[float, float]] = []
    for f in fields(cls):
        default: Any = f.default
        numbers += [f.metadata["bounds"]] * np.size(default)
    return np.array(numbers)


def from_unit(cls: type[Parameters], unit: np.ndarray) -> Parameters:
    """Parameters of class `cls` from numbers in [0, 1], linearly within each field's bounds."""
    low, high = bounds(cls).T
    numbers = iter((low + np.asarray(unit) * (high - low)).tolist())
    values: list[Any] = []
    for f in fields(cls):
        default: Any = f.default
        several = isinstance(default, tuple)
        values.append(tuple(next(numbers) for _ in default) if several else next(numbers))
    return cls(*values)


def to_unit(parameters: Parameters) -> np.ndarray:
    """Inverse of `from_unit`."""
    low, high = bounds(type(parameters)).T
    values = np.concatenate([np.atleast_1d(value) for value in vars(parameters).values()])
    return (values - low) / (high - low)


def minimise(
    objective: Callable[[Sequence[np.ndarray]], Sequence[float]],
    start: np.ndarray,
    points: int,
    seed: int,
    progress: bool = True,
    spread: float = 0.25,
) -> list[np.ndarray]:
    """Minimise a noisy objective over the unit cube by CMA-ES (N. Hansen, 2016, arXiv:1604.00772).

    Args:
        objective: Points of a generation, each (n,) in [0, 1] -> their costs.
        start: Point (n,) to start from.
        points: Budget of points; there are as many whole generations as it holds.
        seed: Seed of the search.
        progress: Show a progress bar.
        spread: Standard deviation of the first generation in each direction.

    Returns:
        The start, the best point seen, and the final mean of the search distribution.

    Raises:
        ValueError: the budget holds no generation; nothing has been simulated then.
    """
    # Left to itself pycma draws from NumPy's global generator, which a training in between seeds anew.
    normal = np.random.RandomState(seed + 1).randn
    options = {"bounds": [0, 1], "seed": np.nan, "randn": normal, "verbose": -9}
    search = cma.CMAEvolutionStrategy(start, spread, options)
    generations = points // search.popsize
    if generations < 1:
        raise ValueError(f"a budget of {points} points holds no generation; give at least {search.popsize}")
    with tqdm(total=generations * search.popsize, desc="search", unit="point", disable=not progress) as bar:
        for _ in range(generations):
            asked = search.ask()
            costs = list(objective(asked))
            bar.update(len(asked))
            search.tell(asked, costs)
            bar.set_postfix(best=f"{min(costs):.4g}")
    return [np.asarray(start), search.result.xbest, search.result.xfavorite]


def tune(
    objective: Callable[[Sequence[np.ndarray], Sequence[int]], Sequence[float]],
    start: np.ndarray,
    episodes: int,
    episodes_per_candidate: int,
    seed: int,
    progress: bool = True,
    spread: float = 0.25,
) -> list[np.ndarray]:
    """`minimise` with common random numbers: all points of a generation have the same fresh training episodes.

    Args:
        objective: (points, each (n,) in [0, 1], episode seeds) -> costs of the points.
        start: Point (n,) to start from.
        episodes: Budget of episodes.
        episodes_per_candidate: Seeds handed to each call of `objective`.
        seed: Seed of the search; the episodes come from the training seeds of the same number.
        progress: Show a progress bar.
        spread: See `minimise`.

    Returns:
        As `minimise`.

    Raises:
        ValueError: as `minimise`.
    """
    used = 0

    def costs(points: Sequence[np.ndarray]) -> Sequence[float]:
        nonlocal used
        used += episodes_per_candidate
        return objective(points, episode_seeds("training", seed, used)[-episodes_per_candidate:])

    return minimise(costs, start, episodes // episodes_per_candidate, seed, progress, spread)


def store(controller: str, env_id: str, model: str, entry: dict[str, Any]) -> Path:
    """Write a tuned baseline to its file in `CONFIGS`, in place of the one for the same environment id and model."""
    path = CONFIGS / f"{controller}.json"
    entries = json.loads(path.read_text()) if path.exists() else {}
    entries.setdefault(env_id, {})[model] = entry
    runs.write_json(path, entries)
    return path


def main(argv: Sequence[str] | None = None) -> None:
    """The command line; see `Args`.

    Raises:
        ValueError: the controller has nothing to tune, the budget is too small, or as `make_env`.
    """
    args = parse_arguments(Args, argv, prog="python -m agents.tune")
    if args.controller not in TUNABLE:
        raise ValueError(f"nothing to tune in {args.controller!r}; choose from {', '.join(TUNABLE)}")
    untuned = TUNABLE[args.controller].defaults
    cls = type(untuned)
    env_kwargs = with_sampling(with_model(args.env_kwargs, args.model, args.elements, args.env_id), args.env_id)
    workers = Workers(args.jobs, args.cluster)

    simulated = 0

    def costs(points: Sequence[np.ndarray], seeds: Sequence[int]) -> list[float]:
        nonlocal simulated
        simulated += len(points) * len(seeds)
        parameters = [from_unit(cls, np.clip(point, 0.0, 1.0)) for point in points]
        returns = mean_returns(args.controller, parameters, args.env_id, env_kwargs, seeds, workers, args.wear_cost)
        return [-value for value in returns]

    with make_env(args.env_id, env_kwargs) as env:
        model = env.get_wrapper_attr("model")
    validation = episode_seeds("validation", args.seed, args.validation_episodes)
    if args.episodes_per_candidate < 1:
        raise ValueError(f"--episodes-per-candidate is {args.episodes_per_candidate}; give a positive number")
    if not 0.0 <= args.wear_cost < math.inf:
        raise ValueError(f"--wear-cost is {args.wear_cost}; give a finite number that is not negative")
    start = load_parameters(args.controller, args.refine, model) if args.refine else untuned
    spent = episodes_spent(args.controller, args.refine, model) if args.refine else 0
    candidates = tune(
        costs,
        to_unit(start),
        args.episodes,
        args.episodes_per_candidate,
        args.seed,
        progress=not args.quiet,
        spread=0.05 if args.refine else 0.25,
    )
    trained = simulated
    returns = [-cost for cost in costs(candidates, validation)]
    best = int(np.argmax(returns))
    entry = {
        "parameters": asdict(from_unit(cls, candidates[best])),
        "tuning": {
            "command": shlex.join(["python", "-m", "agents.tune", *(sys.argv[1:] if argv is None else argv)]),
            "env_kwargs": runs.jsonable(env_kwargs),
            "start": asdict(start),
            "training_episodes": trained,
            "training_episodes_with_start": spent + trained,
            "seed": args.seed,
            "validation_return": returns[best],
            "validation_return_before_tuning": returns[0],
        },
    }
    path = store(args.controller, args.env_id, model, entry)
    print(json.dumps(entry, indent=2))
    print(f"written to {path}")


if __name__ == "__main__":
    run_command(main)
