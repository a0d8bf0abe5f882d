"""`solar-env loads`: loads on hinges and hub, with their uncertainty."""

from dataclasses import dataclass, field
from pathlib import Path

from rich.markup import escape
from rich.table import Table

from solar_env.array import build
from solar_env.array.motorization import motorization
from solar_env.commands.arguments import ArrayOption, Assignments, CommandRecord, WorkerOptions
from solar_env.support.files import check_target
from solar_env.support.progress import wide_console


@dataclass
class Args(ArrayOption, WorkerOptions, CommandRecord):
    """Compute the loads on hinges and hub, with their uncertainty.

    An ensemble of deployments is simulated at the model level --model, such as rigid-clearance, and at the finest one.
    Deployments differ slightly in initial joint rates, and in parameters drawn from tolerances in the array's file.
    """

    model: str | None = None
    """level of the model, by default flexible-clearance, of 6 elements where panels have fittings; solar-env ladder
    --ask tells of others"""
    runs: int | None = None
    """deployments at each of the two levels, without those for sensitivities; by default 16, or more if the effects of
    many tolerances take more; 0 prints motorization and frequencies"""
    window: float = 10.0
    """time simulated after the last latching [s]"""
    deadline: float = 60.0
    """time by which all joints must have latched [s]"""
    factors: Assignments = field(default_factory=dict)
    """uncertainty factors of the resistances in hinges, by default those of ECSS-E-ST-33-01C for unmeasured values;
    for example harness=1.5 friction=1.5"""
    html: Path | None = None
    """write a page with everything, which needs no network"""
    hub: Path | None = None
    """write force and torque on the hub at all times (.csv)"""
    out: Path = Path("loads")
    """folder of the runs, from which an interrupted ensemble continues"""


def run_command(args: Args) -> int:
    """Simulate an ensemble of deployments, print a summary and tables of the loads, and write the requested files."""
    from solar_env.studies.loads.ensemble import LoadsPlan, check_latching, measure_loads, measure_sensitivity
    from solar_env.studies.loads.hub import write_hub_loads
    from solar_env.studies.loads.page import loads_page
    from solar_env.studies.loads.report import answer, tables, what_changes
    from solar_env.studies.loads.runs import deploy
    from solar_env.studies.loads.sensitivity import fewest_runs
    from solar_env.studies.loads.statics import statics
    from solar_env.support.versions import versions

    array = args.parameter_file
    runs = args.runs if args.runs is not None else max(LoadsPlan.members, fewest_runs(array.randomize))
    if runs < 0:
        raise ValueError(f"runs = {runs} must be at least 0")
    if runs == 0:
        for line in statics(array, args.factors):
            wide_console().print(line, highlight=False)
        return 0
    plan, workers = LoadsPlan(array, args.model, runs, args.window, args.deadline), args.workers
    for level in plan.levels:
        build(array.parameters, level.model)  # refuses wrong input before anything is compiled
    for path, suffix in ((args.html, ".html"), (args.hub, ".csv")):
        if path is not None:
            check_target(path, (suffix,))
    before = statics(array, args.factors)
    for line in before:
        args.console.print(line, highlight=False)
    from solar_env.array import default_integrator
    from solar_env.commands.warmup import warm_up

    kernels = [(level.model, default_integrator(level.model).name) for level in plan.levels]
    for model, method in dict.fromkeys(kernels):
        warm_up(args.console, model, method)
    if any(hinge.stalls_at is not None for hinge in motorization(array.parameters)):
        check_latching(plan)
    loads, printed = measure_loads(plan, args.out, workers, args.console), wide_console()
    for line in answer(loads, before):
        printed.print(line, highlight=False)
    loads = measure_sensitivity(loads, args.out, workers, args.console)
    printed.print(what_changes(loads), highlight=False)
    if args.html or args.hub:
        nominal = deploy(plan.levels[0], array.parameters, 0, plan.window, plan.deadline)
    if args.html:
        from solar_env.pictures.page.document import write_page

        notes = [f"Made by: {args.command}", ", ".join(f"{name} {value}" for name, value in versions().items())]
        write_page(loads_page(loads, nominal, notes, before), args.html)
    if args.hub:
        write_hub_loads(array.parameters, nominal.trajectory.time, nominal.hub_loads, args.hub)
    for table in tables(loads):
        shown = Table(*table.columns, title=table.title)
        for row in table.rows:
            shown.add_row(*map(escape, row))
        printed.print(shown)
    return 0
