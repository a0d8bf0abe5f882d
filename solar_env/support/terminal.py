"""Tables for who reads them: drawn in a terminal, Markdown in a file or a pipe."""

from rich.console import Console
from rich.markdown import Markdown


def print_markdown(text: str) -> None:
    """Print Markdown: drawn where standard output is a terminal, else as it is."""
    console = Console()
    if console.is_terminal:
        console.print(Markdown(text))
    else:
        print(text)
