"""Tables for who reads them in a terminal, or in what its output goes to."""

from collections.abc import Sequence
from typing import ClassVar

from rich import box
from rich.console import Console, ConsoleOptions, RenderResult
from rich.markdown import Markdown, MarkdownElement, TableElement
from rich.table import Table
from rich.text import Text

Cells = Sequence[Text]

_GAP = 3  # characters between columns, and around them
_NARROWEST = 140  # characters, where the output is not a terminal


class WholeTable(TableElement):
    """A table of Markdown in which no word is cut: one that is too wide stands on its side, in parts if need be."""

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        """Yield the table, or the parts of the one on its side."""
        head = [cell.content for cell in self.header.row.cells] if self.header and self.header.row else []
        rows = [[cell.content for cell in row.cells] for row in self.body.rows] if self.body else []
        columns: list[Cells] = list(zip(head, *rows, strict=True))
        if _width(columns) <= options.max_width:
            yield _table(columns)
            return
        while rows:
            count = len(rows)
            while count > 1 and _width([head, *rows[:count]]) > options.max_width:
                count -= 1
            yield _table([head, *rows[:count]])
            del rows[:count]


class WholeMarkdown(Markdown):
    """Markdown whose tables are whole."""

    elements: ClassVar[dict[str, type[MarkdownElement]]] = {**Markdown.elements, "table_open": WholeTable}


def _longest_word(column: Cells) -> int:
    return max((len(word) for cell in column for word in cell.plain.split()), default=0)


def _width(columns: Sequence[Cells]) -> int:
    """Characters without which a word of the columns would be cut."""
    return sum(_longest_word(column) + _GAP for column in columns)


def _table(columns: Sequence[Cells]) -> Table:
    table = Table(box=box.SIMPLE)
    for heading, *_ in columns:
        table.add_column(Text(heading.plain, style="bold"), overflow="fold")
    for column, drawn in zip(columns, table.columns, strict=True):
        drawn.min_width = _longest_word(column)
    for line in list(zip(*columns, strict=True))[1:]:
        table.add_row(*line)
    return table


def print_markdown(text: str) -> None:
    """Print Markdown as it reads: drawn for the width of the terminal, or of 80 characters where there is none."""
    Console().print(WholeMarkdown(text))


def wide_console() -> Console:
    """A console for wide tables: as wide as the terminal, or 140 characters where there is none."""
    console = Console()
    if not console.is_terminal:
        console.width = max(console.width, _NARROWEST)
    return console
