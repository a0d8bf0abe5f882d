"""`python -m solar_env simulate`: one deployment from the command line."""

import argparse
import ast
import json
import sys
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.progress import Progress
from rich.table import Table

from solar_env.array import (
    DEFAULT_ELEMENTS,
    DEFAULT_MODES,
    MODELS,
    PANELS,
    PRESETS,
    ArrayParameters,
    PanelModel,
    check_model,
)
from solar_env.array.ladder import DEFAULT_TOLERANCE, QUESTIONS, Answer, cheapest, read_answers
from solar_env.array.methods import INTEGRATOR_NAMES, default_integrator, make_integrator
from solar_env.array.models import has_flexible_panels
from solar_env.array.panels import DEFAULT_PANELS, PRESET_PANELS
from solar_env.mechanics.integrators.settings import Rosenbrock, RungeKutta

DEFAULT_MODEL = "rigid-clearance"
_NOTEWORTHY_SHARE = 0.1  # of steps at the limit of stability, above which the command says so


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("--model", help=f"one of {', '.join(MODELS)}; default: {DEFAULT_MODEL}")
    parser.add_argument(
        "--panels",
        help=f"of a flexible model, one of {', '.join(PANELS)}; default: {DEFAULT_PANELS}, "
        + ", ".join(f"{kind} of the preset {name}" for name, kind in PRESET_PANELS.items()),
    )
    parser.add_argument("--modes", type=int, metavar="N", help=f"bending modes of each modal panel ({DEFAULT_MODES})")
    parser.add_argument("--elements", type=int, metavar="N", help=f"beam elements of each panel ({DEFAULT_ELEMENTS})")
    parser.add_argument(
        "--question", metavar="NAME",
        help="take the cheapest model and panels that answer a question, as measured by the command ladder: "
        f"{', '.join(QUESTIONS)}",
    )  # fmt: skip
    parser.add_argument("--tolerance", type=float, metavar="X", help=f"of the answer, relative ({DEFAULT_TOLERANCE:g})")
    parser.add_argument("--duration", type=float, default=30.0, metavar="S", help="simulated time [s]")
    parser.add_argument("--preset", default="default", help=f"parameter set: {', '.join(PRESETS)}")
    parser.add_argument(
        "--set", nargs="+", action="extend", default=[], metavar="KEY=VALUE",
        help="change parameters, e.g. clearance=1e-4,2e-4 (solar_env.ArrayParameters lists them)",
    )  # fmt: skip
    parser.add_argument("--integrator", help=f"one of {', '.join(INTEGRATOR_NAMES)}; default: the model's best")
    parser.add_argument("--step", type=float, metavar="S", help="fixed step, or bound on adaptive ones [s]")
    parser.add_argument("--rtol", type=float, help="local error tolerance")
    parser.add_argument("--output-step", type=float, default=0.01, metavar="S", help="distance of the samples [s]")
    parser.add_argument("--plot", type=Path, metavar="FILE", help="write a figure (png, svg or pdf)")
    parser.add_argument("--out", type=Path, metavar="FILE", help="write the trajectory (npz)")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the summary (- for standard output)")


def parse_changes(assignments: list[str]) -> dict[str, Any]:
    """Parameter changes from KEY=VALUE strings; comma-separated numbers become a tuple, other text stays text.

    Raises:
        ValueError: if an assignment has no "=".
    """
    changes: dict[str, Any] = {}
    for assignment in assignments:
        key, separator, text = assignment.partition("=")
        if not separator:
            raise ValueError(f"--set {assignment!r} must have the form key=value")
        try:
            changes[key.strip()] = ast.literal_eval(text.strip())
        except (ValueError, SyntaxError):
            changes[key.strip()] = text.strip()
    return changes


