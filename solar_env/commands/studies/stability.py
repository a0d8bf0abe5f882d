"""`solar-env study stability`: maps of settings at which integrators fail, as tables and figures."""

import textwrap
from pathlib import Path
from typing import Any

from solar_env.array import compilation_note
from solar_env.commands.study import Args
from solar_env.mechanics.integrators.settings import INTEGRATORS
from solar_env.support.progress import counting_bar

OPTIONS = ("only", "quick", "draw", "out")
PARAMETERS = "parameters"
_COLUMNS = 100


def run(args: Args) -> int:
    """Map at which settings integrators fail; "--only parameters" instead varies each array parameter over 8 decades.

    Both check that the library reports failures: return 1 if a run's failure goes unreported, otherwise 0.
    """
    from solar_env.studies.stability.stability_maps import MAPS, measure_map

    names = [] if args.only == [PARAMETERS] else args.parts(MAPS)
    folder, _ = args.folders("stability")
    if not names:
        return _walk_parameters(args, folder)
    if not args.draw:
        cells = sum(1 for name in names for _ in MAPS[name].cells(args.quick))
        with counting_bar(args.console) as progress:
            task = progress.add_task("", total=cells)
            for name in names:
                progress.update(task, description=name + compilation_note(INTEGRATORS))
                measure_map(name, args.quick, folder / f"{name}.csv", lambda: progress.advance(task))
    return max(_report(name, folder / f"{name}.csv") for name in names)


def _walk_parameters(args: Args, folder: Path) -> int:
    """Simulate deployments with one array parameter at a time varied, and tabulate the outcomes in `folder`.

    Return the exit status: 1 if a run violates the energy balance without an error or a warning, otherwise 0.
    """
    from solar_env.studies.common.tables import read_table
    from solar_env.studies.stability import parameter_ranges as ranges

    table = folder / "parameters.csv"
    if not args.draw:
        with counting_bar(args.console) as progress:
            task = progress.add_task("parameters", total=len(ranges.NAMES) * len(ranges.MODELS) * len(ranges.FACTORS))
            ranges.measure(table, lambda: progress.advance(task))
    measured = read_table(table)
    print(f"{table}: {_counts(measured)}")
    return int(ranges.SILENT in measured.values("class"))


def _report(name: str, path: Path) -> int:
    """Draw stability map `name` from table `path`; return 1 if a run failed without a report by solar_env, else 0."""
    from solar_env.studies.common.tables import read_table
    from solar_env.studies.stability.maps import silent_failures
    from solar_env.studies.stability.stability_plot import draw_map

    table = read_table(path)
    draw_map(path, path.with_suffix(".png"))
    print(f"{name}: {_counts(table)}")
    print(f"  {path}, {path.with_suffix('.png')}")
    print(textwrap.fill(table.provenance["advice"], _COLUMNS, initial_indent="  ", subsequent_indent="  "))
    silent = len(silent_failures(table).rows)
    if silent:
        print(f"  {silent} of the failures passed without a word of the library")
    return int(silent > 0)


def _counts(table: Any) -> str:
    """Return a text of how many runs have each outcome, the table's column "class", such as "12 fine, 3 stiff"."""
    return ", ".join(f"{len(table.where(**{'class': kind}).rows)} {kind}" for kind in table.values("class"))
