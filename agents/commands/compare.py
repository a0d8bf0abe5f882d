"""Command that compares a controlled drive with a passive damper: `solar-env compare`."""

from dataclasses import asdict, dataclass
from pathlib import Path

from agents.commands.arguments import ModelOptions
from agents.comparison.passive_damper import Contest, answer
from agents.comparison.report import write_comparison
from agents.environments import DEFAULT_ENV_ID, RIGID, environment_settings, with_sampling
from agents.laws.table import TUNABLE
from solar_env.commands.arguments import ArrayOption, CommandRecord, WorkerOptions
from solar_env.support.files import make_folder
from solar_env.support.progress import print_markdown


@dataclass
class Args(ArrayOption, ModelOptions, WorkerOptions, CommandRecord):
    """Compare a controlled drive with a passive damper, on your array.

    The damping of the hinges and the drive's laws are tuned on the array, by the environment's return. A shipped policy
    takes part if it was trained for the same number of joints, lock angles and task. The model is rigid-clearance if no
    other is named. The drive's default torque limit can be changed, as in --env-kwargs torque_limit=0.3.
    """

    points: int = 100
    """candidates that the tuning of each drive law tries"""
    episodes: int = 20
    """evaluation episodes of each controller"""
    seed: int = 0
    """seed of the tuning and of the evaluation episodes"""
    out: Path = Path("compare")
    """folder for episodes.csv, metrics.json and comparison.md"""


def run_command(args: Args) -> int:
    """Tune a passive damper and torque laws for the drive, compare them, and write and print the comparison."""
    if args.points < 6:
        raise ValueError(f"points = {args.points} must be at least 6, a generation of the search")
    array = args.parameter_file
    given = {"parameters": array.parameters.to_dict(), **args.keywords(RIGID)}
    drawn = {"randomize": dict(array.randomize)} if array.randomize else {}
    env_kwargs = with_sampling({**drawn, **given}, DEFAULT_ENV_ID)
    limit = environment_settings(DEFAULT_ENV_ID, env_kwargs).task.torque_limit
    make_folder(args.out)
    contest = Contest(DEFAULT_ENV_ID, env_kwargs, args.points, 4, args.workers, args.seed, not args.quiet)
    rows, found = contest.rows(list(TUNABLE), args.episodes)
    settings = {**asdict(args), "out": str(args.out), "env_kwargs": env_kwargs, "found": found}
    summary, tables = write_comparison(args.out, rows, settings)
    print_markdown(tables)
    print(*answer(summary, found, limit), f"written to {args.out}", sep="\n")
    return 0
