"""Episodes as tasks for any process: cells of an evaluation, and of a tuning."""

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from functools import cache, lru_cache
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
from rich.console import Console

from agents.comparison.controllers import NamedController, parse_controller
from agents.environments import make_env
from agents.laws.baselines import CONFIGS, make_baseline
from agents.laws.table import TUNABLE
from agents.learning import runs
from agents.rollout import are_figures, run_episode
from agents.torque_laws import Controller, LawParameters
from solar_env.support.campaigns import ONE, Campaign, Cell, Workers, each_done
from solar_env.support.progress import counting_bar

Figures = dict[str, float | int | bool]


def episode_cell(controller: NamedController, env_id: str, env_kwargs: Mapping[str, Any], seed: int) -> Cell:
    """Make the cell of one episode of a controller; JSON keeps the environment keywords."""
    files = controller.files()
    return {
        "spec": controller.resolved,
        "policy": _digest(files) if files else None,
        "env_id": env_id,
        "env_kwargs": runs.jsonable(env_kwargs),
        "seed": seed,
    }


def run_cell(cell: Cell) -> Figures:
    """Run the episode of a cell and return its figures, see `agents.rollout.run_episode`."""
    env, controller = _prepared(json.dumps({**cell, "seed": None}))
    return run_episode(env, controller, cell["seed"])


@lru_cache(maxsize=4)
def _prepared(text: str) -> tuple[gymnasium.Env, Controller]:
    """Make environment and controller of a cell, kept from episode to episode."""
    cell = json.loads(text)
    env = _environment(cell["env_id"], json.dumps(cell["env_kwargs"]))
    if "parameters" in cell:
        return env, make_baseline(cell["spec"], env, TUNABLE[cell["spec"]].defaults.from_json(cell["parameters"]))
    return env, parse_controller(cell["spec"]).load(env)


@lru_cache(maxsize=4)
def _environment(env_id: str, keywords: str) -> gymnasium.Env:
    return make_env(env_id, json.loads(keywords))


def run_cells(
    cells: Sequence[Cell], workers: Workers = ONE, store: Path | None = None, progress: bool = True
) -> list[Figures]:
    """Run cells and return their figures, in their order; of cells that are alike one is run.

    Args:
        cells: Episodes to run.
        workers: Processes to run them on.
        store: File that keeps the figures, so that an interrupted evaluation goes on; None: no file.
        progress: Show a progress bar.

    Raises:
        ValueError: The file was written by other code or with other baselines, or is damaged.
    """
    keys = [json.dumps(cell, sort_keys=True) for cell in cells]
    different = dict(zip(keys, cells, strict=True))
    with counting_bar(Console(stderr=True, quiet=not progress)) as bar:
        task = bar.add_task("episodes", total=len(different))
        if store is None:
            done: dict[str, Figures] = {}
            for cell, figures in each_done(run_cell, different.values(), workers):
                done[json.dumps(cell, sort_keys=True)] = figures
                bar.advance(task)
        else:
            made_by = {"agents": _agents_digest()}
            campaign = Campaign(run_cell, tuple(different.values()), store, made_by, are_figures)
            bar.advance(task, len(different) - len(campaign.missing))
            for _ in campaign.run(workers):
                bar.advance(task)
            done = dict(zip(different, campaign.results(), strict=True))
    return [done[key] for key in keys]


def mean_returns(
    controller: str,
    candidates: Sequence[LawParameters],
    env_id: str,
    env_kwargs: Mapping[str, Any],
    seeds: Sequence[int],
    workers: Workers,
) -> list[float]:
    """Return the mean return of each candidate for the parameters of a law, over the same episodes."""
    law = {"spec": controller, "env_id": env_id, "env_kwargs": runs.jsonable(env_kwargs)}
    cells = [{**law, "parameters": asdict(parameters), "seed": seed} for parameters in candidates for seed in seeds]
    returns = [figures["return"] for figures in run_cells(cells, workers, progress=False)]
    return np.reshape(returns, (len(candidates), len(seeds))).mean(axis=1).tolist()


@cache
def _agents_digest() -> str:
    """Hash the code and the laws' parameters; hyperparameters are left out, as they change no trained policy."""
    code = sorted(Path(__file__).parents[1].rglob("*.py"))
    tuned = [path for name in TUNABLE if (path := CONFIGS / f"{name}.json").exists()]
    return _digest([*code, *tuned])


def _digest(paths: Sequence[Path]) -> str:
    digest = hashlib.sha256()
    for path in paths:
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]
