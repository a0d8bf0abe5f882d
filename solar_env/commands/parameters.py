"""`python -m solar_env parameters`: a complete file of parameters, each explained."""

import argparse

from solar_env.array import PRESETS, ArrayParameters
from solar_env.array.parameter_file import parameter_text


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("--preset", default="default", help=f"parameter set: {', '.join(PRESETS)}")


def run_command(args: argparse.Namespace) -> int:
    """Print the file."""
    print(parameter_text(ArrayParameters.preset(args.preset)), end="")
    return 0
