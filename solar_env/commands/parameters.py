"""`solar-env parameters`: a complete file of parameters, each explained."""

from dataclasses import dataclass
from typing import Annotated

import tyro

from solar_env.array import ArrayParameters
from solar_env.array.parameters.file import parameter_text


@dataclass
class Args:
    """Print a complete file of parameters, each explained."""

    preset: Annotated[str, tyro.conf.Positional] = "default"
    """parameter set: default or paper"""


def run_command(args: Args) -> int:
    """Print the file."""
    print(parameter_text(ArrayParameters.preset(args.preset)), end="")
    return 0
