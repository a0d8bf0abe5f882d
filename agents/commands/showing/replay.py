"""Command that shows one episode of several controllers, in motion, on one page: `solar-env replay`."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.console import Console

from agents.commands.arguments import CommandRecord, ShowingOptions
from agents.comparison.report import TABLE
from agents.rollout import run_episode
from solar_env.array import ArrayParameters
from solar_env.environment.showing.recording import RecordTrajectory
from solar_env.mechanics.running.trajectory import Trajectory
from solar_env.pictures.page.content import Page, Table
from solar_env.pictures.page.document import write_page
from solar_env.studies.common.deployment_page import charts_of, motion_of, parameter_table
from solar_env.support.files import check_target
from solar_env.support.progress import counting_bar
from solar_env.support.versions import versions

TABLES = "comparison.md"  # of a run's evaluation
# Figure of an episode -> in words, with the unit in which comparisons tell it.
SHOWN = {
    "return": "return",
    "latch_times_s": "all latched after [s]",
    "peak_postlock_force_N": "peak force after latching [N]",
    "postlock_impulse_Ns": "impulse after latching [N s]",
    "postlock_sliding_work_J": "sliding work after latching [mJ]",
    "wear_depth_max_m": "deepest wear [fm, 1e-15 m]",
}


@dataclass
class Args(ShowingOptions, CommandRecord):
    """Show one episode of several controllers, the same for all, in motion, side by side on one page.

    The model is flexible-clearance unless another is named.
    """

    html: Path = Path("replay.html")
    """the page, which needs no network"""


def run_command(args: Args) -> int:
    """Run the command; see `Args`."""
    check_target(args.html, (".html",))
    prepared = args.prepare(args.controllers)
    episodes: dict[str, Trajectory] = {}
    figures: dict[str, dict[str, Any]] = {}
    with counting_bar(Console(stderr=True, quiet=args.quiet)) as bar:
        for named, env in bar.track(prepared, description="episodes"):
            recorded = RecordTrajectory(env)
            figures[named.name] = run_episode(recorded, named.load(recorded), args.episode_seed)
            episodes[named.name] = recorded.trajectory
    write_page(replay_page(episodes, figures, args.command, evaluations(args.controllers)), args.html)
    print(f"written to {args.html}")
    return 0


def evaluations(controllers: Sequence[str]) -> list[str]:
    """Where the evaluations of training runs lie, a line for each."""
    folders = [Path(spec.rpartition("=")[2]) for spec in controllers]
    return [f"Evaluation of {folder}: {folder / TABLES}" for folder in folders if (folder / TABLES).is_file()]


def replay_page(
    episodes: dict[str, Trajectory], figures: dict[str, dict[str, Any]], command: str, linked: Sequence[str] = ()
) -> Page:
    """The page of episodes by the names of their controllers, with the figures of `run_episode`, `linked` last."""
    softest = min(episodes, key=lambda name: _or_infinity(figures[name]["peak_postlock_force_N"]))
    best = max(episodes, key=lambda name: figures[name]["return"])
    answer = [
        f"Of {len(episodes)} controllers {softest} lands softest, with at most "
        f"{figures[softest]['peak_postlock_force_N']:.3g} N after latching; {best} has the highest return, "
        f"{figures[best]['return']:.3g}.",
        "One episode, the same for all: impacts are chaotic, so compare many with solar-env evaluate.",
    ]
    shown = {name: words for name, words in SHOWN.items() if all(name in own for own in figures.values())}
    rows = [
        [words, *(f"{TABLE[name][1] * own[name]:.4g}" for own in figures.values())] for name, words in shown.items()
    ]
    terms = [name for name in next(iter(figures.values())) if name.startswith("reward_")]
    rows += [[name.replace("_", " "), *(f"{own[name]:.3g}" for own in figures.values())] for name in terms]
    table = Table("Figures of the episode", ["figure", *figures], rows)
    motions = [motion_of(trajectory, name) for name, trajectory in episodes.items()]
    notes = [*linked, f"Made by: {command}", ", ".join(f"{name} {value}" for name, value in versions().items())]
    array = ArrayParameters().with_changes(next(iter(episodes.values())).metadata["parameters"])
    tables = [table, parameter_table(array)]
    return Page("One episode, " + " beside ".join(episodes), answer, motions, charts_of(episodes), tables, notes)


def _or_infinity(value: float) -> float:
    return value if value == value else float("inf")
