"""Command that writes a policy for other programs, as ONNX: `solar-env export`."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from agents.learning import runs
from solar_env.support.files import check_target, write_bytes


@dataclass
class Args:
    """Write a policy as ONNX, for other programs.

    It maps observations (n, entries) to actions (n, 1), both float32.
    """

    policy: Annotated[str, tyro.conf.Positional] = "rigid"
    """run folder, model.zip of Stable-Baselines3, or policy of the package"""
    out: Path = Path("policy.onnx")
    """file to write"""


def run_command(args: Args) -> int:
    """Write the policy as ONNX; see `Args`. Raise a ValueError if ONNX is not installed, or if a file is damaged."""
    check_target(args.out, (".onnx",))
    try:
        from agents.policies.onnx_form import onnx_model
    except ImportError as error:
        raise ValueError("exporting needs ONNX: pip install -e '.[onnx]'") from error
    write_bytes(args.out, onnx_model(runs.best_policy(args.policy)).SerializeToString())
    print(f"written to {args.out}")
    return 0
