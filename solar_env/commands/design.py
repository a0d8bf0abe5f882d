"""`solar-env design`: a search for the values of some parameters that minimise a quantity of the deployment."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from solar_env.commands.arguments import ArrayOption, CommandRecord, WorkerOptions, parse_assignments
from solar_env.support.files import make_folder

PICTURE = "design.png"


@dataclass
class Args(ArrayOption, WorkerOptions, CommandRecord):
    """Find parameter values that minimise a quantity of a deployment.

    One or two parameters are tried on a grid, more are searched by CMA-ES. A quantity is read at the joint where it is
    greatest, in the unit in which `loads` prints it. All joints have the same value of a parameter, or are scaled alike
    where their values differ.
    """

    change: list[str] = field(default_factory=lambda: ["hinge_damping", "latch_damping"])
    """parameters to change, each with a range or without one: hinge_damping=0,5 latch_damping; for a parameter that
    differs from joint to joint, the range multiplies the values"""
    keep: list[str] = field(default_factory=lambda: ["latch_time < 60"])
    """conditions that a design must meet, for example "latch_time < 30" "peak_force < 300" """
    least: str = "latch_torque"
    """quantity to minimise: latch_time, latch_rate, latch_torque, peak_force, peak_torque (bends the panel's root),
    impulse, impact_count, impact_speed_max, sliding_work, wear_depth; of the hub: hub_excursion (greatest turn),
    hub_turn (at the end, either way), hub_force, hub_torque, hub_acceleration"""
    points: int = 49
    """number of designs to try"""
    runs: int = 2
    """deployments that judge a design"""
    seed: int = 0
    """seed of the search"""
    out: Path = Path("design")
    """folder of table, picture and runs; an interrupted study continues from the runs"""


def run_command(args: Args) -> int:
    """Find the best design, print its values, write the table of the designs tried, and draw the picture."""
    from solar_env.array import default_integrator
    from solar_env.commands.warmup import warm_up
    from solar_env.studies.common.tables import provenance, write_table
    from solar_env.studies.design.plan import DesignPlan, parse_condition, quantity_name
    from solar_env.studies.design.plot import draw_design
    from solar_env.studies.design.points import CANDIDATES, Bench
    from solar_env.studies.design.search import answer, find_design, row_of
    from solar_env.support.progress import wide_console

    keep = tuple(map(parse_condition, args.keep))
    plan = DesignPlan(args.parameter_file, ranges(args.change), keep, quantity_name(args.least), args.runs, args.points)
    workers = args.workers
    make_folder(args.out)
    for model in CANDIDATES[:2]:
        warm_up(args.console, model, default_integrator(model).name)
    found = find_design(Bench(plan, args.out, workers, args.console), args.seed, not args.quiet)
    table, picture = args.out / "design.csv", args.out / PICTURE
    write_table(table, [row_of(plan, point) for point in (found.today, *found.points)], provenance(args.command))
    draw_design(found, picture)
    for line in answer(found):
        wide_console().print(line, highlight=False)
    print(table, picture, sep="\n")
    return 0


def ranges(words: Sequence[str]) -> dict[str, object]:
    """Map parameter names to ranges: "hinge_damping=0,5" gives (0, 5), "latch_damping" gives None (a default range)."""
    given = parse_assignments([word for word in words if "=" in word])
    return {**dict.fromkeys(word.strip() for word in words if "=" not in word), **given}
