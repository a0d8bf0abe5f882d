"""The page of one episode of several controllers, in motion, side by side."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from agents.comparison.report import TABLE
from solar_env.array import ArrayParameters
from solar_env.mechanics.running.trajectory import Trajectory
from solar_env.pictures.page.content import Page, Table
from solar_env.studies.common.deployment_page import charts_of, motion_of, parameter_table
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


def evaluations(controllers: Sequence[str]) -> list[str]:
    """Where the evaluations of training runs lie, a line for each."""
    folders = [Path(spec.rpartition("=")[2]) for spec in controllers]
    return [f"Evaluation of {folder}: {folder / TABLES}" for folder in folders if (folder / TABLES).is_file()]


def replay_page(
    episodes: dict[str, Trajectory], figures: dict[str, dict[str, Any]], command: str, linked: Sequence[str] = ()
) -> Page:
    """The page of episodes by the names of their controllers, with the figures of `run_episode`, `linked` last."""
    softest = min(episodes, key=lambda name: np.nan_to_num(figures[name]["peak_postlock_force_N"], nan=np.inf))
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
