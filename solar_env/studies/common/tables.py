"""Tables of measured rows: CSV files with their provenance."""

from __future__ import annotations

import csv
import io
import os
import platform
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from solar_env.support.files import write_text
from solar_env.support.numbers import is_number
from solar_env.support.versions import versions

_WALL = "wall"  # beginning of the names of wall times
Name = TypeVar("Name", bound=StrEnum)
Cell = float | int | str
Row = dict[str, Cell]


@dataclass(frozen=True)
class Table:
    """Rows with the same columns, and their provenance.

    Attributes:
        rows: from column name to cell; all with the same names in the same order.
        provenance: what, with which settings, and on what machine.
    """

    rows: tuple[Mapping[str, Cell], ...]
    provenance: Mapping[str, str]

    def where(self, **cells: Cell) -> Table:
        """The rows that have these cells."""
        kept = (row for row in self.rows if all(row[name] == value for name, value in cells.items()))
        return Table(tuple(kept), self.provenance)

    def first(self, **cells: Cell) -> Mapping[str, Cell]:
        """The first row that has these cells.

        Raises:
            ValueError: if there is none.
        """
        found = self.where(**cells).rows
        if not found:
            wanted = ", ".join(f"{name} = {value!r}" for name, value in cells.items())
            raise ValueError(f"{_place(self.provenance)}no row has {wanted}; measure it anew")
        return found[0]

    def column(self, name: str) -> NDArray[np.float64]:
        """(rows,) numbers of one column.

        Raises:
            ValueError: as `number`.
        """
        return np.array([number(row, name) for row in self.rows], dtype=float)

    def values(self, name: str) -> tuple[Cell, ...]:
        """The different cells of a column, in the order of their first appearance."""
        return tuple(dict.fromkeys(row[name] for row in self.rows))


def number(row: Mapping[str, Cell], name: str) -> float:
    """A cell that is to be a number.

    Raises:
        ValueError: if it is none; the message names the file and the line, if the row was read from one.
    """
    cell = row[name]
    if not is_number(cell):
        raise ValueError(f"{_place(row)}{name} is {cell!r}, where a number belongs; measure it anew")
    return float(cell)


def choice(row: Mapping[str, Cell], name: str, known: type[Name]) -> Name:
    """A cell that is to be one of the names `known`.

    Raises:
        ValueError: if it is none; the message names the file and the line, if the row was read from one.
    """
    try:
        return known(str(row[name]))
    except ValueError as error:
        names = ", ".join(known)
        raise ValueError(f"{_place(row)}{name} is {row[name]!r}, none of {names}; measure it anew") from error


def _place(row: Mapping[str, Any]) -> str:
    return f"{row.place}: " if isinstance(row, _Row) else ""


def provenance(command: str, **settings: object) -> dict[str, str]:
    """Provenance of a table: the command, its settings, versions kind of machine; no names of users or hosts."""
    return {
        "command": command,
        **{name: str(value) for name, value in settings.items()},
        **versions(),
        "machine": f"{platform.machine()}, {os.cpu_count()} cores",
    }


def write_table(path: Path, rows: Sequence[Mapping[str, Cell]], made_by: Mapping[str, str]) -> None:
    """Write a CSV file whose first lines, each `# name: value`, are its provenance.

    Raises:
        ValueError: if there is no row, or rows differ in their columns.
    """
    if not rows:
        raise ValueError(f"no row to write to {path}")
    columns = list(rows[0])
    if any(list(row) != columns for row in rows):
        raise ValueError(f"the rows for {path} differ in their columns")
    text = io.StringIO()
    text.writelines(f"# {name}: {value}\n" for name, value in made_by.items())
    writer = csv.DictWriter(text, columns, lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    path.parent.mkdir(parents=True, exist_ok=True)
    write_text(path, text.getvalue())


def read_table(path: Path) -> Table:
    """Read what `write_table` wrote: cells that read as numbers are numbers.

    Raises:
        OSError: if the file cannot be read.
        ValueError: if it is damaged; or later, when it turns out to lack a column that is looked for.
    """
    made_by = _Row(str(path), ())
    try:
        lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
        count = len(lines)
        while lines and lines[0].startswith("# "):
            name, _, value = lines.pop(0)[2:].rstrip("\n").partition(": ")
            made_by[name] = value
        above, reader = count - len(lines), csv.reader(lines)
        header = next(reader, [])
        rows = [
            _Row(f"{path}, line {above + reader.line_num}", zip(header, map(_number, row), strict=True))
            for row in reader
        ]
    except (ValueError, csv.Error) as error:
        raise ValueError(f"{path} is damaged, or no table of measured rows ({error}); measure it anew") from error
    if not rows:
        raise ValueError(f"{path} has no rows; measure it anew")
    for name in header:
        _check_column(rows, name)
    return Table(tuple(rows), made_by)


def _check_column(rows: Sequence[Mapping[str, Cell]], name: str) -> None:
    """A column holds numbers or text, and wall times are positive, or nan where there is none."""
    if any(is_number(row[name]) for row in rows):
        for row in rows:
            if name.startswith(_WALL) and number(row, name) <= 0.0:
                raise ValueError(
                    f"{_place(row)}{name} is {row[name]!r}, where a positive time belongs; measure it anew"
                )
            number(row, name)


class _Row(dict[str, Any]):
    """A row of a file, or its provenance, that says of which one where an entry is missing.

    Attributes:
        place: the file, and the line in it.
    """

    def __init__(self, place: str, cells: Iterable[tuple[str, Any]]) -> None:
        super().__init__(cells)
        self.place = place

    def __missing__(self, name: str) -> Cell:
        raise ValueError(f"{self.place} lacks {name!r}; measure it anew")


def _number(cell: str) -> Cell:
    for kind in (int, float):
        try:
            return kind(cell)
        except ValueError:
            continue
    return cell
