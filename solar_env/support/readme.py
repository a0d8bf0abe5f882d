"""Where the package keeps what the README shows."""

from __future__ import annotations

from pathlib import Path

PACKAGE = Path(__file__).resolve().parent.parent
FIGURE_FOLDER = PACKAGE / "figures"
README = PACKAGE.parent / "README.md"


def check_readme(begin: str, end: str) -> None:
    """Check that the README has one place, between two lines, for what a command writes there.

    Raises:
        ValueError: if not.
        OSError: if there is no README.
    """
    text = README.read_text(encoding="utf-8")
    if text.count(begin) != 1 or text.count(end) != 1 or text.index(begin) > text.index(end):
        raise ValueError(f"{README} has no place for the result, which begins with {begin} and ends with {end}")


def replace_in_readme(begin: str, end: str, text: str) -> None:
    """Write ``text`` between two lines of the README, in place of what is there.

    Raises:
        ValueError, OSError: as :func:`check_readme`.
    """
    check_readme(begin, end)
    before, rest = README.read_text(encoding="utf-8").split(begin)
    README.write_text(f"{before}{begin}\n\n{text}\n\n{end}{rest.split(end)[1]}", encoding="utf-8")
