"""Where the package keeps what the README shows."""

from __future__ import annotations

from pathlib import Path

PACKAGE = Path(__file__).resolve().parent
FIGURE_FOLDER = PACKAGE / "figures"
README = PACKAGE.parent / "README.md"


def check_readme(begin: str) -> None:
    """Check that the README has one place for what a command writes there.

    Raises:
        ValueError: if not.
        OSError: if there is no README.
    """
    if README.read_text(encoding="utf-8").count(begin) != 1:
        raise ValueError(f"{README} has no place for the result, which begins with {begin}")


def replace_in_readme(begin: str, end: str, text: str) -> None:
    """Write ``text`` between two lines of the README, in place of what is there.

    Raises:
        ValueError, OSError: as :func:`check_readme`.
    """
    check_readme(begin)
    before, rest = README.read_text(encoding="utf-8").split(begin)
    README.write_text(f"{before}{begin}\n\n{text}\n\n{end}{rest.split(end)[1]}", encoding="utf-8")
