"""`solar-env study learning`: learning curves of stock agents and of a search, over several seeds, beside laws."""

import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from rich.console import Console

from agents.comparison.evaluation import evaluate
from agents.comparison.figures import Curve, learning_curves_figure
from agents.environments import RIGID
from agents.learning import runs
from agents.learning.training import ALGORITHMS, train
from solar_env.commands.study import Args
from solar_env.environment.registration import DEPLOY
from solar_env.studies.common.tables import Row, Table, provenance, read_table, write_table
from solar_env.support.campaigns import each_done
from solar_env.support.progress import counting_bar

OPTIONS = ("only", "quick", "draw", "out", "readme", "jobs")
LAWS = ("pd", "soft-start", "servo")
FIGURE, TABLE = "learning_curves.png", "learning_curves.csv"
FIGURES = Path(__file__).parents[2] / "figures"  # for the page agents/learning/README.md
SEEDS = (0, 1, 2, 3, 4)
# Steps of an environment that a quarter of an hour of a core is enough for, and environments stepped together.
LENGTHS = {"ppo": (150_000, 1), "sac": (30_000, 1), "td3": (30_000, 1), "tqc": (30_000, 1), "ars": (150_000, 1)}
LENGTHS["cma-es"] = (150_000, 16)
QUICK_TIMESTEPS = 4096  # of one seed
EPISODES = 20  # of a law


def run(args: Args) -> int:
    """Train agents over five seeds and draw their learning curves; finished runs are not trained again."""
    algorithms = args.parts(sorted(ALGORITHMS))
    out, figures = args.folders("learning", figures=FIGURES)
    if not args.draw:
        rows = list(_measured(args, algorithms, out))
        write_table(figures / TABLE, rows, provenance(args.command))
    curves, laws = drawn(read_table(figures / TABLE))
    learning_curves_figure(curves, laws, f"nominal, {RIGID['model']}", figures / FIGURE)
    print(f"written to {figures}")
    return 0


def _measured(args: Args, algorithms: list[str], out: Path) -> Iterator[Row]:
    """Train what is missing; yield a row for each validation of each run, and one without steps for each law."""
    wanted: dict[Path, runs.Configuration] = {}
    for algo in algorithms:
        timesteps, lanes = LENGTHS[algo]
        for seed in (0,) if args.quick else SEEDS:
            steps = QUICK_TIMESTEPS if args.quick else timesteps
            config = runs.Configuration(algo, DEPLOY, dict(RIGID), seed, lanes, steps, {}, args.command)
            wanted[out / f"{algo}-{seed}"] = config
    missing = [folder for folder, config in wanted.items() if _steps(folder) < config.timesteps]
    for folder in missing:
        if not (folder / runs.CONFIG).is_file():
            runs.new_run_folder(folder, wanted[folder])
    with counting_bar(Console(stderr=True, quiet=args.quiet)) as bar:
        task = bar.add_task("runs", total=len(wanted), completed=len(wanted) - len(missing))
        for _ in each_done(_train, missing, args.workers):
            bar.advance(task)
    for folder, config in wanted.items():
        history = runs.read_evaluations(folder)
        for steps, value in zip(history["timesteps"], history["results"].mean(axis=1), strict=True):
            yield {"controller": config.algo, "seed": config.seed, "steps": int(steps), "return": float(value)}
    rows = evaluate(LAWS, EPISODES, 0, DEPLOY, RIGID, not args.quiet, args.workers)
    for law in LAWS:
        mean = np.mean([row["return"] for row in rows if row["controller"] == law])
        yield {"controller": law, "seed": math.nan, "steps": math.nan, "return": float(mean)}


def _train(folder: Path) -> None:
    config = runs.read_config(folder)
    train(config, folder, config.timesteps, progress=False)


def _steps(folder: Path) -> int:
    """Steps of the last validation of a run, 0 where there is none."""
    return int(runs.read_evaluations(folder)["timesteps"][-1]) if (folder / runs.EVALUATIONS).is_file() else 0


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
        curves[controller] = [(run.column("steps"), run.column("return")) for run in runs_of_agent]
    return curves, laws
