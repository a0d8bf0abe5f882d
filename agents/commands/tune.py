"""Command that tunes a torque law by CMA-ES on the environment's return: `solar-env tune`."""

import json
from dataclasses import asdict, dataclass
from typing import Annotated

import numpy as np
import tyro

from agents.commands.arguments import ModelOptions
from agents.comparison.law_search import LawSearch
from agents.configs import CONFIGS
from agents.environments import (
    DEFAULT_ENV_ID,
    OF_LAWS,
    environment_settings,
    with_interface,
    with_sampling,
)
from agents.laws.baselines import load_parameters, store_parameters, tuning_of
from agents.laws.table import TUNABLE
from agents.learning import runs
from solar_env.commands.arguments import CommandRecord, WorkerOptions
from solar_env.support.files import check_target


@dataclass
class Args(ModelOptions, WorkerOptions, CommandRecord):
    """Tune a torque law by CMA-ES; write parameters to agents/configs.

    Every model level has its own parameters there. The model is rigid-clearance unless another is named.
    """

    controller: Annotated[str, tyro.conf.arg(help=f"law to tune: {', '.join(TUNABLE)}")] = "servo"
    episodes: int = 1600
    """budget of training episodes"""
    episodes_per_candidate: int = 4
    """episodes that judge a candidate; all candidates of a generation have the same ones"""
    validation_episodes: int = 20
    """episodes that decide between the candidates left at the end"""
    refine: str | None = None
    """environment id whose tuned parameters start the search, which then stays closer to them"""
    seed: int = 0
    """seed of the search and of its episodes"""
    env_id: str = DEFAULT_ENV_ID
    """environment id"""


def run_command(args: Args) -> int:
    """Tune a law and store its parameters. Raise a ValueError if it has no parameters or the budget is too small."""
    if args.controller not in TUNABLE:
        raise ValueError(f"nothing to tune in {args.controller!r}; choose from {', '.join(TUNABLE)}")
    if args.episodes_per_candidate < 1:
        raise ValueError(f"--episodes-per-candidate is {args.episodes_per_candidate}; give a positive number")
    check_target(CONFIGS / f"{args.controller}.json")
    untuned = TUNABLE[args.controller].defaults
    keywords, workers = with_interface(args.keywords(), args.controller, OF_LAWS), args.workers
    env_kwargs = with_sampling(keywords, args.env_id)
    model = environment_settings(args.env_id, env_kwargs).level.name
    start = load_parameters(args.controller, args.refine, model) if args.refine else untuned
    before = tuning_of(args.controller, args.refine, model) if args.refine else {}
    points = args.episodes // args.episodes_per_candidate
    budget = points, args.episodes_per_candidate, args.validation_episodes
    search = LawSearch(args.controller, args.env_id, env_kwargs, *budget, args.seed, workers, not args.quiet)
    candidates, validated, simulated = search.run(start, 0.05 if args.refine else 0.25)
    best = int(np.argmax(validated))
    spent = before.get("training_episodes_with_start", before.get("training_episodes", 0))
    entry = {
        "parameters": asdict(candidates[best]),
        "tuning": {
            "command": args.command,
            "env_kwargs": runs.jsonable(env_kwargs),
            "start": asdict(start),
            "training_episodes": simulated,
            "training_episodes_with_start": spent + simulated,
            "seed": args.seed,
            "validation_return": validated[best],
            "validation_return_before_tuning": validated[0],
        },
    }
    path = store_parameters(args.controller, args.env_id, model, entry)
    print(json.dumps(entry, indent=2))
    print(f"written to {path}")
    return 0
