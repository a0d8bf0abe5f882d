"""The script `solar-env`: the command line, with Ctrl-C answered in one line while packages are still being loaded."""

import sys
from collections.abc import Sequence


def main(arguments: Sequence[str] | None = None) -> int:
    """Run `solar_env.__main__.main`."""
    try:
        from solar_env.__main__ import main as run

        return run(arguments)
    except KeyboardInterrupt:
        print("interrupted; nothing was kept", file=sys.stderr)
        return 130
