"""Command that draws learning curves of every agent on every scenario: `solar-env curves`."""

import csv
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from agents.commands.arguments import ModelOptions, TrainingOptions
from agents.comparison.evaluation import evaluate
from agents.comparison.figures import Curve, learning_curves_figure
from agents.comparison.suites import RIGID, SUITES
from agents.environments import check_distinct_seeds, environment_settings
from agents.learning import configurations, learn, runs
from solar_env.environment.registration import ENVIRONMENTS
from solar_env.support.files import copy_file, make_folder, write_text

DRAWN = ("damper", "servo")  # the simplest tuned law and the best one
FIGURE, TABLE = "learning_curves.png", "learning_curves.csv"


@dataclass
class Args(ModelOptions, TrainingOptions):
    """Train agents on both scenarios with several seeds and draw how their validation returns develop, beside laws.

    The model is rigid-clearance unless another is named.
    """

    algos: list[str] = field(default_factory=lambda: sorted(runs.ALGORITHMS))
    """algorithms"""
    seeds: list[int] = field(default_factory=lambda: [0, 1, 2, 3, 4])
    """training seeds of every agent"""
    suites: list[str] = field(default_factory=lambda: list(SUITES))
    """scenarios: paper (nominal) and robust (randomised)"""
    out: str = "curves"
    """folder of runs, table and figure; runs that are complete there are not trained again"""
    readme: bool = False
    """put figure and table into agents/figures, for the page agents/learning/README.md"""


def tasks(args: Args) -> list[tuple[str, str, dict[str, Any]]]:
    """Name panel, environment id and keywords of every scenario that is asked for."""
    found = []
    for suite in args.suites:
        env_id = SUITES[suite]
        keywords = args.keywords(env_id, RIGID)
        found.append((f"{ENVIRONMENTS[env_id][0]}, {keywords['model']}", env_id, keywords))
    return found


def wanted_runs(args: Args) -> dict[tuple[str, str], dict[Path, configurations.Configuration]]:
    """Plan the runs: (panel, algorithm) -> run folder -> its configuration, one for each seed."""
    wanted: dict[tuple[str, str], dict[Path, configurations.Configuration]] = {}
    for suite, (panel, env_id, keywords) in zip(args.suites, tasks(args), strict=True):
        for algo in args.algos:
            wanted[panel, algo] = {
                Path(args.out) / f"{suite}-{algo}-{seed}": configurations.complete(
                    algo, env_id, keywords, seed, None, args.timesteps, args.hyperparams
                )
                for seed in args.seeds
            }
    return wanted


def curve(folder: Path, config: configurations.Configuration) -> Curve:
    """Read simulated time [s] and mean validation return (validations,) of a run."""
    history = runs.read_evaluations(folder)
    period = environment_settings(config.env_id, config.env_kwargs).task.control_period
    return period * history["timesteps"], history["results"].mean(axis=1)


def law_returns(args: Args) -> dict[tuple[str, str], float]:
    """Judge the laws that are drawn: (panel, law) -> mean return of as many held-out episodes as a validation has."""
    found = {}
    for panel, env_id, keywords in tasks(args):
        rows = evaluate(DRAWN, learn.VALIDATION_EPISODES, 0, env_id, keywords, not args.quiet, args.workers)
        for law in DRAWN:
            found[panel, law] = float(np.mean([row["return"] for row in rows if row["controller"] == law]))
    return found


def write_table(
    curves: Mapping[tuple[str, str], Sequence[Curve]],
    laws: Mapping[tuple[str, str], float],
    seeds: Sequence[int],
    path: Path,
) -> None:
    """Write a CSV file with a row for each validation of each run, and one for each law.

    The runs of an agent are those of the seeds; a law has none, and no time.
    """
    text = io.StringIO(newline="")
    writer = csv.writer(text)
    writer.writerow(["task", "controller", "seed", "simulated time [s]", "validation return"])
    for (panel, algo), of_agent in curves.items():
        for seed, (times, returns) in zip(seeds, of_agent, strict=True):
            writer.writerows([panel, algo, seed, round(t, 3), float(r)] for t, r in zip(times, returns, strict=True))
    writer.writerows([panel, law, "", "", mean] for (panel, law), mean in laws.items())
    write_text(path, text.getvalue())


def run_command(args: Args) -> int:
    """Run the command; see `Args`."""
    unknown = [suite for suite in args.suites if suite not in SUITES]
    if unknown:
        raise ValueError(f"no suite {unknown[0]!r}; available: {', '.join(SUITES)}")
    check_distinct_seeds(args.seeds)
    wanted = wanted_runs(args)
    out = make_folder(args.out)
    everything = {folder: config for of_agent in wanted.values() for folder, config in of_agent.items()}
    learn.train_missing(everything, args.command, "cpu", args.workers, not args.quiet)
    curves = {key: [curve(*run) for run in of_agent.items()] for key, of_agent in wanted.items()}
    laws = law_returns(args)
    write_table(curves, laws, args.seeds, out / TABLE)
    learning_curves_figure(curves, laws, out / FIGURE)
    if args.readme:
        for name in (FIGURE, TABLE):
            copy_file(out / name, Path(__file__).parents[1] / "figures" / name)
    print(f"written to {out}")
    return 0