def run_command(args: argparse.Namespace) -> int:
    """Simulate, report, write what was asked for."""
    # Wrong input is refused before the compiler is loaded.
    answer = _chosen_answer(args)
    model, panels = _level(args, answer)
    parameters = ArrayParameters.preset(args.preset).with_changes(parse_changes(args.set))
    for path in (args.plot, args.out, args.json):
        if path is not None and str(path) != "-" and not path.parent.is_dir():
            raise ValueError(f"the folder of {path} does not exist")
    name = args.integrator or default_integrator(model, panels).name
    integrator = make_integrator(name, model, args.step, args.rtol)
    from solar_env.array.deployment import panel_deflections, simulate
    from solar_env.commands.warmup import warm_up

    console = Console(stderr=True)
    if answer is not None:
        console.print(_answer_note(answer, parameters), highlight=False, soft_wrap=True)
    warm_up(console, model, name)
    with Progress(console=console, transient=True) as progress:
        task = progress.add_task("simulating", total=args.duration)
        trajectory = simulate(
            parameters,
            model=model,
            panels=panels,
            duration=args.duration,
            integrator=integrator,
            output_step=args.output_step,
            progress=lambda time: progress.update(task, completed=time),
        )
    if name == RungeKutta.name and trajectory.stability_bound_share > _NOTEWORTHY_SHARE:
        console.print(_stability_note(trajectory.stability_bound_share), highlight=False, soft_wrap=True)
    summary = trajectory.summary()
    if str(args.json) == "-":
        json.dump(summary, sys.stdout, indent=2)
        print()
    else:
        _print_summary(summary)
        if args.json:
            args.json.write_text(json.dumps(summary, indent=2) + "\n")
    if args.out:
        trajectory.save(args.out)
    if args.plot:
        from solar_env.pictures.plots import plot_deployment

        plot_deployment(trajectory, args.plot, panel_deflections(trajectory) if has_flexible_panels(model) else None)
    return 0


def _chosen_answer(args: argparse.Namespace) -> Answer | None:
    """Row of the ladder for the cheapest level that answers the question; None if no question is asked."""
    if args.question is None:
        if args.tolerance is not None:
            raise ValueError("--tolerance says how well a --question is answered; give one, or --rtol for the steps")
        return None
    for option in ("model", "panels", "elements", "modes"):
        if getattr(args, option) is not None:
            raise ValueError(f"--question chooses model and panels: leave out --{option}, or the question")
    return cheapest(read_answers(), args.question, DEFAULT_TOLERANCE if args.tolerance is None else args.tolerance)


def _level(args: argparse.Namespace, answer: Answer | None) -> tuple[str, PanelModel]:
    """Model, and that of its panels, chosen by the ladder or given.

    Raises:
        ValueError: if one given is refused.
    """
    if answer is not None:
        return answer.model, PanelModel.of(answer.model, answer.panel_model, integrator=args.integrator)
    model = check_model(DEFAULT_MODEL if args.model is None else args.model)
    return model, PanelModel.of(model, args.panels, args.elements, args.modes, args.integrator, args.preset)


def _answer_note(answer: Answer, parameters: ArrayParameters) -> str:
    note = (
        f"{answer.level}: the cheapest level for {answer.question}, measured error {answer.error:.2g} (sampling "
        f"{answer.half_width:.2g}), {answer.cost_ratio:.2g} times the reference's cost"
    )
    if parameters != ArrayParameters():
        note += "; measured with the default parameters, not with these"
    return note


def _stability_note(share: float) -> str:
    return (
        f"{100.0 * share:.0f} % of the steps were as long as the stability of the explicit "
        f"method on the panels' axial vibration allows; a looser tolerance does not make them longer, the integrator "
        f"'{Rosenbrock.name}' does"
    )


def _print_summary(summary: dict[str, Any]) -> None:
    table = Table(title=f"{summary['model']}, {summary['duration_s']:g} s", show_header=False)
    for key, value in summary.items():
        if value is None:
            continue  # a count of what these panels do not consist of
        values = value if isinstance(value, list) else [value]
        text = ", ".join(f"{x:.6g}" if isinstance(x, float) else str(x) for x in values)
        table.add_row(key, text)
    Console().print(table)
