"""Whole deployments side by side: default settings against the cheapest settings of Exudyn, at equal error."""

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

from solar_env.array.methods import default_integrator
from solar_env.studies.common.measures import angle_error, latch_error
from solar_env.studies.common.motion import Motion, Scene, run_own
from solar_env.studies.common.plans import Plan
from solar_env.studies.common.tables import Row, Table
from solar_env.studies.common.timing import Measured, time_interleaved
from solar_env.studies.precision.methods import find_method

DEFAULT = "default settings"
_LONG_RUN = 60.0  # s
Entry = tuple[str, float]

# Method and setting: own looser and tighter tolerances; the peer at its leanest, the first of which short plans take.
OWN: dict[str, tuple[Entry, ...]] = {
    "rigid-ideal": (("runge-kutta", 1e-6), ("dop853", 1e-8)),
    "rigid-clearance": (("runge-kutta", 1e-5), ("runge-kutta", 1e-7)),
    "flexible-ideal": (("rosenbrock", 1e-3),),
    "flexible-clearance": (("rosenbrock", 1e-3), ("rosenbrock", 3e-5)),
}
PEER: dict[str, tuple[Entry, ...]] = {
    "rigid-ideal": (("Exudyn explicit", 1e-2), ("Exudyn generalized-alpha", 1e-3)),
    "rigid-clearance": (("Exudyn generalized-alpha", 1e-4), ("Exudyn explicit", 5e-5), ("Exudyn explicit", 2e-5)),
    "flexible-ideal": (("Exudyn generalized-alpha", 5e-3), ("Exudyn generalized-alpha", 1e-3)),
    "flexible-clearance": (("Exudyn generalized-alpha", 5e-4), ("Exudyn generalized-alpha", 1e-4)),
}
REFERENCES: dict[str, Entry] = {
    "rigid-ideal": ("runge-kutta", 1e-12),
    "rigid-clearance": ("runge-kutta", 1e-11),
    "flexible-ideal": ("runge-kutta", 1e-8),
    "flexible-clearance": ("runge-kutta", 1e-8),
}


def _jobs(plan: Plan, model: str) -> tuple[Scene, dict[Entry, Callable[[], Motion]]]:
    scene = replace(plan.deployment(model), duration=plan.side_duration)
    jobs: dict[Entry, Callable[[], Motion]] = {(DEFAULT, 0.0): partial(run_own, scene, default_integrator(model))}
    for name, value in (*OWN[model], *(PEER[model] if plan.dear else PEER[model][:1])):
        method = find_method(name)
        if method.available:
            jobs[name, value] = partial(method.solve, scene, value)
    return scene, jobs


def count_side_by_side(plan: Plan) -> int:
    """How many runs `run_side_by_side` announces."""
    return sum(1 + len(_jobs(plan, model)[1]) for model in plan.models)


def run_side_by_side(plan: Plan, announce: Callable[[str], None]) -> dict[str, list[Row]]:
    """Time whole deployments, all runs of a model in turn; "side_by_side" gets cost and errors of every run."""
    rows: list[Row] = []
    for model in plan.models:
        scene, jobs = _jobs(plan, model)
        name, value = REFERENCES[model]
        announce(f"side by side, {model}: reference")
        reference = find_method(name).solve(scene, value)

        def say(entry: Entry, model: str = model) -> None:
            announce(f"side by side, {model}: {entry[0]}")

        measured = time_interleaved(jobs, plan.repeats, _LONG_RUN, say)
        for (method, setting), result in measured.items():
            labels: Row = {
                "model": model,
                "duration_s": scene.duration,
                "method": method,
                "value": setting,
                "peer": int(method.startswith("Exudyn")),
                "failure": result.failure,
            }
            rows.append(labels | _figures(result, reference, plan))
    return {"side_by_side": rows}


def _figures(result: Measured[Entry], reference: Motion, plan: Plan) -> Row:
    """Times and errors of a run; nan if it did not reach its end."""
    names = ("repeats", "wall_s", "wall_min_s", "wall_max_s", "angle_error_rad", "latch_error_s", "energy_residual")
    motion = result.motion
    if motion is None:
        return dict.fromkeys(names, math.nan)
    values = (
        len(result.walls),
        result.wall,
        min(result.walls),
        max(result.walls),
        angle_error(motion, reference, plan.before_latch),
        latch_error(motion, reference),
        motion.energy_residual,
    )
    return dict(zip(names, values, strict=True))


def ratio_at_equal_error(rows: Table, peer: Row) -> float:
    """The peer's wall time over that of the cheapest own run whose errors are no larger; nan if there is none."""
    walls = [
        float(row["wall_s"])
        for row in rows.where(model=peer["model"], peer=0).rows
        if all(float(row[name]) <= float(peer[name]) for name in ("angle_error_rad", "latch_error_s"))
    ]
    return float(peer["wall_s"]) / min(walls, default=math.nan)


def write_side_by_side(rows: Table, folder: Path) -> list[Path]:
    """Write the table in Markdown, from the measured table alone; returns the file."""
    lines = [
        "| model | method | setting | wall time [s] | times real time | error of angles before the latch [rad] "
        "| error of latch times [s] | peer's time over ours at no larger error |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for row in rows.rows:
        setting = "" if row["method"] == DEFAULT else f"{row['value']:g}"
        if row["failure"]:
            lines.append(f"| {row['model']} | {row['method']} | {setting} | failed | | | | |")
            continue
        ratio = ""
        if row["peer"]:
            own = ratio_at_equal_error(rows, dict(row))
            ratio = "none of ours is as accurate" if math.isnan(own) else f"{own:.3g}"
        wall = float(row["wall_s"])
        lines.append(
            f"| {row['model']} | {row['method']} | {setting} | {wall:.3g} | {float(row['duration_s']) / wall:.3g} "
            f"| {row['angle_error_rad']:.1e} | {row['latch_error_s']:.1e} | {ratio} |"
        )
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "side_by_side.md"
    path.write_text("\n".join(lines) + "\n")
    return [path]
