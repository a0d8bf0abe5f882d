"""`solar-env study learning`: learning curves of every agent, over several seeds, beside laws."""

import math
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console

from agents.comparison.evaluation import evaluate
from agents.comparison.figures import Curve, learning_curves_figure
from agents.environments import DEFAULT_ENV_ID, RIGID, environment_settings
from agents.learning import learn, runs
from solar_env.commands.study import Args
from solar_env.studies.common.tables import Row, Table, provenance, read_table, write_table
from solar_env.support.campaigns import each_done
from solar_env.support.files import make_folder
from solar_env.support.progress import counting_bar

OPTIONS = ("only", "quick", "draw", "out", "readme", "jobs")
LAWS = ("damper", "servo")  # the simplest tuned law and the best one
FIGURE, TABLE = "learning_curves.png", "learning_curves.csv"
FIGURES = Path(__file__).parents[2] / "figures"  # for the page agents/learning/README.md
SEEDS = (0, 1, 2, 3, 4)
QUICK_TIMESTEPS = 20_000  # of one seed; else five seeds take the number in agents/configs


def run(args: Args) -> int:
    """Train agents over five seeds and draw their learning curves; complete runs are not trained again."""
    algorithms = args.parts(sorted(runs.ALGORITHMS))
    out, figures = args.folders("learning", figures=FIGURES)
    if not args.draw:
        rows = list(_measured(args, algorithms, out))
        write_table(figures / TABLE, rows, provenance(args.command))
    curves, laws = drawn(read_table(figures / TABLE))
    learning_curves_figure(curves, laws, f"nominal, {RIGID['model']}", figures / FIGURE)
    print(f"written to {figures}")
    return 0


def _measured(args: Args, algorithms: list[str], out: Path) -> Iterator[Row]:
    """Train what is missing; yield a row for each validation of each run, and one without time for each law."""
    seeds, timesteps = ((0,), QUICK_TIMESTEPS) if args.quick else (SEEDS, None)
    wanted = {
        out / f"{algo}-{seed}": runs.complete(algo, DEFAULT_ENV_ID, RIGID, seed, None, timesteps)
        for algo in algorithms
        for seed in seeds
    }
    train_missing(wanted, args)
    for folder, config in wanted.items():
        for time, value in zip(*curve(folder, config), strict=True):
            simulated = round(float(time), 3)
            yield {"controller": config.algo, "seed": config.seed, "simulated_s": simulated, "return": float(value)}
    rows = evaluate(LAWS, learn.VALIDATION_EPISODES, 0, DEFAULT_ENV_ID, RIGID, not args.quiet, args.workers)
    for law in LAWS:
        mean = np.mean([row["return"] for row in rows if row["controller"] == law])
        yield {"controller": law, "seed": math.nan, "simulated_s": math.nan, "return": float(mean)}


def train_missing(wanted: dict[Path, runs.Configuration], args: Args) -> None:
    """Train those of the runs `wanted` that are not complete, side by side; those that were interrupted go on.

    Raises:
        ValueError: A run has another configuration.
    """
    origin: dict[str, Any] = {"command": "", "versions": {}, "resumed_from": None, "timesteps_before": 0}
    for folder, config in wanted.items():
        if (folder / runs.CONFIG).is_file() and replace(runs.read_config(folder), **origin) != config:
            raise ValueError(f"{folder} holds a run with another configuration; choose another --out")
    # One thread each and no bar: they run side by side.
    missing = [
        learn.Training(config, folder, folder if learn.has_checkpoint(folder) else None, args.command, False, 1)
        for folder, config in wanted.items()
        if not runs.is_complete(folder)
    ]
    for training in missing:
        make_folder(training.folder)
    with counting_bar(Console(stderr=True, quiet=args.quiet)) as bar:
        task = bar.add_task("runs", total=len(wanted), completed=len(wanted) - len(missing))
        for _ in each_done(learn.train, missing, args.workers):
            bar.advance(task)


def curve(folder: Path, config: runs.Configuration) -> Curve:
    """Read simulated time [s] and mean validation return (validations,) of a run."""
    history = runs.read_evaluations(folder)
    period = environment_settings(config.env_id, config.env_kwargs).task.control_period
    return period * history["timesteps"], history["results"].mean(axis=1)


def drawn(table: Table) -> tuple[dict[str, list[Curve]], dict[str, float]]:
    """Read curves by algorithm, one for each seed, and returns by law, as `learning_curves_figure` takes them."""
    curves: dict[str, list[Curve]] = {}
    laws: dict[str, float] = {}
    for controller in map(str, table.values("controller")):
        validations = table.where(controller=controller)
        if controller in LAWS:
            (laws[controller],) = validations.column("return")
            continue
        runs_of_agent = [validations.where(seed=seed) for seed in validations.values("seed")]
        curves[controller] = [(run.column("simulated_s"), run.column("return")) for run in runs_of_agent]
    return curves, laws
