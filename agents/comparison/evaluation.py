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


def common_environment(
    controllers: Sequence[str], env_id: str | None = None, given: Collection[str] = ()
) -> tuple[str, dict[str, Any]]:
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
    agreed: dict[str, Any] | None = None
    for controller, of in found.items():
        others = {"randomize"} if given or of.env_id != used else set()
        kwargs = {name: v for name, v in of.env_kwargs.items() if name not in {*INTERFACE, *given, *others}}
        if agreed not in (None, kwargs):
            raise ValueError(
                f"{controller} was trained on {kwargs}, another on {agreed}; say with --env-kwargs what to compare on"
            )
        agreed = kwargs
    return used, agreed or {}
