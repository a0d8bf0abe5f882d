"""How far a command is: a bar in a terminal, nothing in the log of a job."""

from collections.abc import Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn


def counting_bar(console: Console) -> Progress:
    """A bar with the number of things done, the time taken and what is in hand; it vanishes at the end."""
    columns = (BarColumn(), MofNCompleteColumn(), TimeElapsedColumn(), TextColumn("{task.description}"))
    shown = console if console.is_interactive else Console(quiet=True)
    return Progress(*columns, console=shown, transient=True)


@contextmanager
def stage(console: Console, text: str) -> Iterator[None]:
    """Say what takes a while and cannot be counted: in a terminal as long as it lasts, else in a line."""
    if not console.is_interactive:
        console.print(text, highlight=False, markup=False, soft_wrap=True)
    with console.status(text):
        yield
