"""`solar-env stability`: maps of where methods fail, as tables and figures."""

import textwrap
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console

from solar_env.array.compilation import compilation_note
from solar_env.commands.arguments import QuietOption
from solar_env.mechanics.integrators.settings import INTEGRATORS
from solar_env.support.files import make_folder, write_text
from solar_env.support.progress import counting_bar

_COLUMNS = 100


@dataclass
class Args(QuietOption):
    """Map where methods fail, and check that the library says so."""

    quick: bool = False
    """few cells: less than two minutes for all maps"""
    only: str | None = None
    """one map; a name that is none lists them"""
    out: Path = Path("stability")
    """folder of tables and figures"""
    draw: bool = False
    """draw the figures again from the tables in the folder"""
    parameters: bool = False
    """instead of the maps, walk every parameter over eight decades, and write a table and a page"""


def run_command(args: Args) -> int:
    """Measure the maps, draw them, and print what to do; 1 if the library kept silent about a failure, else 0."""
    from solar_env.studies.stability.stability_maps import MAPS, measure_map

    if args.parameters:
        return _walk_parameters(args)
    if args.only is not None and args.only not in MAPS:
        raise ValueError(f"map {args.only!r} is unknown; choose from {', '.join(MAPS)}")
    names = list(MAPS) if args.only is None else [args.only]
    make_folder(args.out)
    if args.draw:
        return max(_report(name, args.out) for name in names)
    cells = sum(1 for name in names for _ in MAPS[name].cells(args.quick))
    with counting_bar(Console(stderr=True, quiet=args.quiet)) as progress:
        task = progress.add_task("", total=cells)
        for name in names:
            progress.update(task, description=name + compilation_note(INTEGRATORS))
            measure_map(name, args.quick, args.out / f"{name}.csv", lambda: progress.advance(task))
    return max(_report(name, args.out) for name in names)


def _walk_parameters(args: Args) -> int:
    """Measure the ranges of the parameters; 1 if a failure passed in silence."""
    from solar_env.studies.common.tables import read_table
    from solar_env.studies.stability import parameter_ranges as ranges

    table, page = args.out / "parameters.csv", args.out / "parameters.md"
    make_folder(args.out)
    with counting_bar(Console(stderr=True, quiet=args.quiet)) as progress:
        task = progress.add_task("parameters", total=len(ranges.NAMES) * len(ranges.MODELS) * len(ranges.FACTORS))
        ranges.measure(table, lambda: progress.advance(task))
    measured = read_table(table)
    write_text(page, ranges.page(measured))
    print(f"{table}, {page}")
    return 1 if measured.where(**{"class": ranges.SILENT}).rows else 0


def _report(name: str, folder: Path) -> int:
    """Draw a map and print its figures; 1 if a failure passed in silence."""
    from solar_env.studies.common.tables import read_table
    from solar_env.studies.stability.maps import silent_failures
    from solar_env.studies.stability.stability_plot import draw_map

    path = folder / f"{name}.csv"
    table = read_table(path)
    draw_map(path, path.with_suffix(".png"))
    silent = len(silent_failures(table).rows)
    counts = {kind: len(table.where(**{"class": kind}).rows) for kind in table.values("class")}
    print(f"{name}: {', '.join(f'{count} {kind}' for kind, count in counts.items())}")
    print(f"  {path}, {path.with_suffix('.png')}")
    print(textwrap.fill(table.provenance["advice"], _COLUMNS, initial_indent="  ", subsequent_indent="  "))
    if silent:
        print(f"  {silent} of the failures passed without a word of the library")
    return 1 if silent else 0
