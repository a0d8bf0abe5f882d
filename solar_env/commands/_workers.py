"""Options that say where many simulations run."""

import argparse
import os

from solar_env.support.campaigns import CLUSTERS


def add_worker_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare `--jobs` and `--cluster`, the fields of `Workers`."""
    parser.add_argument(
        "--jobs", type=int, help=f"processes (one a processor: {os.cpu_count()} here, with --cluster all of its own)"
    )
    parser.add_argument("--cluster", choices=CLUSTERS, help="run on the Ray cluster that this machine belongs to")
