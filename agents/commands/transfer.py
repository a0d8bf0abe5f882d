"""Command that trains agents on every level of the model and judges each on all: `solar-env transfer`."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from agents.commands.arguments import Assignments, TrainingOptions
from agents.comparison.evaluation import STORE, evaluate
from agents.comparison.figures import transfer_figure
from agents.comparison.report import header, summarize, with_interval
from agents.comparison.statistics import Estimate
from agents.environments import DEFAULT_ENV_ID, check_distinct_seeds, check_episode_seeds, with_model
from agents.learning import configurations, learn, runs
from solar_env.support.files import copy_file, make_folder, write_text
from solar_env.support.readme import Section
from solar_env.support.terminal import print_markdown

FIGURE, TABLE = "transfer.png", "transfer.md"
COMPARISON = Path(__file__).parents[1] / "comparison"
SECTION = Section(COMPARISON / "README.md", "transfer", "solar-env transfer --readme")

# Name -> keywords, from the cheapest to the finest.
LEVELS: dict[str, dict[str, Any]] = {
    "rigid": {"model": "rigid-clearance"},
    "2 elements": {"model": "flexible-clearance", "elements": 2},
    "32 modes": {"model": "flexible-clearance", "modes": 32},
}


EVALUATION_SEED = 1  # not that of the suites: these episodes choose a model to train on


@dataclass
class Args(TrainingOptions):
    """Train an agent on every level of the model and judge each on all of them."""

    algo: str = "ars"
    """algorithm: ars, cma-es, ppo, sac or td3"""
    seeds: list[int] = field(default_factory=lambda: [0])
    """training seeds; those of a level are pooled"""
    episodes: int = 20
    """evaluation episodes of every agent on every level"""
    env_id: str = DEFAULT_ENV_ID
    """environment id"""
    env_kwargs: Assignments = field(default_factory=dict)
    """environment keywords"""
    out: str = "transfer"
    """folder of runs, table and figure; runs that are complete there are not trained again"""
    readme: bool = False
    """put the table into the README and the figure beside its others"""


def train_all(args: Args) -> dict[str, list[Path]]:
    """Train the runs that are not complete; level -> run folders.

    Raises:
        ValueError: A complete run there has another configuration.
    """
    wanted: dict[str, dict[Path, configurations.Configuration]] = {}
    for level, keywords in LEVELS.items():
        wanted[level] = {
            Path(args.out) / f"{level.replace(' ', '-')}-{seed}": configurations.complete(
                args.algo, args.env_id, on_level(args, keywords), seed, None, args.timesteps, args.hyperparams
            )
            for seed in args.seeds
        }
    everything = {folder: config for runs_of_level in wanted.values() for folder, config in runs_of_level.items()}
    learn.train_missing(everything, args.command, "cpu", args.workers, not args.quiet)
    return {level: list(runs_of_level) for level, runs_of_level in wanted.items()}


def judge_all(args: Args, folders: Mapping[str, Sequence[Path]]) -> dict[str, dict[str, Estimate]]:
    """Evaluate all on every level: level of the evaluation -> level of the training, or law -> mean return."""
    returns: dict[str, dict[str, Estimate]] = {}
    for level, keywords in LEVELS.items():
        names = ["passive", "servo", *(f"{name}={folder}" for name in folders for folder in folders[name])]
        rows = evaluate(
            names,
            args.episodes,
            EVALUATION_SEED,
            args.env_id,
            on_level(args, keywords),
            not args.quiet,
            args.workers,
            Path(args.out) / f"{level.replace(' ', '-')}-{STORE}",
        )
        returns[level] = {name: entry["return"] for name, entry in summarize(rows).items()}
    return returns


def on_level(args: Args, keywords: Mapping[str, Any]) -> dict[str, Any]:
    """Return the environment keywords on a level, which `--env-kwargs` must not contradict."""
    model, elements, modes = (keywords.get(name) for name in ("model", "elements", "modes"))
    return with_model(args.env_kwargs, model, elements, args.env_id, modes=modes)


def markdown(args: Args, returns: Mapping[str, Mapping[str, Estimate]]) -> str:
    """Write the matrix as a table: a row per level of training, a column per level of evaluation."""
    config = configurations.complete(args.algo, args.env_id, {}, 0, None, args.timesteps)
    lines = [
        f"Interquartile mean return with its 95 % interval, of agents of {args.algo} after {config.timesteps:,} steps. "
        "The servo is the one tuned for rigid panels where it is judged on these.",
        "",
        *header(["trained on", *(f"judged on {level}" for level in returns)]),
    ]
    for name in next(iter(returns.values())):
        cells = [with_interval(by_training[name], "{:.3g}") for by_training in returns.values()]
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def run_command(args: Args) -> int:
    """Run the command; see `Args`."""
    if args.readme:
        SECTION.read()  # refuses a page without a place before everything is trained
    check_episode_seeds(EVALUATION_SEED, args.episodes)
    check_distinct_seeds(args.seeds)
    out = make_folder(args.out)
    returns = judge_all(args, train_all(args))
    table = markdown(args, returns)
    write_text(out / TABLE, table)
    runs.write_json(
        out / "transfer.json", {level: {k: vars(v) for k, v in row.items()} for level, row in returns.items()}
    )
    transfer_figure({level: {k: v.mean for k, v in row.items()} for level, row in returns.items()}, out / FIGURE)
    if args.readme:
        copy_file(out / FIGURE, COMPARISON / "figures" / FIGURE)
        SECTION.write(table.strip())
    print_markdown(table)
    print(f"written to {out}")
    return 0
