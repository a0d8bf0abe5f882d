"""`solar-env study learning`: learning curves of every agent, over several seeds, beside laws."""

import math
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np

from agents.comparison.evaluation import evaluate
from agents.comparison.figures import Curve, learning_curves_figure
from agents.comparison.suites import RIGID
from agents.environments import DEFAULT_ENV_ID, environment_settings
from agents.learning import configurations, learn, runs
from solar_env.commands.study import Args
from solar_env.studies.common.tables import Row, Table, provenance, read_table, write_table

OPTIONS = ("only", "quick", "draw", "out", "readme", "jobs")
LAWS = ("damper", "servo")  # the simplest tuned law and the best one
FIGURE, TABLE = "learning_curves.png", "learning_curves.csv"
FIGURES = Path(__file__).parents[2] / "figures"  # for the page agents/learning/README.md
PANEL = f"nominal, {RIGID['model']}"


class Plan(NamedTuple):
    """Training seeds of every agent, and environment steps of a run; None for the number in agents/configs."""

    seeds: tuple[int, ...]
    timesteps: int | None


FULL, QUICK = Plan((0, 1, 2, 3, 4), None), Plan((0,), 20_000)


def run(args: Args) -> int:
    """Train agents over five seeds and draw their learning curves; complete runs are not trained again."""
    algorithms = args.parts(sorted(runs.ALGORITHMS))
    out, figures = args.folders("learning", figures=FIGURES)
    if not args.draw:
        rows = list(_measured(args, algorithms, QUICK if args.quick else FULL, out))
        write_table(figures / TABLE, rows, provenance(args.command))
    curves, laws = drawn(read_table(figures / TABLE))
    learning_curves_figure(curves, laws, figures / FIGURE)
    print(f"written to {figures}")
    return 0


def _measured(args: Args, algorithms: list[str], plan: Plan, out: Path) -> Iterator[Row]:
    """Train what is missing; yield a row for each validation of each run, and one without time for each law."""
    wanted = {
        (algo, seed): configurations.complete(algo, DEFAULT_ENV_ID, RIGID, seed, None, plan.timesteps)
        for algo in algorithms
        for seed in plan.seeds
    }
    folders = {key: out / "-".join(map(str, key)) for key in wanted}
    configs = {folders[key]: config for key, config in wanted.items()}
    learn.train_missing(configs, args.command, "cpu", args.workers, not args.quiet)
    for (algo, seed), config in wanted.items():
        for time, value in zip(*curve(folders[algo, seed], config), strict=True):
            yield {"controller": algo, "seed": seed, "simulated_s": round(float(time), 3), "return": float(value)}
    rows = evaluate(LAWS, learn.VALIDATION_EPISODES, 0, DEFAULT_ENV_ID, RIGID, not args.quiet, args.workers)
    for law in LAWS:
        mean = np.mean([row["return"] for row in rows if row["controller"] == law])
        yield {"controller": law, "seed": math.nan, "simulated_s": math.nan, "return": float(mean)}


def curve(folder: Path, config: configurations.Configuration) -> Curve:
    """Read simulated time [s] and mean validation return (validations,) of a run."""
    history = runs.read_evaluations(folder)
    period = environment_settings(config.env_id, config.env_kwargs).task.control_period
    return period * history["timesteps"], history["results"].mean(axis=1)


def drawn(table: Table) -> tuple[dict[tuple[str, str], list[Curve]], dict[tuple[str, str], float]]:
    """Read curves by algorithm, one for each seed, and returns by law, as `learning_curves_figure` takes them."""
    curves: dict[tuple[str, str], list[Curve]] = {}
    laws: dict[tuple[str, str], float] = {}
    for controller in map(str, table.values("controller")):
        own = table.where(controller=controller)
        if controller in LAWS:
            (laws[PANEL, controller],) = own.column("return")
            continue
        runs_of_agent = [own.where(seed=seed) for seed in own.values("seed")]
        curves[PANEL, controller] = [(run.column("simulated_s"), run.column("return")) for run in runs_of_agent]
    return curves, laws
