"""Evaluation of controllers on the same episodes, and the environment that trained ones have in common."""

from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any

from agents.comparison.controllers import parse_controller, parse_controllers
from agents.comparison.episodes import episode_cell, run_cells
from agents.comparison.report import Row
from agents.environments import (
    DEFAULT_ENV_ID,
    INTERFACE,
    environment_settings,
    episode_seeds,
    with_sampling,
    without_sampling,
)
from solar_env.support.campaigns import ONE, Cell, Workers

STORE = "episodes.jsonl"
"""Name of a file that keeps the figures of finished episodes."""


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
    named = parse_controllers(controllers)
    for controller in named:
        controller.training()  # refuses damaged files before any work
    seeds = episode_seeds("evaluation", seed, episodes)
    sampled = with_sampling(env_kwargs or {}, env_id)
    labels: list[Row] = []
    cells: list[Cell] = []
    for controller in named:
        keywords = sampled | controller.interface()
        for episode, episode_seed in enumerate(seeds):
            labels.append({"controller": controller.name, "spec": controller.spec, "episode": episode})
            cells.append(episode_cell(controller, env_id, keywords, episode_seed))
    figures = run_cells(cells, workers, store, progress)
    return [{**label, **figure} for label, figure in zip(labels, figures, strict=True)]


def efforts(controllers: Sequence[str], env_id: str, env_kwargs: Mapping[str, Any]) -> dict[str, str]:
    """Return the effort of tuning or training by controller, see `NamedController.effort`, with the number of runs."""
    model = environment_settings(env_id, env_kwargs).level.name
    found: dict[str, list[str]] = {}
    for controller in map(parse_controller, controllers):
        if effort := controller.effort(env_id, model):
            found.setdefault(controller.name, []).append(effort)
    return {
        name: (f"{len(each)} x " if len(each) > 1 else "") + " / ".join(dict.fromkeys(each))
        for name, each in found.items()
    }


def common_env_id(controllers: Sequence[str]) -> str:
    """Return the id of the environment on which the trained `controllers` were trained; without any, the nominal one.

    Raises:
        ValueError: They were trained on different ones.
    """
    trained = [controller for controller in map(parse_controller, controllers) if controller.training()]
    found = {controller.spec: controller.training()["env_id"] for controller in trained}
    if len(set(found.values())) > 1:
        ids = ", ".join(f"{spec} on {env_id}" for spec, env_id in found.items())
        raise ValueError(f"the controllers were trained on different environments: {ids}; say with --env-id which")
    return next(iter(found.values()), DEFAULT_ENV_ID)


def common_env_kwargs(
    controllers: Sequence[str], env_id: str = DEFAULT_ENV_ID, given: Collection[str] = ()
) -> dict[str, Any]:
    """Return the environment keywords on which all trained ones among `controllers` agree.

    The ranges drawn in training belong to the scenario: in another one than `env_id` they are left out. So is the range
    that `with_sampling` added, which adds it anew around the parameters given, and so are the keywords `given`.

    Raises:
        ValueError: They differ; the physics to compare on must then be given.
    """
    physics: dict[str, dict[str, Any]] = {}
    for controller in map(parse_controller, controllers):
        if training := controller.training():
            left_out = {*INTERFACE, *given, *(() if training["env_id"] == env_id else ("randomize",))}
            asked = without_sampling(training["env_kwargs"], training["env_id"])
            physics[controller.spec] = {k: v for k, v in asked.items() if k not in left_out}
    if not physics:
        return {}
    first, agreed = next(iter(physics.items()))
    for spec, kwargs in physics.items():
        if kwargs != agreed:
            raise ValueError(
                f"{first} was trained on {agreed}, {spec} on {kwargs}; say with --env-kwargs what to compare on"
            )
    return agreed
