"""Rows of a verification as a table for a terminal, and as JSON."""

import json
from collections.abc import Sequence

from rich import box
from rich.table import Table
from rich.text import Text

from solar_env.verification.checks import Row


def make_table(rows: Sequence[Row]) -> Table:
    """Table with a line for every row, under a heading for every case and one for every source.

    Its columns are quantity, expected, obtained, error, tolerance and verdict. Errors and tolerances marked
    with an r are relative.
    """
    failed = sum(not row.passed for row in rows)
    title = f"{len(rows)} checks, {failed} failed" if failed else f"{len(rows)} checks, all passed"
    table = Table(title=title, caption="r: relative to the expected value", title_justify="left", box=box.SIMPLE)
    table.add_column("case, source, quantity", overflow="fold", min_width=24)
    for name in ("expected", "obtained", "error", "tolerance"):
        table.add_column(name, justify="right", no_wrap=True)
    table.add_column("verdict", no_wrap=True)
    case = source = ""
    for row in rows:
        if row.case != case:
            if case:
                table.add_section()
            case, source = row.case, ""
            table.add_row(Text(case, style="bold"))
        if row.source != source:
            source = row.source
            table.add_row(Text(source, style="italic dim"))
        mark = "r" if row.relative else ""
        table.add_row(
            Text(row.quantity),
            f"{row.expected:.9g}",
            f"{row.obtained:.9g}",
            f"{row.error:.1e}{mark}",
            f"{row.tolerance:.1e}{mark}",
            Text("pass", style="green") if row.passed else Text("FAIL", style="bold red"),
        )
    return table


def to_json(rows: Sequence[Row]) -> str:
    """JSON text: passed, and every row as an object of `Row.to_dict`."""
    return json.dumps({"passed": all(row.passed for row in rows), "rows": [row.to_dict() for row in rows]}, indent=2)
