"""Episodes that can run anywhere: those of an evaluation, as cells of a campaign, and those of a tuning."""

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
from tqdm import tqdm

from agents import runs
from agents.comparison.controllers import load_controller, policy_files, resolved
from agents.environments import make_env
from agents.laws.baselines import CONFIGS, TUNABLE, Parameters, make_baseline
from agents.rollout import run_episode
from agents.torque_laws import Controller
from solar_env.support.campaigns import ONE, Campaign, Cell, Workers, each_done

Figures = dict[str, float | int | bool]


def episode_cell(spec: str, env_id: str, env_kwargs: Mapping[str, Any], seed: int) -> Cell:
    """The cell of one episode.

    Args:
        spec: A controller, see `agents.comparison.controllers.load_controller`.
        env_id: Environment id.
        env_kwargs: Environment keywords that JSON keeps.
        seed: Of the episode.
    """
    files = policy_files(spec)
    return {
        "spec": resolved(spec),
        "policy": _digest(files) if files else None,
        "env_id": env_id,
        "env_kwargs": runs.jsonable(env_kwargs),
        "seed": seed,
    }


def run_cell(cell: Cell) -> Figures:
    """Run the episode of a cell and return its figures, see `agents.rollout.run_episode`."""
    keywords = json.dumps(cell["env_kwargs"], sort_keys=True)
    env, controller = _prepared(cell["spec"], cell["policy"], cell["env_id"], keywords)
    return run_episode(env, controller, cell["seed"])


@lru_cache(maxsize=4)
def _prepared(spec: str, policy: str | None, env_id: str, keywords: str) -> tuple[gymnasium.Env, Controller]:
    """Environment and controller, kept from episode to episode; `policy` tells a changed file from the former."""
    env = make_env(env_id, json.loads(keywords))
    return env, load_controller(spec, env)


def run_cells(
    cells: Sequence[Cell], workers: Workers = ONE, store: Path | None = None, progress: bool = True
) -> list[Figures]:
    """The figures of all cells, in their order; of cells that are alike one is run.

    Args:
        cells: What to run.
        workers: Where.
        store: File that keeps the figures, so that an interrupted evaluation goes on; None keeps none.
        progress: Show a progress bar.

    Raises:
        ValueError: the file was written by other code or with other baselines.
    """
    keys = [json.dumps(cell, sort_keys=True) for cell in cells]
    different = dict(zip(keys, cells, strict=True))
    with tqdm(total=len(different), desc="evaluate", unit="episode", disable=not progress) as bar:
        if store is None:
            done: dict[str, Figures] = {}
            for cell, figures in each_done(run_cell, different.values(), workers):
                done[json.dumps(cell, sort_keys=True)] = figures
                bar.update()
        else:
            campaign = Campaign(run_cell, tuple(different.values()), store, {"agents": _agents_digest()})
            bar.update(len(different) - len(campaign.missing))
            for _ in campaign.run(workers):
                bar.update()
            done = dict(zip(different, campaign.results(), strict=True))
    return [done[key] for key in keys]


@dataclass(frozen=True)
class Trial:
    """One episode of one candidate: what, where, at which place among the candidates, and what wear costs extra."""

    controller: str
    env_id: str
    keywords: str
    parameters: Parameters
    candidate: int
    seed: int
    wear_cost: float


def trial_return(trial: Trial) -> float:
    """The return of a trial's episode, less what its deepest wear costs extra."""
    env = _environment(trial.env_id, trial.keywords)
    figures = run_episode(env, make_baseline(trial.controller, env, trial.parameters), trial.seed)
    return float(figures["return"]) - trial.wear_cost * float(figures["wear_depth_max_m"]) / 1e-15


@lru_cache(maxsize=1)
def _environment(env_id: str, keywords: str) -> gymnasium.Env:
    return make_env(env_id, json.loads(keywords))


def mean_returns(
    controller: str,
    candidates: Sequence[Parameters],
    env_id: str,
    env_kwargs: Mapping[str, Any],
    seeds: Sequence[int],
    workers: Workers,
    wear_cost: float,
) -> list[float]:
    """Mean return of each candidate for the parameters of a baseline, over the same episodes.

    1e-15 m of the deepest wear over a whole episode lower its return by `wear_cost`.
    """
    keywords = json.dumps(env_kwargs, sort_keys=True)
    trials = [
        Trial(controller, env_id, keywords, parameters, k, seed, wear_cost)
        for k, parameters in enumerate(candidates)
        for seed in seeds
    ]
    returns = dict(each_done(trial_return, trials, workers))
    # Added up in one order, whichever was done first.
    by_candidate = np.array([returns[trial] for trial in trials]).reshape(len(candidates), len(seeds))
    return by_candidate.mean(axis=1).tolist()


@cache
def _agents_digest() -> str:
    """Of the code and the baselines' parameters; what agents are trained with changes no policy that there is."""
    code = sorted(Path(__file__).parents[1].rglob("*.py"))
    return _digest([*code, *(CONFIGS / f"{name}.json" for name in TUNABLE)])


def _digest(paths: Sequence[Path]) -> str:
    digest = hashlib.sha256()
    for path in paths:
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]
