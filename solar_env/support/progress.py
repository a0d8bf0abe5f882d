"""Progress of a command, as a bar in a terminal but not in the log of a job; and tables in a terminal."""

from collections.abc import Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.markdown import Markdown
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

_NARROWEST = 140  # least width [characters] of output that is not a terminal


def counting_bar(console: Console) -> Progress:
    """Return a progress bar with the count, the elapsed time and the present task; the bar vanishes at the end."""
    columns = (BarColumn(), MofNCompleteColumn(), TimeElapsedColumn(), TextColumn("{task.description}"))
    shown = console if console.is_interactive else Console(quiet=True)
    return Progress(*columns, console=shown, transient=True)


@contextmanager
def stage(console: Console, text: str) -> Iterator[None]:
    """Show the name of a long, uncountable task: in a terminal while the task lasts, otherwise by one printed line."""
    if not console.is_interactive:
        console.print(text, highlight=False, markup=False, soft_wrap=True)
    with console.status(text):
        yield


def print_markdown(text: str) -> None:
    """Print Markdown as formatted text, in the width of `wide_console`."""
    wide_console().print(Markdown(text))


def wide_console() -> Console:
    """Return a console for wide tables: as wide as the terminal, or at least 140 characters without a terminal."""
    console = Console()
    if not console.is_terminal:
        console.width = max(console.width, _NARROWEST)
    return console
