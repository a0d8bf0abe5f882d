"""The command `presets`: names of the presets."""

from dataclasses import dataclass

from solar_env.array import PRESETS


@dataclass
class Args:
    """Print the names of the presets."""


def run_command(args: Args) -> int:
    """Print the names."""
    print("\n".join(PRESETS))
    return 0
