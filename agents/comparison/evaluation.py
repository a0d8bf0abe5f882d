"""Evaluation of controllers on the same episodes, and the environments that they are compared on."""

from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any

from agents.comparison.controllers import parse_controller, parse_controllers
from agents.comparison.episodes import episode_cell, run_cells
from agents.comparison.report import Row
from agents.environments import DEFAULT_ENV_ID, INTERFACE, episode_seeds, with_sampling
from agents.laws.baselines import is_tuned
from agents.laws.table import TUNABLE
from agents.policies import shipped
from solar_env.environment.registration import DEPLOY, DEPLOY_RANDOMISED
from solar_env.support.campaigns import ONE, Workers

STORE = "episodes.jsonl"
"""Name of a file that keeps the figures of finished episodes."""
# Suites are judged on this model, whose peak forces have converged, and searches train on it. It is also the
# cheapest with flexible panels: under the servo 579 environment steps a second of a core with 24 modes, 453 with 8, and
# 380, 270 and 172 with 2, 4 and 6 beam elements.
MODEL: dict[str, Any] = {"model": "flexible-clearance"}
# What learns from single steps needs more episodes than there is time for with flexible panels.
RIGID: dict[str, Any] = {"model": "rigid-clearance"}
# Name -> environment id of the scenario.
SUITES = {"paper": DEPLOY, "robust": DEPLOY_RANDOMISED}


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
    env_kwargs: Mapping[str, Any] | None = None,
    progress: bool = True,
    workers: Workers = ONE,
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
        progress, workers, store: As for `agents.comparison.episodes.run_cells`.

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


def common_env_id(controllers: Sequence[str]) -> str:
    """Return the id of the environment on which the trained `controllers` were trained; without any, the nominal one.

    Raises:
        ValueError: They were trained on different ones.
    """
    found = {of.env_id for each in controllers if (of := parse_controller(each).training())}
    if len(found) > 1:
        ids = " and ".join(sorted(found))
        raise ValueError(f"the controllers were trained on different environments, {ids}; say with --env-id which")
    return found.pop() if found else DEFAULT_ENV_ID


def common_env_kwargs(
    controllers: Sequence[str], env_id: str = DEFAULT_ENV_ID, given: Collection[str] = ()
) -> dict[str, Any]:
    """Return the environment keywords on which all trained ones among `controllers` agree.

    The ranges drawn in training belong to it: in another scenario than `env_id`, or beside the keywords `given`, they
    are left out, and so are these keywords.

    Raises:
        ValueError: They differ; the physics to compare on must then be given.
    """
    physics: dict[str, dict[str, Any]] = {}
    for controller in controllers:
        if training := parse_controller(controller).training():
            others = {"randomize"} if given or training.env_id != env_id else set()
            left_out = {*INTERFACE, *given, *others}
            physics[controller] = {name: v for name, v in training.env_kwargs.items() if name not in left_out}
    if not physics:
        return {}
    first, agreed = next(iter(physics.items()))
    for controller, kwargs in physics.items():
        if kwargs != agreed:
            raise ValueError(
                f"{first} was trained on {agreed}, {controller} on {kwargs}; say with --env-kwargs what to compare on"
            )
    return agreed
