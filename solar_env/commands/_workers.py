"""Options that say where many simulations run."""

from __future__ import annotations

import argparse
import os
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from solar_env.support.campaigns import Workers


def add_worker_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare `--jobs` and `--cluster`."""
    parser.add_argument(
        "--jobs", type=int, help=f"processes (one a processor: {os.cpu_count()} here, with --cluster all of its own)"
    )
    parser.add_argument("--cluster", choices=("ray",), help="run on the Ray cluster that this machine belongs to")


def chosen_workers(args: argparse.Namespace) -> Workers:
    """Workers as the options say.

    Raises:
        ValueError: if there are no processes.
    """
    from solar_env.support.campaigns import Workers

    return Workers(args.jobs, args.cluster)
