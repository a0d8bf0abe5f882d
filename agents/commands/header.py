"""Command that writes a policy as one C header: `solar-env header`."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from agents.environments import environment_settings
from agents.policies.c_form import c_header, interface_comment
from agents.policies.policy import ShippedPolicy
from agents.policies.shipped import load_shipped
from solar_env.environment.hardware import Hardware
from solar_env.support.files import check_target, write_text


@dataclass
class Args:
    """Write a shipped policy as one C header with arrays and a function, for the computer of a drive."""

    policy: Annotated[str, tyro.conf.Positional] = "cma-es-nominal"
    """name of a policy of the package, or a folder that solar-env export wrote"""
    out: Path = Path("policy.h")
    """the header"""


def run_command(args: Args) -> int:
    """Run the command; see `Args`."""
    check_target(args.out)
    policy = load_shipped(args.policy)
    name = f"{Path(args.policy).name}_action"
    write_text(args.out, c_header(policy.network, name, interface_comment(policy.description, drive_of(policy))))
    print(f"written to {args.out}")
    return 0


def drive_of(policy: ShippedPolicy) -> Hardware:
    """The drive that a policy was trained on."""
    return environment_settings(policy.description.env_id, policy.description.env_kwargs).drive
