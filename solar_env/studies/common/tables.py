"""Tables of measured rows, written to and read from CSV files with their provenance."""

from __future__ import annotations

import csv
import io
import os
import platform
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solar_env.support.files import write_text
from solar_env.support.values import is_number
from solar_env.support.versions import versions

Cell = float | int | str
Row = dict[str, Cell]


@dataclass(frozen=True)
class Table:
    """Rows with the same columns, and their provenance.

    Attributes:
        rows: mappings from column name to cell; all have the same names in the same order.
        provenance: command, settings, versions and machine.
    """

    rows: tuple[Mapping[str, Cell], ...]
    provenance: Mapping[str, str]

    def where(self, **cells: Cell) -> Table:
        """Return a table of the rows whose cells equal the given values, such as `where(model="rigid-ideal")`."""
        kept = (row for row in self.rows if all(row[name] == value for name, value in cells.items()))
        return Table(tuple(kept), self.provenance)

    def column(self, name: str) -> NDArray[np.float64]:
        """Return the (rows,) numbers of one column.

        Raises:
            ValueError: if a cell of the column is not a number.
        """
        return np.array([number(row, name) for row in self.rows], dtype=float)

    def values(self, name: str) -> tuple[Cell, ...]:
        """Return the distinct cells of a column, in the order of their first appearance."""
        return tuple(dict.fromkeys(row[name] for row in self.rows))


class _Read(dict[str, Cell]):
    """A row of a table file, or its provenance, as a dictionary; the error for a missing key names the file."""

    def __init__(self, file: Path, cells: Iterable[tuple[str, Cell]] = ()) -> None:
        super().__init__(cells)
        self.file = file

    def __missing__(self, name: str) -> Cell:
        raise ValueError(f"{self.file} is damaged or lacks {name}; measure it anew")


def number(row: Mapping[str, Cell], name: str) -> float:
    """Return the number in a row's cell `name`.

    Raises:
        ValueError: if the cell is not a number.
    """
    cell = row[name]
    if not is_number(cell):
        file = row.file if isinstance(row, _Read) else "the table"
        raise ValueError(f"{file} is damaged or lacks {name}, which is {cell!r} and no number; measure it anew")
    return float(cell)


def provenance(command: str, **settings: object) -> dict[str, str]:
    """Return a table's provenance: command, settings, software versions, kind of machine, but no user or host names."""
    return {
        "command": command,
        **{name: str(value) for name, value in settings.items()},
        **versions(),
        "machine": f"{platform.machine()}, {os.cpu_count()} cores",
    }


def write_table(path: Path, rows: Sequence[Mapping[str, Cell]], made_by: Mapping[str, str]) -> None:
    """Write rows with the same columns to a CSV file; its first lines, `# name: value`, hold the provenance `made_by`.

    Raises:
        ValueError: if a row has a column that the first row lacks.
    """
    text = io.StringIO()
    text.writelines(f"# {name}: {value}\n" for name, value in made_by.items())
    writer = csv.DictWriter(text, list(rows[0]), lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    path.parent.mkdir(parents=True, exist_ok=True)
    write_text(path, text.getvalue())


def read_table(path: Path) -> Table:
    """Read a table that `write_table` wrote; cells that look like numbers become numbers.

    Raises:
        OSError: if the file cannot be read.
        ValueError: if the file is damaged; or later, when code asks the table for a missing column.
    """
    made_by: dict[str, Any] = _Read(path)
    try:
        lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
        while lines and lines[0].startswith("# "):
            name, _, value = lines.pop(0)[2:].rstrip("\n").partition(": ")
            made_by[name] = value
        header, *cells = csv.reader(lines)
        if not cells:
            raise ValueError("it has none")
        rows = [_Read(path, zip(header, map(_number, row), strict=True)) for row in cells]
    except (ValueError, csv.Error) as error:
        raise ValueError(f"{path} is damaged or lacks its rows ({error}); measure it anew") from error
    return Table(tuple(rows), made_by)


def _number(cell: str) -> Cell:
    for kind in (int, float):
        try:
            return kind(cell)
        except ValueError:
            continue
    return cell
