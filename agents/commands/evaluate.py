"""Command that compares controllers on the same episodes: `solar-env evaluate`."""

from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Annotated

import tyro

from agents.commands.arguments import ModelOptions
from agents.comparison.evaluation import STORE, SUITES, common_environment, evaluate, suite_controllers
from agents.comparison.figures import comparison_figure
from agents.comparison.report import write_comparison
from agents.environments import MODEL, with_sampling
from agents.laws.table import LAWS
from solar_env.commands.arguments import CommandRecord, WorkerOptions
from solar_env.support.files import make_folder
from solar_env.support.progress import print_markdown

CONTROLLERS = (
    f"laws ({', '.join(LAWS)}), shipped policies and run folders, and receding-horizon:OTHER, which searches with the "
    "simulator itself around another of these, and is slow; several runs under one name, NAME=FOLDER NAME=FOLDER, are "
    "pooled as training seeds of one controller; none: those of the suite, else passive, damper and servo"
)


@dataclass
class Args(ModelOptions, WorkerOptions, CommandRecord):
    """Compare controllers on the same evaluation episodes.

    Environment keywords that are not given are those of the suite, else those that the trained controllers have in
    common; without either, the model is rigid-clearance.
    """

    suite: str | None = None
    """paper or robust: the passive deployment, all tuned baselines and the shipped policies of a scenario, nominal or
    randomised, on flexible-clearance; names the folder too"""
    controllers: Annotated[list[str], tyro.conf.arg(help=CONTROLLERS)] = field(default_factory=list)
    episodes: int = 100
    """episodes of each controller"""
    seed: int = 0
    """chooses the evaluation episodes; they are never training or validation episodes"""
    out: str | None = None
    """folder (evaluation, or evaluation/SUITE) for episodes.csv, metrics.json, comparison.md and comparison.png, and
    for the finished episodes, with which an interrupted evaluation goes on"""
    env_id: str | None = None
    """environment id; by default that of the suite, else of the trained controllers given, else solar_env/Deploy-v2"""


def run_command(args: Args) -> int:
    """Run the command; see `Args`."""
    given = args.keywords()
    if args.suite:
        if args.suite not in SUITES:
            raise ValueError(f"no suite {args.suite!r}; available: {', '.join(SUITES)}")
        env_id = SUITES[args.suite]
        if args.env_id not in (None, env_id):
            raise ValueError(f"--suite {args.suite} is about {env_id}, not about {args.env_id}; leave --env-id out")
        controllers, common = args.controllers or suite_controllers(env_id), MODEL
    else:
        controllers = args.controllers or ["passive", "damper", "servo"]
        env_id, common = common_environment(controllers, args.env_id, given)
    out = Path(args.out or (Path("evaluation") / (args.suite or "")))
    make_folder(out)
    env_kwargs = with_sampling({**common, **given}, env_id)
    rows = evaluate(
        controllers, args.episodes, args.seed, env_id, env_kwargs, not args.quiet, args.workers, out / STORE
    )
    settings = {**asdict(args), "env_id": env_id, "env_kwargs": env_kwargs}
    summary, tables = write_comparison(out, rows, settings)
    comparison_figure(summary, out / "comparison.png")
    print_markdown(tables)
    print(f"written to {out}")
    return 0
