"""Compare controllers and trained policies on the same episodes: `python -m agents.evaluate`."""

import shlex
import shutil
import sys
from collections.abc import Collection, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from agents.arguments import parse_arguments, run_command
from agents.comparison.controllers import UNTRAINED, effort, observation_of, resolved, trained_in, trained_on
from agents.comparison.episodes import episode_cell, run_cells
from agents.comparison.figures import comparison_figure
from agents.comparison.report import Row, write_comparison
from agents.comparison.suites import MODEL, SUITES, suite_controllers
from agents.environments import DEFAULT_ENV_ID, episode_seeds, make_env, with_model, with_sampling, without_sampling
from solar_env.support.campaigns import ONE, Cell, Workers
from solar_env.support.readme import Section

STORE = "episodes.jsonl"
FIGURE = "comparison.png"
COMPARISON = Path(__file__).parent / "comparison"


@dataclass
class Args:
    """Compare baselines and trained policies on the same evaluation episodes."""

    suite: str | None = None
    """paper or robust: the passive deployment, all tuned baselines and the shipped policies of a scenario, nominal or
    randomised, on flexible-clearance with 6 elements; names the folder too"""
    controllers: list[str] = field(default_factory=list)
    """baselines (passive, brake, damper, servo, shaped, open-loop, soft-start, servo-untuned), receding-horizon (a
    search with the simulator itself; slow), shipped policies and run folders; several runs under one name,
    NAME=FOLDER NAME=FOLDER, are pooled as training seeds of one controller; none: those of the suite, else passive,
    brake and servo"""
    episodes: int = 100
    """episodes of each controller"""
    seed: int = 0
    """chooses the evaluation episodes; they are never training or validation episodes"""
    out: str | None = None
    """folder (evaluation, or evaluation/SUITE) for episodes.csv, metrics.json, comparison.md and comparison.png, and
    for the finished episodes, with which an interrupted evaluation goes on"""
    jobs: int | None = None
    """processes; None: one a processor"""
    cluster: str | None = None
    """ray: run on the Ray cluster that this machine belongs to"""
    env_id: str | None = None
    """environment id; None: that of the suite, else of the trained controllers given, else solar_env/Deploy-v0"""
    model: str | None = None
    """rigid-ideal, rigid-clearance, flexible-ideal, flexible-clearance, or auto (see the environment); None: that of
    the suite, else of the trained controllers given, else rigid-clearance"""
    elements: int | None = None
    """beam elements of each panel of a flexible model; None: those of the suite, else of the trained controllers
    given, else 6"""
    env_kwargs: dict[str, Any] = field(default_factory=dict)
    """environment keywords, on top of those of the trained controllers given"""
    readme: bool = False
    """write a suite's table into the README, and its figure beside the README's others"""
    quiet: bool = False
    """no progress bar"""


def split_controller(text: str) -> tuple[str, str]:
    """``NAME=SPEC`` -> (name, spec); a bare baseline names itself, a bare run folder its last component.

    A folder that is there is one, whatever signs are in its name.
    """
    name, separator, spec = text.partition("=")
    if separator and not Path(text).is_dir():
        return name, spec
    return Path(text).name or Path(text).resolve().name, text


