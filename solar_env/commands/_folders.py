"""Where the package keeps what the README shows."""

from __future__ import annotations

from pathlib import Path

PACKAGE = Path(__file__).resolve().parent.parent
FIGURE_FOLDER = PACKAGE / "figures"
README = PACKAGE.parent / "README.md"
