"""The script `solar-env`: the command line, which prints one line on Ctrl-C, even while packages are being loaded."""

import sys
from collections.abc import Sequence


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line `solar_env.__main__.main`, and return its exit status; 130 after Ctrl-C."""
    try:
        from solar_env.__main__ import main as run

        return run(arguments)
    except KeyboardInterrupt:
        print("interrupted; nothing was kept", file=sys.stderr)
        return 130
