"""Command that draws learning curves of every agent on every scenario: `solar-env curves`."""

import csv
import io
import itertools
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from agents.commands.arguments import ModelOptions, TrainingOptions
from agents.comparison.figures import learning_curves_figure
from agents.comparison.suites import MODEL, SUITES, WHOLE_TORQUE_MODEL
from agents.environments import check_distinct_seeds
from agents.learning import configurations, learn, runs
from solar_env.environment.registration import ENVIRONMENTS
from solar_env.support.files import copy_file, make_folder, write_text

FIGURE, TABLE = "learning_curves.png", "learning_curves.csv"

# (panel of the figure, algorithm) -> mean validation return (seeds, validations), after these steps (validations,).
Curves = dict[tuple[str, str], tuple[np.ndarray, np.ndarray]]


@dataclass
class Args(ModelOptions, TrainingOptions):
    """Train agents on both scenarios with several seeds and draw how their validation returns develop.

    The model is flexible-clearance unless another is named, and for the whole torque rigid-clearance.
    """

    algos: list[str] = field(default_factory=lambda: sorted(runs.ALGORITHMS))
    """algorithms; ars and cma-es command the whole torque alone"""
    seeds: list[int] = field(default_factory=lambda: [0, 1, 2, 3, 4])
    """training seeds of every agent"""
    suites: list[str] = field(default_factory=lambda: list(SUITES))
    """scenarios: paper (nominal) and robust (randomised)"""
    whole: bool = False
    """agents that command the whole torque too, on rigid panels, not only those that add to the tuned servo"""
    out: str = "curves"
    """folder of runs, table and figure; runs that are complete there are not trained again"""
    readme: bool = False
    """put figure and table beside the page, agents/README.md"""


def wanted_runs(args: Args) -> dict[tuple[str, str], dict[Path, configurations.Configuration]]:
    """Plan the runs: (panel, algorithm) -> run folder -> its configuration, one for each seed."""
    wanted: dict[tuple[str, str], dict[Path, configurations.Configuration]] = {}
    for suite, whole in itertools.product(args.suites, (False, True) if args.whole else (False,)):
        env_id = SUITES[suite]
        if whole:
            keywords = {**args.env_kwargs, **WHOLE_TORQUE_MODEL}
        else:
            keywords = args.keywords(env_id, MODEL)
        panel = f"{ENVIRONMENTS[env_id][0]}, {keywords['model']}, {'whole torque' if whole else 'added to the servo'}"
        residual, landings = (0.0, None) if whole else (None, args.landings)
        numbers = None, args.timesteps, args.hyperparams, residual, landings
        for algo in args.algos:
            if not whole and not configurations.entry(algo, env_id)["residual"]:
                continue  # it adds to no law
            name = f"{suite}-{algo}{'-whole' if whole else ''}"
            wanted[panel, algo] = {
                Path(args.out) / f"{name}-{seed}": configurations.complete(algo, env_id, keywords, seed, *numbers)
                for seed in args.seeds
            }
    return wanted


def curve(folders: Sequence[Path]) -> tuple[np.ndarray, np.ndarray]:
    """Read steps (validations,) and mean validation returns (runs, validations) of runs of one configuration."""
    histories = [runs.read_evaluations(folder) for folder in folders]
    return histories[0]["timesteps"], np.array([history["results"].mean(axis=1) for history in histories])


def write_table(curves: Curves, seeds: Sequence[int], path: Path) -> None:
    """Write a CSV file with a row for each validation of each run; the runs of an agent are those of the seeds."""
    text = io.StringIO(newline="")
    writer = csv.writer(text)
    writer.writerow(["task", "algorithm", "seed", "steps", "validation return"])
    for (panel, algo), (steps, returns) in curves.items():
        for seed, history in zip(seeds, returns, strict=True):
            writer.writerows([panel, algo, seed, int(s), float(r)] for s, r in zip(steps, history, strict=True))
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
    curves: Curves = {key: curve(list(of_agent)) for key, of_agent in wanted.items()}
    write_table(curves, args.seeds, out / TABLE)
    learning_curves_figure(curves, out / FIGURE)
    if args.readme:
        for name in (FIGURE, TABLE):
            copy_file(out / name, Path(__file__).parents[1] / "figures" / name)
    print(f"written to {out}")
    return 0
