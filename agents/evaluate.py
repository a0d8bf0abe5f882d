"""Compare controllers and trained policies on the same episodes: `python -m agents.evaluate`."""

import shlex
import shutil
import sys
from collections.abc import Collection, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from agents.arguments import parse_arguments
from agents.controllers import effort, trained_on
from agents.environments import DEFAULT_ENV_ID, episode_seeds, make_env, with_model, with_sampling
from agents.episodes import episode_cell, run_cells
from agents.figures import comparison_figure
from agents.report import Row, write_comparison
from agents.suites import MODEL, SUITES, suite_controllers
from solar_env.campaigns import ONE, Cell, Workers
from solar_env.readme import FIGURE_FOLDER, check_readme, replace_in_readme

STORE = "episodes.jsonl"
FIGURE = "comparison.png"


@dataclass
class Args:
    """Compare baselines and trained policies on the same evaluation episodes."""

    suite: str | None = None
    """paper or robust: all baselines and shipped policies of a scenario, nominal or randomised, on flexible-clearance
    with 6 elements; names the folder too"""
    controllers: list[str] = field(default_factory=list)
    """baselines (passive, brake, damper, servo, shaped, open-loop, servo-untuned), receding-horizon (a search with the
    simulator itself; slow), shipped policies and run folders; several runs under one name, NAME=FOLDER NAME=FOLDER, are
    pooled as training seeds of one controller; none: those of the suite, else passive, brake and servo"""
    episodes: int = 100
    """episodes of each controller"""
    seed: int = 0
    """chooses the evaluation episodes; they are never training or validation episodes"""
    out: str | None = None
    """folder (evaluation, or evaluation/SUITE) for episodes.csv, metrics.json and comparison.md, and for the finished
    episodes, with which an interrupted evaluation goes on"""
    jobs: int | None = None
    """processes; None: one a processor"""
    cluster: str | None = None
    """ray: run on the Ray cluster that this machine belongs to"""
    env_id: str = DEFAULT_ENV_ID
    """environment id"""
    model: str | None = None
    """rigid-ideal, rigid-clearance, flexible-ideal, flexible-clearance, or auto (see the environment); None: that of
    the run folders given, else rigid-clearance"""
    elements: int | None = None
    """beam elements of each panel of a flexible model; None: that of the run folders, else 6"""
    env_kwargs: dict[str, Any] = field(default_factory=dict)
    """environment keywords; by default those of the run folders given"""
    readme: bool = False
    """write a suite's table into the README, and its figure beside the README's others"""
    quiet: bool = False
    """no progress bar"""


