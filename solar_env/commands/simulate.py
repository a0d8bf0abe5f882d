"""`solar-env simulate`: one deployment from the command line."""

import json
import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

import numpy as np
import tyro
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from solar_env.array import ArrayParameters, ModelLevel, build
from solar_env.array.methods import INTEGRATOR_NAMES, default_integrator, make_integrator
from solar_env.array.motorization import listed, motorization
from solar_env.commands.arguments import ArrayOption, Assignments, QuietOption
from solar_env.support.files import check_target, write_text
from solar_env.support.progress import counting_bar

Array = NDArray[np.float64]
_INTEGRATOR_HELP = f"one of {', '.join(INTEGRATOR_NAMES)}; by default the model's best"
_DIGITS = 5  # significant digits printed; files have all digits


@dataclass
class Args(ArrayOption, QuietOption):
    """Simulate one deployment, of the nominal array."""

    model: str = "rigid-clearance"
    """level of the model: rigid-ideal, rigid-clearance, flexible-ideal or flexible-clearance, alone or with a number of
    modes or elements: "flexible-clearance:8 modes", "flexible-ideal:6 elements"; ladder --ask names the cheapest"""
    duration: float = 30.0
    """simulated time [s]"""
    set: Assignments = field(default_factory=dict)
    """change parameters, for example clearance=1e-4,2e-4"""
    integrator: Annotated[str | None, tyro.conf.arg(help=_INTEGRATOR_HELP)] = None
    step: float | None = None
    """fixed step, or bound on adaptive ones [s]"""
    rtol: float | None = None
    """local error tolerance"""
    output_step: float = 0.01
    """time between two samples [s]"""
    plot: Path | None = None
    """write a figure (png, svg or pdf)"""
    out: Path | None = None
    """write the trajectory, as .npz or .csv"""
    json: Path | None = None
    """write the summary; - for standard output"""


def run_command(args: Args) -> int:
    """Simulate a deployment, print a summary, and write the requested files."""
    # Refuse wrong input before anything is compiled.
    from solar_env.array import data_files

    level = ModelLevel.of(args.model)
    parameters = args.parameter_file.parameters.with_changes(args.set)
    if args.out is not None:
        check_target(args.out, data_files.SUFFIXES)
    if args.plot is not None:
        from solar_env.pictures import plots

        check_target(args.plot, plots.SUFFIXES)
    if args.json is not None and str(args.json) != "-":
        check_target(args.json)
        if args.json in (args.out, args.plot):
            raise ValueError(f"--json {args.json} is the target of --out or --plot, too; name another file")
    name = args.integrator or default_integrator(level).name
    integrator = make_integrator(name, level, args.step, args.rtol)
    build(parameters, level)
    from solar_env.mechanics.running.simulation import sample_times

    sample_times(args.duration, args.output_step)
    from solar_env.array.deployment import hub_turn, panel_deflections, simulate
    from solar_env.commands.warmup import warm_up

    warm_up(args.console, level.name, name)
    with counting_bar(args.console) as progress:
        task = progress.add_task("seconds simulated", total=args.duration)
        trajectory = simulate(
            parameters,
            model=level,
            duration=args.duration,
            integrator=integrator,
            output_step=args.output_step,
            progress=lambda time: progress.update(task, completed=time),
        )
    summary = trajectory.summary() | {"hub_turn_deg": float(np.degrees(hub_turn(trajectory)[-1]))}
    if str(args.json) == "-":
        json.dump(summary, sys.stdout, indent=2)
        print()
    else:
        _print_summary(summary)
        hinges = motorization(parameters)
        if any(hinge.asked.any() for hinge in hinges):
            print(f"Motorization: {listed(hinges)}.")
        if np.isnan(trajectory.latch_times).any():
            print(_unlatched(parameters, trajectory.latch_times, trajectory.angles[-1], args.duration))
        if args.json:
            write_text(args.json, json.dumps(summary, indent=2) + "\n")
    if args.out:
        data_files.write_data(trajectory, args.out)
    if args.plot:
        plots.plot_deployment(trajectory, args.plot, panel_deflections(trajectory) if level.flexible else None)
    return 0


def _unlatched(parameters: ArrayParameters, latch_times: Array, angles: Array, duration: float) -> str:
    """Return a sentence that counts latched joints and names open ones; `angles` [rad] are the final joint angles."""
    open_joints = [row for row in parameters.joints if np.isnan(latch_times[row.index])]
    latched, hinges = len(parameters.joints) - len(open_joints), motorization(parameters)
    text = f"{latched or 'None'} of {len(parameters.joints)} joints latched within {duration:g} s: "
    weak = listed([hinges[row.index] for row in open_joints if hinges[row.index].stalls_at is not None])
    ends = [f"{row.name} is at {angles[row.index]:.3g} of {row.lock_angle:.3g} rad" for row in open_joints]
    return text + (weak or f"{', '.join(ends)}; simulate longer") + "."


def _print_summary(summary: dict[str, object]) -> None:
    table = Table(title=f"{summary['model']}, {summary['duration_s']:g} s", show_header=False)
    for key, value in summary.items():
        values = value if isinstance(value, list) else [value]
        table.add_row(key, ", ".join(f"{v:.{_DIGITS}g}" if isinstance(v, float) else str(v) for v in values))
    Console().print(table)
