"""`solar-env study learning`: returns of policies in training by Stable-Baselines3 or CMA-ES, and of torque laws."""

import math
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from rich.console import Console

from agents.comparison.evaluation import evaluate
from agents.comparison.figures import Panel, learning_curves_figure
from agents.environments import MODEL, RIGID, Keywords
from agents.learning import runs
from agents.learning.training import train
from solar_env.commands.study import Args
from solar_env.environment.registration import DEPLOY, DEPLOY_RANDOMISED
from solar_env.studies.common.tables import Row, Table, provenance, read_table, write_table
from solar_env.support.campaigns import each_done
from solar_env.support.plain_arrays import read_json
from solar_env.support.progress import counting_bar

OPTIONS = ("only", "quick", "draw", "out", "readme", "jobs")
LAWS = ("pd", "soft-start", "servo")
FIGURE, TABLE = "learning_curves.png", "learning_curves.csv"
FIGURES = Path(__file__).parents[2] / "learning" / "figures"  # for the page agents/learning/README.md
SEEDS = (0, 1, 2, 3, 4)
# `SCENES`: name -> environment id and keywords. `LENGTHS`: algorithm -> steps, environments stepped together. A run
# takes a quarter of an hour of a core with rigid panels, an hour with flexible panels.
SCENES: dict[str, tuple[str, Keywords]] = {
    "rigid": (DEPLOY, dict(RIGID)),
    "rigid-randomised": (DEPLOY_RANDOMISED, dict(RIGID)),
    "flexible": (DEPLOY, dict(MODEL)),
    "flexible-randomised": (DEPLOY_RANDOMISED, dict(MODEL)),
}
LENGTHS = {"ppo": (100_000, 1), "sac": (30_000, 1), "tqc": (30_000, 1), "ars": (150_000, 1), "cma-es": (150_000, 16)}
REFINED, BEFORE = "refined", "ppo"  # CMA-ES over the last layer of the best policy of each run of PPO
LENGTHS[REFINED] = (60_000, 16)
CASES = {f"{algo}-{scene}": (algo, scene) for algo in LENGTHS for scene in SCENES}
QUICK_TIMESTEPS = 4096  # steps of a quick run, which has one seed
EPISODES = 20  # evaluation episodes of a torque law
PACE = "seconds_per_step.json"  # file of a run folder, written when the run has ended


def run(args: Args) -> int:
    """Train agents with five seeds each and draw all learning curves; finished runs are not trained again.

    Finished runs in the folder --out replace their curves in learning_curves.csv, from which all curves are drawn.
    Curves without such runs keep the values that this file already has.
    """
    cases = args.parts(list(CASES))
    out, figures = args.folders("learning", figures=FIGURES)
    out = out / "quick" if args.quick else out
    if not args.draw:
        _train_missing(args, cases, out)
        rows = list(_rows(args, out))
        found = {(row["scene"], row["controller"]) for row in rows}
        before = read_table(figures / TABLE).rows if (figures / TABLE).is_file() else ()
        rows += [dict(row) for row in before if (row["scene"], row["controller"]) not in found]
        rows.sort(key=lambda row: list(SCENES).index(str(row["scene"])))
        write_table(figures / TABLE, rows, provenance(args.command))
    learning_curves_figure(panels(read_table(figures / TABLE)), figures / FIGURE)
    print(f"written to {figures}")
    return 0


