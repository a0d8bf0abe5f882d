"""Command that compares controllers on the same episodes: `solar-env evaluate`."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Annotated, Any

import tyro

from agents.commands.arguments import ModelOptions
from agents.comparison.evaluation import (
    MODEL,
    STORE,
    SUITES,
    common_env_id,
    common_env_kwargs,
    evaluate,
    suite_controllers,
)
from agents.comparison.figures import comparison_figure
from agents.comparison.report import write_comparison
from agents.environments import with_sampling
from agents.laws.table import LAWS
from solar_env.commands.arguments import CommandRecord, WorkerOptions
from solar_env.support.files import copy_file, make_folder
from solar_env.support.readme import Section
from solar_env.support.terminal import print_markdown

FIGURE = "comparison.png"
COMPARISON = Path(__file__).parents[1] / "comparison"

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
    """environment id; by default that of the suite, else of the trained controllers given, else solar_env/Deploy-v1"""
    readme: bool = False
    """write a suite's table into the README, and its figure beside the README's others"""


def run_command(args: Args) -> int:
    """Run the command; see `Args`."""
    if args.readme:
        _section(args).read()  # refuses a page without a place before everything is evaluated
    if args.suite:
        env_id, controllers, common = suite_named(args.suite, args.env_id, args.controllers)
    else:
        controllers = args.controllers or ["passive", "damper", "servo"]
        env_id = args.env_id or common_env_id(controllers)
        common = {}
    given = args.keywords()
    given = {**(common or common_env_kwargs(controllers, env_id, given)), **given}
    out = Path(args.out or (Path("evaluation") / (args.suite or "")))
    make_folder(out)
    env_kwargs = with_sampling(given, env_id)
    rows = evaluate(
        controllers, args.episodes, args.seed, env_id, env_kwargs, not args.quiet, args.workers, out / STORE
    )
    settings = {**asdict(args), "env_id": env_id, "env_kwargs": env_kwargs}
    summary, tables = write_comparison(out, rows, settings)
    comparison_figure(summary, out / FIGURE)
    if args.readme:
        copy_file(out / FIGURE, COMPARISON / "figures" / f"suite-{args.suite}.png")
        _section(args).write(tables.folded().strip())
    print_markdown(str(tables))
    print(f"written to {out}")
    return 0


def suite_section(suite: str) -> Section:
    """The section of the page with the table of a suite."""
    return Section(COMPARISON / "README.md", f"suite {suite}", f"solar-env evaluate --suite {suite} --readme")


def _section(args: Args) -> Section:
    """The section that the arguments are to write."""
    kept = {name: getattr(args, name) for name in ("suite", "out", "jobs", "quiet", "command")}
    whole = Args(readme=True, **kept)
    if args.suite is None or args != whole:
        raise ValueError(
            "--readme writes the result of a whole suite: it needs --suite, and takes no other controllers, episodes, "
            "seed or environment"
        )
    return suite_section(args.suite)


def suite_named(name: str, env_id: str | None, controllers: Sequence[str]) -> tuple[str, list[str], dict[str, Any]]:
    """Return environment id, controllers and environment keywords of a suite; controllers that are given go first.

    Raises:
        ValueError: There is no such suite, or an environment id was given too.
    """
    if name not in SUITES:
        raise ValueError(f"no suite {name!r}; available: {', '.join(SUITES)}")
    scenario = SUITES[name]
    if env_id not in (None, scenario):
        raise ValueError(f"--suite {name} is about {scenario}, not about {env_id}; leave --env-id out")
    return scenario, list(controllers) or suite_controllers(scenario), dict(MODEL)
