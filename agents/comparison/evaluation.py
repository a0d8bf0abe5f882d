"""Evaluation of controllers on the same episodes, by several processes, in an environment that suits all of them."""

import contextlib
import hashlib
import json
import warnings
from collections.abc import Collection, Mapping, Sequence
from functools import lru_cache
from pathlib import Path

import gymnasium
from rich.console import Console

from agents.comparison.controllers import NamedController, parse_controller, parse_controllers
from agents.comparison.report import Row
from agents.environments import (
    DEFAULT_ENV_ID,
    INTERFACE,
    OF_LAWS,
    Keywords,
    episode_seeds,
    make_env,
    with_interface,
    with_sampling,
)
from agents.laws.baselines import UntunedWarning, make_baseline
from agents.laws.table import TUNABLE
from agents.learning import runs
from agents.rollout import run_episode
from agents.torque_laws import Controller
from solar_env.mechanics.running.diagnosis import warn
from solar_env.mechanics.running.errors import SimulationError
from solar_env.studies.common.failures import told
from solar_env.support.campaigns import Cell, each_done
from solar_env.support.progress import counting_bar


def evaluate(
    controllers: Sequence[str],
    episodes: int,
    seed: int,
    env_id: str = DEFAULT_ENV_ID,
    env_kwargs: Mapping[str, object] | None = None,
    progress: bool = True,
    workers: int = 1,
) -> list[Row]:
    """Run every controller on the same evaluation episodes.

    Args:
        controllers: Texts `NAME=SPEC` or SPEC; SPEC is, for example, a torque law or a run folder, see
            `parse_controllers`. A tuned law has the parameters for the environment's model.
        episodes: Episodes of each controller.
        seed: Chooses the block of evaluation seeds.
        env_id, env_kwargs: Environment id and keywords. If they give no random ranges, the joints' release rates are
            sampled. Each controller gets its own observation, action and control period.
        progress: Show a progress bar.
        workers: Processes to run the episodes on.

    Returns:
        One row per controller and episode: "controller" (its NAME), "spec" (its SPEC), "episode", and the results of
        `run_episode`. Episodes that fail under one controller are left out for all controllers, with a warning.

    Raises:
        FileNotFoundError, ValueError: A controller does not exist, does not fit the environment, or has the name of
            another one. The environment refuses a keyword, or a keyword contradicts the observation, action or control
            period of a controller. More than a tenth of the episodes failed.
    """
    seeds = episode_seeds("evaluation", seed, episodes)
    sampled = with_sampling(env_kwargs or {}, env_id)
    # Read the controllers' interfaces first, to refuse damaged files before any work.
    interfaces = {controller: controller.interface() for controller in parse_controllers(controllers)}
    keywords = {each: with_interface(sampled, each.name, interface) for each, interface in interfaces.items()}
    labels = [
        {"controller": controller.name, "spec": controller.spec, "episode": episode}
        for controller in interfaces
        for episode in range(episodes)
    ]
    cells = [
        episode_cell(controller, env_id, of_controller, episode_seed)
        for controller, of_controller in keywords.items()
        for episode_seed in seeds
    ]
    rows: list[Row] = [{**label, **of} for label, of in zip(labels, run_cells(cells, workers, progress), strict=True)]
    return without_failed(rows)


def without_failed(rows: Sequence[Row]) -> list[Row]:
    """Return the rows of the episodes whose simulation succeeds under every controller, and warn of the others.

    Raises:
        ValueError: More than a tenth of the simulations failed.
    """
    failed = [row for row in rows if "failure" in row]
    names = {f"{row['controller']}, episode {row['episode']}, seed {row['seed']}": row["failure"] for row in failed}
    if text := told(names, len(rows)):
        warn(f"{text} Their episodes are left out of all controllers' figures")
    out = {row["episode"] for row in failed}
    return [row for row in rows if row["episode"] not in out]


def fitting(laws: Sequence[str], env_id: str, env_kwargs: Mapping[str, object]) -> list[str]:
    """Return the laws that fit an environment: it has the observations that they read, and it drives a single hinge."""
    env, found = make_env(env_id, {**env_kwargs, **OF_LAWS}), []
    for law in laws:
        with contextlib.suppress(ValueError), warnings.catch_warnings():
            warnings.simplefilter("ignore", UntunedWarning)
            make_baseline(law, env)
            found.append(law)
    return found


def episode_cell(controller: NamedController, env_id: str, env_kwargs: Mapping[str, object], seed: int) -> Cell:
    """Describe one episode of a controller as a cell: a dictionary that JSON can store and `run_cell` takes."""
    files = controller.files()
    return {
        "spec": controller.resolved,
        "policy": _digest(files) if files else None,
        "env_id": env_id,
        "env_kwargs": runs.jsonable(env_kwargs),
        "seed": seed,
    }


def run_cell(cell: Cell) -> Row:
    """Run the episode of `cell`, a dictionary from `episode_cell`; return results by name, or "seed" and "failure"."""
    env, controller = _prepared(json.dumps({**cell, "seed": None}))
    try:
        return run_episode(env, controller, cell["seed"])
    except SimulationError as error:
        return {"seed": cell["seed"], "failure": str(error)}


@lru_cache(maxsize=4)
def _prepared(text: str) -> tuple[gymnasium.Env, Controller]:
    """Make environment and controller from JSON `text`, a dictionary from `episode_cell`; cache them for all seeds."""
    cell = json.loads(text)
    env = _environment(cell["env_id"], json.dumps(cell["env_kwargs"]))
    if "parameters" in cell:
        return env, make_baseline(cell["spec"], env, TUNABLE[cell["spec"]].defaults.from_json(cell["parameters"]))
    return env, parse_controller(cell["spec"]).load(env)


@lru_cache(maxsize=4)
def _environment(env_id: str, keywords: str) -> gymnasium.Env:
    return make_env(env_id, json.loads(keywords))


def run_cells(cells: Sequence[Cell], workers: int = 1, progress: bool = True) -> list[Row]:
    """Run on `workers` processes the episodes that `cells` describe: dictionaries such as `episode_cell` returns.

    Equal cells are run once. Return for each cell, in order, a dictionary of results, or of "seed" and "failure".
    """
    keys = [json.dumps(cell, sort_keys=True) for cell in cells]
    different, done = dict(zip(keys, cells, strict=True)), dict[str, Row]()
    with counting_bar(Console(stderr=True, quiet=not progress)) as bar:
        ran = each_done(run_cell, different.values(), workers)
        for cell, figures in bar.track(ran, total=len(different), description="episodes"):
            done[json.dumps(cell, sort_keys=True)] = figures
    return [done[key] for key in keys]


def _digest(paths: Sequence[Path]) -> str:
    digest = hashlib.sha256()
    for path in paths:
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def common_environment(
    controllers: Sequence[str], env_id: str | None = None, given: Collection[str] = ()
) -> tuple[str, Keywords]:
    """Return the environment id and the keywords on which all trained controllers among `controllers` agree.

    The id is `env_id` if given, otherwise the trained controllers' id, or `DEFAULT_ENV_ID` if no controller is trained.
    Keywords of observation, action and control period, and all keywords that `given` names, are left out. The keyword
    "randomize" is left out too if `given` is not empty, or if the training had another id.

    Raises:
        ValueError: The controllers were trained on different environments; the user must choose one.
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
