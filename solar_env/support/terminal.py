"""Tables for who reads them in a terminal, or in what its output goes to."""

from rich.console import Console
from rich.markdown import Markdown

_NARROWEST = 140  # characters, where the output is not a terminal


def print_markdown(text: str) -> None:
    """Print Markdown as it reads, drawn for the width of `wide_console`."""
    wide_console().print(Markdown(text))


def wide_console() -> Console:
    """A console for wide tables: as wide as the terminal, or 140 characters where there is none."""
    console = Console()
    if not console.is_terminal:
        console.width = max(console.width, _NARROWEST)
    return console