def split_controller(text: str) -> tuple[str, str]:
    """``NAME=SPEC`` -> (name, spec); a bare baseline names itself, a bare run folder its last component."""
    name, separator, spec = text.partition("=")
    return (name, spec) if separator else (Path(text).name, text)


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
        controllers: See `agents.controllers.load_controller`; optionally as ``NAME=SPEC``. A tuned baseline has
            the parameters for the environment's model, see `agents.baselines.load_parameters`.
        episodes: Episodes of each controller.
        seed: Chooses the block of evaluation seeds.
        env_id: Environment id.
        env_kwargs: Environment keywords; without "randomize", that of `with_sampling`. The key
            "observation" of a run's own configuration takes precedence for that run.
        progress: Show a progress bar.
        workers: Where the episodes run.
        store: File that keeps their figures, so that an interrupted evaluation goes on.

    Returns:
        One row a controller and episode: controller, spec, episode, and the figures of `run_episode`.
    """
    seeds = episode_seeds("evaluation", seed, episodes)
    sampled = with_sampling(env_kwargs or {}, env_id)
    labels: list[Row] = []
    cells: list[Cell] = []
    for text in controllers:
        name, spec = split_controller(text)
        trained = trained_on(spec) or {}
        keywords = sampled | {key: trained[key] for key in ("observation",) if key in trained}
        for episode, episode_seed in enumerate(seeds):
            labels.append({"controller": name, "spec": spec, "episode": episode})
            cells.append(episode_cell(spec, env_id, keywords, episode_seed))
    figures = run_cells(cells, workers, store, progress)
    return [{**label, **figure} for label, figure in zip(labels, figures, strict=True)]


def efforts(controllers: Sequence[str], env_id: str, env_kwargs: Mapping[str, Any]) -> dict[str, str]:
    """Controller -> what was simulated to tune or train it, as `agents.controllers.effort`; of several runs, each."""
    with make_env(env_id, env_kwargs) as env:
        model = env.get_wrapper_attr("model")
    found = {name: effort(spec, env_id, model) for name, spec in map(split_controller, controllers)}
    return {name: what for name, what in found.items() if what}


def common_env_kwargs(controllers: Sequence[str], given: Collection[str] = ()) -> dict[str, Any]:
    """The environment keywords on which all trained ones among `controllers` agree.

    Args:
        controllers: As `evaluate` takes them.
        given: Keywords that are chosen otherwise, and left out.

    Raises:
        ValueError: they differ; the physics to compare on must then be given.
    """
    left_out = {"observation", *given}
    found = [(spec, trained_on(spec)) for _, spec in map(split_controller, controllers)]
    specs = [spec for spec, kwargs in found if kwargs is not None]
    physics = [{k: v for k, v in kwargs.items() if k not in left_out} for _, kwargs in found if kwargs is not None]
    for spec, kwargs in zip(specs, physics, strict=True):
        if kwargs != physics[0]:
            raise ValueError(
                f"{specs[0]} was trained on {physics[0]}, {spec} on {kwargs}; say with --env-kwargs what to compare on"
            )
    return physics[0] if physics else {}


def main(argv: Sequence[str] | None = None) -> None:
    """The command line; see `Args`."""
    args = parse_arguments(Args, argv, prog="python -m agents.evaluate")
    given = with_model(args.env_kwargs, args.model, args.elements, args.env_id)
    if args.readme:
        check_readme(_place(args.suite))
    if args.suite:
        env_id, controllers, given = suite_named(args.suite, args.env_id, args.controllers, given)
    else:
        env_id, controllers = args.env_id, args.controllers or ["passive", "brake", "servo"]
        given = given if args.env_kwargs else {**common_env_kwargs(controllers, given), **given}
    out = Path(args.out or (Path("evaluation") / (args.suite or "")))
    env_kwargs = with_sampling(given, env_id)
    rows = evaluate(
        controllers,
        args.episodes,
        args.seed,
        env_id,
        env_kwargs,
        progress=not args.quiet,
        workers=Workers(args.jobs, args.cluster),
        store=out / STORE,
    )
    command = shlex.join(["python", "-m", "agents.evaluate", *(sys.argv[1:] if argv is None else argv)])
    settings = {"command": command, **asdict(args), "env_id": env_id, "env_kwargs": env_kwargs}
    summary, tables = write_comparison(out, rows, settings, efforts(controllers, env_id, env_kwargs))
    comparison_figure(summary, out / FIGURE)
    if args.readme:
        shutil.copy(out / FIGURE, FIGURE_FOLDER / f"suite-{args.suite}.png")
        replace_in_readme(_place(args.suite), f"<!-- end of suite {args.suite} -->", tables.strip())
    print(tables)
    print(f"written to {out}")


def _place(suite: str | None) -> str:
    """Where the README has the table of a suite."""
    if suite is None:
        raise ValueError("--readme writes the result of a suite: it needs --suite")
    return f"<!-- suite {suite}: written by `python -m agents.evaluate --suite {suite} --readme` -->"


def suite_named(
    name: str, env_id: str, controllers: Sequence[str], given: Mapping[str, Any]
) -> tuple[str, list[str], dict[str, Any]]:
    """Environment id, controllers and environment keywords of a suite, the last two with what was given instead.

    Raises:
        ValueError: there is no such suite, or an environment id was given too.
    """
    if name not in SUITES:
        raise ValueError(f"no suite {name!r}; available: {', '.join(SUITES)}")
    scenario = SUITES[name]
    if env_id not in (DEFAULT_ENV_ID, scenario):
        raise ValueError(f"--suite {name} is about {scenario}, not about {env_id}; leave --env-id out")
    return scenario, list(controllers) or suite_controllers(scenario), {**MODEL, **given}


if __name__ == "__main__":
    main()
