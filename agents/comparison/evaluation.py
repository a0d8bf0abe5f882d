"""Evaluation of controllers on the same episodes, which are tasks for any process, and what to compare them on."""

import hashlib
import json
from collections.abc import Collection, Mapping, Sequence
from dataclasses import asdict
from functools import cache, lru_cache
from pathlib import Path

import gymnasium
import numpy as np
from rich.console import Console

from agents.comparison.controllers import NamedController, parse_controller, parse_controllers
from agents.comparison.report import Row
from agents.configs import CONFIGS
from agents.environments import DEFAULT_ENV_ID, INTERFACE, MODEL, Keywords, episode_seeds, make_env, with_sampling
from agents.laws.baselines import is_tuned, make_baseline
from agents.laws.table import TUNABLE
from agents.learning import runs
from agents.policies import shipped
from agents.rollout import Figures, are_figures, run_episode
from agents.torque_laws import Controller, LawParameters
from solar_env.environment.registration import DEPLOY_RANDOMISED_V1, DEPLOY_V1
from solar_env.support.campaigns import Campaign, Cell, each_done
from solar_env.support.progress import counting_bar

STORE = "episodes.jsonl"
"""Name of a file that keeps the figures of finished episodes."""
# Name -> environment id of the scenario.
SUITES = {"paper": DEPLOY_V1, "robust": DEPLOY_RANDOMISED_V1}


def suite_controllers(env_id: str) -> list[str]:
    """List the passive deployment, and the laws and shipped policies that are for a scenario and the suites' model."""
    tuned = [name for name in TUNABLE if is_tuned(name, env_id, MODEL["model"])]
    trained = {name: shipped.load_shipped(name).description for name in shipped.available()}
    here = (env_id, MODEL["model"])
    return ["passive", *tuned, *(name for name, of in trained.items() if (of.env_id, of.env_kwargs["model"]) == here)]


def evaluate(
    controllers: Sequence[str],
    episodes: int,
    seed: int,
    env_id: str = DEFAULT_ENV_ID,
    env_kwargs: Mapping[str, object] | None = None,
    progress: bool = True,
    workers: int = 1,
    store: Path | None = None,
) -> list[Row]:
    """Run every controller on the same evaluation episodes.

    Args:
        controllers: See `agents.comparison.controllers.parse_controllers`. A tuned law has the parameters for the
            environment's model, see `agents.laws.baselines.load_parameters`.
        episodes: Episodes of each controller.
        seed: Chooses the block of evaluation seeds.
        env_id, env_kwargs: Environment; without "randomize", that of `with_sampling`. The observation and the action
            that a policy was trained with take precedence for it.
        progress, workers, store: As for `run_cells`.

    Returns:
        One row per controller and episode: controller, spec, episode, and the figures of `run_episode`.

    Raises:
        FileNotFoundError, ValueError: A controller does not exist, does not fit the environment, or goes by the name of
            another one; or the environment refuses its keywords.
    """
    seeds = episode_seeds("evaluation", seed, episodes)
    sampled = with_sampling(env_kwargs or {}, env_id)
    # Their interfaces are read first: damaged files are refused before any work.
    interfaces = {controller: controller.interface() for controller in parse_controllers(controllers)}
    labels = [
        {"controller": controller.name, "spec": controller.spec, "episode": episode}
        for controller in interfaces
        for episode in range(episodes)
    ]
    cells = [
        episode_cell(controller, env_id, sampled | interface, episode_seed)
        for controller, interface in interfaces.items()
        for episode_seed in seeds
    ]
    figures = run_cells(cells, workers, store, progress)
    return [{**label, **figure} for label, figure in zip(labels, figures, strict=True)]


def episode_cell(controller: NamedController, env_id: str, env_kwargs: Mapping[str, object], seed: int) -> Cell:
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
    cells: Sequence[Cell], workers: int = 1, store: Path | None = None, progress: bool = True
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
    env_kwargs: Mapping[str, object],
    seeds: Sequence[int],
    workers: int,
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


def common_environment(
    controllers: Sequence[str], env_id: str | None = None, given: Collection[str] = ()
) -> tuple[str, Keywords]:
    """Return the environment id and the keywords on which all trained ones among `controllers` agree.

    `env_id`, if not None, takes the place of the id; without either it is the nominal one. The ranges drawn in training
    belong to it: in another scenario, or beside the keywords `given`, they are left out, and so are these keywords.

    Raises:
        ValueError: They differ; what to compare on must then be given.
    """
    found = {each: of for each in controllers if (of := parse_controller(each).training())}
    ids = {of.env_id for of in found.values()}
    if env_id is None and len(ids) > 1:
        names = " and ".join(sorted(ids))
        raise ValueError(f"the controllers were trained on different environments, {names}; say with --env-id which")
    used = env_id or (ids.pop() if ids else DEFAULT_ENV_ID)
    agreed: Keywords | None = None
    for controller, of in found.items():
        others = {"randomize"} if given or of.env_id != used else set()
        kwargs = {name: v for name, v in of.env_kwargs.items() if name not in {*INTERFACE, *given, *others}}
        if agreed not in (None, kwargs):
            raise ValueError(
                f"{controller} was trained on {kwargs}, another on {agreed}; say with --env-kwargs what to compare on"
            )
        agreed = kwargs
    return used, agreed or {}
