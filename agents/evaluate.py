"""Compare controllers and trained policies on the same episodes: `python -m agents.evaluate`."""

import csv
import math
import shlex
import sys
from collections.abc import Collection, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from agents import runs
from agents.arguments import parse_arguments
from agents.baselines import BASELINES
from agents.environments import DEFAULT_ENV_ID, episode_seeds, with_model, with_randomization
from agents.episodes import episode_cell, run_cells
from agents.statistics import Estimate, estimate
from solar_env.campaigns import ONE, Cell, Workers

# Figure -> (heading, factor to the heading's unit); the tables show these, the CSV file has all.
TABLE: dict[str, tuple[str, float]] = {
    "return": ("return", 1.0),
    "peak_postlock_force_N": ("peak post-lock force [N]", 1.0),
    "postlock_impulse_Ns": ("post-lock impulse [N s]", 1.0),
    "postlock_sliding_work_J": ("post-lock sliding work [mJ]", 1e3),
    "wear_depth_max_m": ("largest wear depth [1e-15 m]", 1e15),
    "latch_times_s": ("last latch [s]", 1.0),
    "motor_work_J": ("motor work [J]", 1.0),
}
STORE = "episodes.jsonl"
HIGHER_IS_BETTER = frozenset({"return"})

Row = dict[str, Any]