def check_names(controllers: Sequence[str]) -> None:
    """Refuse what is given twice, and different controllers of the same name that they have not been given.

    Raises:
        ValueError: there are such.
    """
    named = [split_controller(text) for text in controllers]
    pairs = [(name, resolved(spec)) for name, spec in named]
    for name, spec in pairs:
        times = pairs.count((name, spec))
        if times > 1:
            raise ValueError(f"{name} is given {times} times; its episodes would count as many times")
        if spec in UNTRAINED and any(other == name and of != spec for other, of in pairs):
            raise ValueError(f"{spec} and another controller are both called {name}; give the other its own name")
    specs: dict[str, str] = {}
    for name, spec in (pair for text, pair in zip(controllers, named, strict=True) if "=" not in text):
        if specs.setdefault(name, spec) != spec:
            raise ValueError(f"{specs[name]} and {spec} are both called {name}; name them, as in first={spec}")


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
        controllers: See `agents.comparison.controllers.load_controller`; optionally as ``NAME=SPEC``. A tuned
            baseline has the parameters for the environment's model, see `agents.laws.baselines.load_parameters`.
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

    Raises:
        FileNotFoundError, ValueError: a controller does not exist, does not fit the environment, or goes by the name of
            another one; or the environment refuses its keywords.
    """
    check_names(controllers)
    seeds = episode_seeds("evaluation", seed, episodes)
    sampled = with_sampling(env_kwargs or {}, env_id)
    labels: list[Row] = []
    cells: list[Cell] = []
    for text in controllers:
        name, spec = split_controller(text)
        keywords = sampled | observation_of(spec)
        for episode, episode_seed in enumerate(seeds):
            labels.append({"controller": name, "spec": spec, "episode": episode})
            cells.append(episode_cell(spec, env_id, keywords, episode_seed))
    figures = run_cells(cells, workers, store, progress)
    return [{**label, **figure} for label, figure in zip(labels, figures, strict=True)]


def efforts(controllers: Sequence[str], env_id: str, env_kwargs: Mapping[str, Any]) -> dict[str, str]:
    """Controller -> what was simulated to tune or train it, as `controllers.effort`, times its runs."""
    with make_env(env_id, env_kwargs) as env:
        model = env.get_wrapper_attr("model")
    found: dict[str, list[str]] = {}
    for name, spec in map(split_controller, controllers):
        if what := effort(spec, env_id, model):
            found.setdefault(name, []).append(what)
    return {
        name: (f"{len(each)} x " if len(each) > 1 else "") + " / ".join(dict.fromkeys(each))
        for name, each in found.items()
    }


def common_env_id(controllers: Sequence[str]) -> str:
    """The environment that all trained ones among `controllers` were trained on; by default the nominal scenario.

    Raises:
        ValueError: they were trained on different ones.
    """
    found = {spec: scenario for _, spec in map(split_controller, controllers) if (scenario := trained_in(spec))}
    if len(set(found.values())) > 1:
        trained = ", ".join(f"{spec} on {scenario}" for spec, scenario in found.items())
        raise ValueError(f"the controllers were trained on different environments: {trained}; say with --env-id which")
    return next(iter(found.values()), DEFAULT_ENV_ID)


def common_env_kwargs(
    controllers: Sequence[str], env_id: str = DEFAULT_ENV_ID, given: Collection[str] = ()
) -> dict[str, Any]:
    """The environment keywords on which all trained ones among `controllers` agree.

    What was drawn for every training episode belongs to the scenario: in another one than `env_id` it is left out. So
    is what `with_sampling` has added, which does so anew, around what is given.

    Args:
        controllers: As `evaluate` takes them.
        env_id: Environment to compare on.
        given: Keywords that are chosen otherwise, and left out.

    Raises:
        ValueError: they differ; the physics to compare on must then be given.
    """
    physics: dict[str, dict[str, Any]] = {}
    for _, spec in map(split_controller, controllers):
        kwargs = trained_on(spec)
        if kwargs is not None:
            left_out = {"observation", *given, *(() if trained_in(spec) == env_id else ("randomize",))}
            asked = without_sampling(kwargs, trained_in(spec) or env_id)
            physics[spec] = {k: v for k, v in asked.items() if k not in left_out}
    if not physics:
        return {}
    first, agreed = next(iter(physics.items()))
    for spec, kwargs in physics.items():
        if kwargs != agreed:
            raise ValueError(
                f"{first} was trained on {agreed}, {spec} on {kwargs}; say with --env-kwargs what to compare on"
            )
    return agreed


def main(argv: Sequence[str] | None = None) -> None:
    """The command line; see `Args`."""
    args = parse_arguments(Args, argv, prog="python -m agents.evaluate")
    if args.readme:
        _section(args).read()  # refuses a page without a place before everything is evaluated
    if args.suite:
        env_id, controllers, common = suite_named(args.suite, args.env_id, args.controllers)
    else:
        controllers = args.controllers or ["passive", "brake", "servo"]
        env_id = args.env_id or common_env_id(controllers)
        common = {}
    given = with_model(args.env_kwargs, args.model, args.elements, env_id)
    given = {**(common or common_env_kwargs(controllers, env_id, given)), **given}
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
        shutil.copy(out / FIGURE, COMPARISON / "figures" / f"suite-{args.suite}.png")
        _section(args).write(tables.folded().strip())
    print(tables)
    print(f"written to {out}")


def suite_section(suite: str) -> Section:
    """The section of the page with the table of a suite."""
    return Section(COMPARISON / "README.md", f"suite {suite}", f"python -m agents.evaluate --suite {suite} --readme")


def _section(args: Args) -> Section:
    """The section that the arguments are to write.

    Raises:
        ValueError: there is no suite, or it is not the whole one.
    """
    whole = Args(suite=args.suite, readme=True, out=args.out, jobs=args.jobs, cluster=args.cluster, quiet=args.quiet)
    if args.suite is None or args != whole:
        raise ValueError(
            "--readme writes the result of a whole suite: it needs --suite, and takes no other controllers, episodes, "
            "seed or environment"
        )
    return suite_section(args.suite)


def suite_named(name: str, env_id: str | None, controllers: Sequence[str]) -> tuple[str, list[str], dict[str, Any]]:
    """Environment id, controllers, those of the suite where none are given, and environment keywords of a suite.

    Raises:
        ValueError: there is no such suite, or an environment id was given too.
    """
    if name not in SUITES:
        raise ValueError(f"no suite {name!r}; available: {', '.join(SUITES)}")
    scenario = SUITES[name]
    if env_id not in (None, scenario):
        raise ValueError(f"--suite {name} is about {scenario}, not about {env_id}; leave --env-id out")
    return scenario, list(controllers) or suite_controllers(scenario), dict(MODEL)


if __name__ == "__main__":
    run_command(main)