def _train_missing(args: Args, cases: list[str], out: Path) -> None:
    wanted: dict[Path, runs.Configuration] = {}  # configurations by run folder
    for case in cases:
        algo, scene = CASES[case]
        (timesteps, lanes), (env_id, keywords) = LENGTHS[algo], SCENES[scene]
        for seed in (0,) if args.quick else SEEDS:
            steps, hyperparameters = QUICK_TIMESTEPS if args.quick else timesteps, dict[str, object]()
            if algo == REFINED:
                hyperparameters = {"start": str(_folder(out, BEFORE, scene, seed) / runs.BEST)}
            about = seed, lanes, steps, hyperparameters, args.command
            name = "cma-es" if algo == REFINED else algo
            wanted[_folder(out, algo, scene, seed)] = runs.Configuration(name, env_id, keywords, *about)
    missing = {folder: config for folder, config in wanted.items() if not (folder / PACE).is_file()}
    with counting_bar(Console(stderr=True, quiet=args.quiet)) as bar:
        task = bar.add_task("runs", total=len(wanted), completed=len(wanted) - len(missing))
        for refined in (False, True):  # refined runs begin with the policies of other runs
            todo = [run for run in missing.items() if run[0].name.startswith(REFINED) == refined]
            for _ in each_done(_train, todo, args.workers):
                bar.advance(task)


def _folder(out: Path, algo: str, scene: str, seed: int) -> Path:
    """Return the folder of a training run, given algorithm, environment (`scene`, a key of `SCENES`) and seed."""
    return out / f"{algo}-{scene}-{seed}"


def _train(run: tuple[Path, runs.Configuration]) -> None:
    """Train the missing steps of a run (folder and configuration), and record its CPU time per step in the folder."""
    folder, config = run
    done, began = _steps(folder), time.process_time()
    train(config, folder, config.timesteps, progress=False)
    runs.write_json(folder / PACE, (time.process_time() - began) / (config.timesteps - done))


def _steps(folder: Path) -> int:
    """Return the environment steps up to a run's last validation; 0 without a validation."""
    return int(runs.read_evaluations(folder)["timesteps"][-1]) if (folder / runs.EVALUATIONS).is_file() else 0


def _rows(args: Args, out: Path) -> Iterator[Row]:
    """Yield a row of mean returns per validation of each finished training run, and per torque law (no steps: NaN)."""
    for scene, (env_id, keywords) in SCENES.items():
        folders = [(algo, seed, _folder(out, algo, scene, seed)) for algo in LENGTHS for seed in SEEDS]
        trained = [(algo, seed, folder) for algo, seed, folder in folders if (folder / PACE).is_file()]
        for algo, seed, folder in trained:
            history, pace, steps_before, time_before = runs.read_evaluations(folder), read_json(folder / PACE), 0, 0.0
            if algo == REFINED:
                before = _folder(out, BEFORE, scene, seed)
                steps_before = _steps(before)
                time_before = steps_before * read_json(before / PACE)
            for steps, value in zip(history["timesteps"].tolist(), history["results"].mean(axis=1), strict=True):
                yield _row(scene, algo, float(value), seed, steps_before + steps, time_before + pace * steps)
        rows = evaluate(LAWS, EPISODES, 0, env_id, keywords, not args.quiet, args.workers) if trained else []
        for law in LAWS if trained else ():
            mean = float(np.mean([row["return"] for row in rows if row["controller"] == law]))
            yield _row(scene, law, mean)


def _row(
    scene: str, controller: str, value: float, seed: float = math.nan, steps: float = math.nan, time: float = math.nan
) -> Row:
    of_run: Row = {"scene": scene, "controller": controller, "seed": seed}
    return {**of_run, "steps": steps, "seconds": time, "return": value}


def panels(table: Table) -> dict[str, Panel]:
    """Sort a table of returns into subplot data (`Panel`) per environment: learning curves, torque laws' returns."""
    found = {}
    for scene in map(str, table.values("scene")):
        of_scene = table.where(scene=scene)
        panel = found[scene] = Panel({}, {})
        for controller in map(str, of_scene.values("controller")):
            validations = of_scene.where(controller=controller)
            if controller in LAWS:
                (panel.laws[controller],) = validations.column("return")
                continue
            of_agent = [validations.where(seed=seed) for seed in validations.values("seed")]
            panel.curves[controller] = [
                (run.column("steps"), run.column("seconds"), run.column("return")) for run in of_agent
            ]
    return found
