"""The command `presets`: names of the presets."""

import argparse

from solar_env.array import PRESETS


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """No options."""


def run_command(args: argparse.Namespace) -> int:
    """Print the names."""
    print("\n".join(PRESETS))
    return 0
