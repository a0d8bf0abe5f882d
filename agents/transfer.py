"""Which model to train on: agents of every level, judged on every level: `python -m agents.transfer`."""

import shlex
import shutil
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from agents import runs
from agents.arguments import parse_arguments, run_command
from agents.comparison.figures import transfer_figure
from agents.comparison.report import header, summarize
from agents.comparison.statistics import Estimate
from agents.environments import DEFAULT_ENV_ID, check_seeds, episode_seeds, with_model
from agents.evaluate import STORE, evaluate
from agents.learning import configurations, learn
from solar_env.support.campaigns import Workers
from solar_env.support.readme import Section

FIGURE, TABLE = "transfer.png", "transfer.md"
COMPARISON = Path(__file__).parent / "comparison"
SECTION = Section(COMPARISON / "README.md", "transfer", "python -m agents.transfer --readme")

# Agents of all levels add to the same law, that of the level that counts: what differs is what they have learned.
LAW_MODEL = "flexible-clearance"
# Name -> keywords, from the cheapest to the one that counts.
LEVELS: dict[str, dict[str, Any]] = {
    "rigid": {"model": "rigid-clearance"},
    "2 elements": {"model": "flexible-clearance", "elements": 2},
    "4 elements": {"model": "flexible-clearance", "elements": 4},
    "6 elements": {"model": "flexible-clearance", "elements": 6},
}


EVALUATION_SEED = 1  # what the suites evaluate on, seed 0, is not for choosing a model to train on


@dataclass
class Args:
    """Train an agent on every level of the model and judge each on all of them."""

    algo: str = "ppo"
    """algorithm: ppo, sac or td3"""
    timesteps: int | None = None
    """environment steps of every training; None: the number in agents/configs"""
    seeds: list[int] = field(default_factory=lambda: [0])
    """training seeds; those of a level are pooled"""
    residual: float | None = None
    """as for train.py, but positive"""
    episodes: int = 20
    """evaluation episodes of every agent on every level"""
    env_id: str = DEFAULT_ENV_ID
    """environment id"""
    env_kwargs: dict[str, Any] = field(default_factory=dict)
    """environment keywords"""
    landings: int | None = None
    """as for train.py"""
    hyperparams: dict[str, Any] = field(default_factory=dict)
    """hyperparameters in place of those in agents/configs"""
    out: str = "transfer"
    """folder of runs, table and figure; what is complete there is not done again"""
    jobs: int | None = None
    """processes; None: one a processor"""
    cluster: str | None = None
    """ray: run on the Ray cluster that this machine belongs to"""
    readme: bool = False
    """put the table into the README and the figure beside its others"""
    quiet: bool = False
    """no progress bars"""


def train_all(args: Args, command: str) -> dict[str, list[Path]]:
    """Level -> run folders, trained where they are not complete.

    Raises:
        ValueError: a complete run there has another configuration.
    """
    wanted: dict[str, dict[Path, configurations.Configuration]] = {}
    for level, keywords in LEVELS.items():
        wanted[level] = {
            Path(args.out) / f"{level.replace(' ', '-')}-{seed}": configurations.configuration(
                args.algo,
                args.env_id,
                _on_level(args, keywords),
                seed,
                timesteps=args.timesteps,
                hyperparameters=args.hyperparams,
                residual=args.residual,
                landings=args.landings,
                law_model=LAW_MODEL,
            )
            for seed in args.seeds
        }
    everything = {folder: config for runs_of_level in wanted.values() for folder, config in runs_of_level.items()}
    learn.train_missing(everything, command, "cpu", Workers(args.jobs, args.cluster), not args.quiet)
    return {level: list(runs_of_level) for level, runs_of_level in wanted.items()}


def judge_all(args: Args, folders: Mapping[str, Sequence[Path]]) -> dict[str, dict[str, Estimate]]:
    """Level of the evaluation -> level of the training, and "passive" and "servo" -> interquartile mean return."""
    returns: dict[str, dict[str, Estimate]] = {}
    for level, keywords in LEVELS.items():
        names = ["passive", "servo", *(f"{name}={folder}" for name in folders for folder in folders[name])]
        rows = evaluate(
            names,
            args.episodes,
            EVALUATION_SEED,
            args.env_id,
            _on_level(args, keywords),
            not args.quiet,
            Workers(args.jobs, args.cluster),
            Path(args.out) / f"{level.replace(' ', '-')}-{STORE}",
        )
        returns[level] = {name: entry["return"] for name, entry in summarize(rows).items()}
    return returns


def _on_level(args: Args, keywords: Mapping[str, Any]) -> dict[str, Any]:
    """Environment keywords; those of the level may not be given."""
    return with_model(args.env_kwargs, keywords["model"], keywords.get("elements"), args.env_id)


def markdown(returns: Mapping[str, Mapping[str, Estimate]]) -> str:
    """The matrix as a table: a row for what was trained on, a column for what it is judged on."""
    lines = [
        "Interquartile mean return with its 95 % interval. All agents add to the servo tuned for flexible panels; the "
        "servo alone is the one tuned for rigid panels where it is judged on these.",
        "",
        *header(["trained on", *(f"judged on {level}" for level in returns)]),
    ]
    for name in next(iter(returns.values())):
        cells = [
            f"{value.mean:.3g} [{value.lower:.3g}, {value.upper:.3g}]" for value in (r[name] for r in returns.values())
        ]
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def main(argv: Sequence[str] | None = None) -> None:
    """The command line; see `Args`."""
    args = parse_arguments(Args, argv, prog="python -m agents.transfer")
    if args.readme:
        SECTION.read()  # refuses a page without a place before everything is trained
    episode_seeds("evaluation", EVALUATION_SEED, args.episodes)  # refuses a wrong number before everything is trained
    check_seeds(args.seeds)
    if args.residual == 0.0:
        raise ValueError("--residual 0: levels are compared by agents that add to the same law; give a positive share")
    command = shlex.join(["python", "-m", "agents.transfer", *(sys.argv[1:] if argv is None else argv)])
    returns = judge_all(args, train_all(args, command))
    out = Path(args.out)
    (out / TABLE).write_text(markdown(returns))
    runs.write_json(
        out / "transfer.json", {level: {k: vars(v) for k, v in row.items()} for level, row in returns.items()}
    )
    transfer_figure({level: {k: v.mean for k, v in row.items()} for level, row in returns.items()}, out / FIGURE)
    if args.readme:
        shutil.copy(out / FIGURE, COMPARISON / "figures" / FIGURE)
        SECTION.write(markdown(returns).strip())
    print(markdown(returns))
    print(f"written to {out}")


if __name__ == "__main__":
    run_command(main)