@dataclass
class Args:
    """Compare baselines and trained policies on the same evaluation episodes."""

    controllers: list[str] = field(default_factory=lambda: ["passive", "brake", "servo"])
    """baselines (passive, brake, servo, servo-untuned) and run folders; several runs under one name,
    NAME=FOLDER NAME=FOLDER, are pooled as training seeds of one controller"""
    episodes: int = 100
    """episodes of each controller"""
    seed: int = 0
    """chooses the evaluation episodes; they are never training or validation episodes"""
    out: str = "evaluation"
    """folder for episodes.csv, metrics.json and comparison.md, and for the finished episodes, with which an interrupted
    evaluation goes on"""
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
        controllers: Names of baselines or paths of run folders, optionally as ``NAME=SPEC``. A tuned baseline has
            the parameters for the environment's model, see `agents.baselines.load_parameters`.
        episodes: Episodes of each controller.
        seed: Chooses the block of evaluation seeds.
        env_id: Environment id.
        env_kwargs: Environment keywords; without "randomize", the documented default ranges apply. The key
            "observation" of a run's own configuration takes precedence for that run.
        progress: Show a progress bar.
        workers: Where the episodes run.
        store: File that keeps their figures, so that an interrupted evaluation goes on.

    Returns:
        One row a controller and episode: controller, spec, episode, and the figures of `run_episode`.
    """
    seeds = episode_seeds("evaluation", seed, episodes)
    labels: list[Row] = []
    cells: list[Cell] = []
    for text in controllers:
        name, spec = split_controller(text)
        keywords = with_randomization(env_kwargs or {})
        if spec not in BASELINES:
            trained_on = runs.read_config(spec)["env_kwargs"]
            keywords |= {key: trained_on[key] for key in ("observation",) if key in trained_on}
        for episode, episode_seed in enumerate(seeds):
            labels.append({"controller": name, "spec": spec, "episode": episode})
            cells.append(episode_cell(spec, env_id, keywords, episode_seed))
    figures = run_cells(cells, workers, store, progress)
    return [{**label, **figure} for label, figure in zip(labels, figures, strict=True)]


def common_env_kwargs(controllers: Sequence[str], given: Collection[str] = ()) -> dict[str, Any]:
    """The environment keywords on which all run folders among `controllers` agree.

    Args:
        controllers: As `evaluate` takes them.
        given: Keywords that are chosen otherwise, and left out.

    Raises:
        ValueError: they differ; the physics to compare on must then be given.
    """
    left_out = {"observation", *given}
    specs = [spec for _, spec in map(split_controller, controllers) if spec not in BASELINES]
    found = [runs.read_config(spec)["env_kwargs"] for spec in specs]
    physics = [{key: value for key, value in kwargs.items() if key not in left_out} for kwargs in found]
    for spec, kwargs in zip(specs, physics, strict=True):
        if kwargs != physics[0]:
            raise ValueError(
                f"{specs[0]} was trained on {physics[0]}, {spec} on {kwargs}; say with --env-kwargs what to compare on"
            )
    return physics[0] if physics else {}


def summarize(rows: Sequence[Row]) -> dict[str, dict[str, Any]]:
    """Controller -> latched fraction, an estimate of every figure of `TABLE`, and paired differences.

    A paired difference is taken from the first controller, episode by episode: both had the same seed.
    """
    names = list(dict.fromkeys(row["controller"] for row in rows))
    reference = _by_episode([row for row in rows if row["controller"] == names[0]])
    summary: dict[str, dict[str, Any]] = {}
    for name in names:
        mine = [row for row in rows if row["controller"] == name]
        specs = list(dict.fromkeys(row["spec"] for row in mine))
        summary[name] = {"runs": len(specs), "latched": sum(row["latched"] for row in mine) / len(mine)}
        for figure in (figure for figure in TABLE if figure in mine[0]):
            by_run = [[row for row in mine if row["spec"] == spec] for spec in specs]
            values = [np.array([row[figure] for row in run]) for run in by_run]
            base = [np.array([reference[row["episode"]][figure] for row in run]) for run in by_run]
            summary[name][figure] = estimate(values)
            summary[name][figure + " - " + names[0]] = estimate([v - b for v, b in zip(values, base, strict=True)])
    return summary


def _by_episode(rows: Sequence[Row]) -> dict[int, Row]:
    return {row["episode"]: row for row in rows}


def markdown(rows: Sequence[Row]) -> str:
    """The comparison as Markdown tables, with what the numbers are."""
    summary = summarize(rows)
    names = list(summary)
    figures = [figure for figure in TABLE if figure in summary[names[0]]]
    episodes = len({row["episode"] for row in rows})
    head = ["controller", "latched", *(TABLE[figure][0] for figure in figures)]
    lines = [
        f"Interquartile mean over {episodes} evaluation episodes, the same for every controller, with a 95 % "
        "bootstrap interval, and the worst episode. Post-lock figures are those of deployments that latched.",
        "",
        "| " + " | ".join(head) + " |",
        "|" + " --- |" * len(head),
    ]
    for name, entry in summary.items():
        label = f"{name} ({entry['runs']} runs)" if entry["runs"] > 1 else name
        cells = [_cell(entry[figure], figure) for figure in figures]
        lines.append(f"| {label} | {entry['latched']:.0%} | " + " | ".join(cells) + " |")
    if len(names) > 1:
        head = ["controller", *(TABLE[figure][0] for figure in figures)]
        lines += [
            "",
            f"Difference from {names[0]}, episode by episode:",
            "",
            "| " + " | ".join(head) + " |",
            "|" + " --- |" * len(head),
        ]
        for name in names[1:]:
            cells = [_cell(summary[name][f"{figure} - {names[0]}"], figure, worst=False) for figure in figures]
            lines.append(f"| {name} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def _cell(value: Estimate, figure: str, worst: bool = True) -> str:
    if value.count == 0:
        return "-"
    factor = TABLE[figure][1]
    text = f"{value.mean * factor:.4g} [{value.lower * factor:.4g}, {value.upper * factor:.4g}]"
    extreme = value.minimum if figure in HIGHER_IS_BETTER else value.maximum
    return text + (f"; worst {extreme * factor:.4g}" if worst else "")


def write_comparison(folder: Path, rows: Sequence[Row], settings: Mapping[str, Any]) -> None:
    """Write ``episodes.csv``, ``metrics.json`` and ``comparison.md`` into `folder`."""
    folder.mkdir(parents=True, exist_ok=True)
    columns = list(dict.fromkeys(column for row in rows for column in row))
    with (folder / "episodes.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, columns)
        writer.writeheader()
        writer.writerows(rows)
    controllers = {
        name: {key: _plain(value) for key, value in entry.items()} for name, entry in summarize(rows).items()
    }
    content = {"settings": settings, "versions": runs.versions(), "controllers": controllers}
    runs.write_json(folder / "metrics.json", content)
    (folder / "comparison.md").write_text(markdown(rows))


def _plain(value: Any) -> Any:
    """Estimates as dictionaries; NaN, which JSON lacks, as null."""
    if isinstance(value, Estimate):
        return {key: _plain(v) for key, v in asdict(value).items()}
    return None if isinstance(value, float) and math.isnan(value) else value


def main(argv: Sequence[str] | None = None) -> None:
    """The command line; see `Args`."""
    args = parse_arguments(Args, argv, prog="python -m agents.evaluate")
    given = with_model(args.env_kwargs, args.model, args.elements, args.env_id)
    env_kwargs = with_randomization(
        given if args.env_kwargs else {**common_env_kwargs(args.controllers, given), **given}
    )
    rows = evaluate(
        args.controllers,
        args.episodes,
        args.seed,
        args.env_id,
        env_kwargs,
        progress=not args.quiet,
        workers=Workers(args.jobs, args.cluster),
        store=Path(args.out) / STORE,
    )
    command = shlex.join(["python", "-m", "agents.evaluate", *(sys.argv[1:] if argv is None else argv)])
    write_comparison(Path(args.out), rows, {"command": command, **asdict(args), "env_kwargs": env_kwargs})
    print(markdown(rows))
    print(f"written to {args.out}")


if __name__ == "__main__":
    main()
