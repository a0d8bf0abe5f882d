"""`solar-env parameters`: a complete parameter file that explains each parameter."""

from dataclasses import dataclass
from typing import Annotated

import tyro

from solar_env.array.parameters.file import WINGS, named_array, parameter_text


@dataclass
class Args:
    """Print an array's complete parameter file, with explanations."""

    array: Annotated[str, tyro.conf.Positional] = "default"
    """default, paper, cubesat-6u, apple or tape-spring"""


def run_command(args: Args) -> int:
    """Print the parameter file of the array."""
    if args.array in WINGS:
        print(WINGS[args.array].read_text(encoding="utf-8"), end="")
    else:
        print(parameter_text(named_array(args.array).parameters), end="")
    return 0
