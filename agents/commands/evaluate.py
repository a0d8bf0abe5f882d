"""Command that compares controllers on the same episodes: `solar-env evaluate`."""

from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Annotated

import tyro

from agents.commands.arguments import ModelOptions
from agents.comparison.evaluation import common_environment, evaluate
from agents.comparison.figures import comparison_figure
from agents.comparison.report import write_comparison
from agents.environments import with_sampling
from agents.laws.table import LAWS
from solar_env.commands.arguments import CommandRecord, WorkerOptions
from solar_env.support.files import make_folder
from solar_env.support.progress import print_markdown

CONTROLLERS = (
    f"laws ({', '.join(LAWS)}), shipped policies and run folders, and receding-horizon:OTHER, which searches with the "
    "simulator itself around another of these, and is slow; several runs under one name, NAME=FOLDER NAME=FOLDER, are "
    "pooled as training seeds of one controller"
)


@dataclass
class Args(ModelOptions, WorkerOptions, CommandRecord):
    """Compare controllers on the same evaluation episodes.

    Environment keywords that are not given come from the trained controllers, which must agree on them; without trained
    controllers, the model is rigid-clearance.
    """

    controllers: Annotated[list[str], tyro.conf.arg(help=CONTROLLERS)] = field(
        default_factory=lambda: ["passive", "damper", "servo"]
    )
    episodes: int = 100
    """episodes of each controller"""
    seed: int = 0
    """seed of the evaluation episodes, which are never training or validation episodes"""
    out: Path = Path("evaluation")
    """folder for episodes.csv, metrics.json, comparison.md and comparison.png"""
    env_id: str | None = None
    """environment id; by default the id that the given trained controllers share, otherwise solar_env/Deploy-v2"""


def run_command(args: Args) -> int:
    """Evaluate the controllers, and write and print the comparison; see `Args`."""
    given = args.keywords()
    env_id, common = common_environment(args.controllers, args.env_id, given)
    out = args.out
    make_folder(out)
    env_kwargs = with_sampling({**common, **given}, env_id)
    rows = evaluate(args.controllers, args.episodes, args.seed, env_id, env_kwargs, not args.quiet, args.workers)
    settings = {**asdict(args), "out": str(out), "env_id": env_id, "env_kwargs": env_kwargs}
    summary, tables = write_comparison(out, rows, settings)
    comparison_figure(summary, out / "comparison.png")
    print_markdown(tables)
    print(f"written to {out}")
    return 0
