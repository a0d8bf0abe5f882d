"""Command that writes a policy in a form for other programs, or ships it: `solar-env export`."""

import re
from dataclasses import asdict, dataclass
from pathlib import Path
from types import ModuleType
from typing import Annotated, Any

import numpy as np
import tyro

from agents.comparison.report import TABLES
from agents.environments import environment_settings, make_env
from agents.laws.table import LAWS
from agents.learning import runs
from agents.policies import shipped
from agents.policies.c_form import c_header, interface_comment
from agents.policies.card import card
from agents.policies.shipped import ShippedPolicy
from solar_env.support.files import check_target, new_folder, write_bytes, write_text

TOLERANCE = 1e-5  # of actions, between the network and its ONNX form


@dataclass
class Args:
    """Write a policy as arrays, ONNX or C, or as a folder with a card."""

    policy: Annotated[str, tyro.conf.Positional] = "cma-es-nominal"
    """run folder, or policy of the package, or folder that this command wrote"""
    out: Path = Path("policy.npz")
    """arrays, .npz, with their description beside them, .json; .onnx; one C header, .h; without a suffix a folder with
    arrays and ONNX form, and for a run with the card too, which is a policy of the package in agents/policies"""


def run_command(args: Args) -> int:
    """Run the command; see `Args`."""
    path = args.out
    if path.suffix:
        check_target(path, (".npz", ".onnx", ".h"))
        policy = named_policy(args.policy)
        if path.suffix.lower() == ".npz":
            shipped.write_policy(path.parent, policy, path.stem)
        elif path.suffix.lower() == ".onnx":
            write_bytes(path, onnx_form().onnx_model(policy.network).SerializeToString())
        else:
            description = policy.description
            hardware = environment_settings(description.env_id, description.env_kwargs).devices
            write_text(path, c_header(policy.network, f"{path.stem}_action", interface_comment(description, hardware)))
    else:
        export(args.policy, path)
    print(f"written to {path}")
    return 0


def named_policy(name: str | Path) -> ShippedPolicy:
    """Read the best policy of a run, or one that was shipped.

    Raises:
        FileNotFoundError: There is none.
        ValueError: A file is damaged.
    """
    folder = Path(name)
    return runs.best_policy(folder) if (folder / runs.CONFIG).is_file() else shipped.load_shipped(name)


def onnx_form() -> ModuleType:
    """Import the module of the ONNX form.

    Raises:
        ValueError: ONNX is not installed.
    """
    try:
        from agents.policies import onnx_form as module
    except ImportError as error:
        raise ValueError("exporting needs ONNX and its runtime: pip install 'solar-env[onnx]'") from error
    return module


def export(run: str | Path, folder: Path) -> ShippedPolicy:
    """Write a policy, its ONNX form and, for a run, its card to `folder`, whole or not at all.

    The scores of the card are those of the comparison with which the training ended.

    Raises:
        FileExistsError: `folder` exists.
        OSError: It cannot be written.
        FileNotFoundError: There is no run, or it has no policy.
        ValueError: ONNX is not installed, or the name is a law's.
    """
    form = onnx_form()
    if folder.name in LAWS or not re.fullmatch(r"\w[\w-]*", folder.name):
        raise ValueError(
            f"the folder's name is {folder.name!r}, and the policy's; choose one of letters, digits, underscores and "
            f"hyphens that is no law's ({', '.join(LAWS)})"
        )
    if folder.exists():
        raise FileExistsError(f"{folder} exists; choose another --out, or remove it")
    policy, run = named_policy(run), Path(run)
    description = policy.description
    onnx_bytes = form.onnx_model(policy.network).SerializeToString()
    text = None
    with make_env(description.env_id, description.env_kwargs) as env:
        space: Any = env.observation_space
        drawn = np.random.default_rng(0).uniform(space.low, space.high, (500, *space.shape)).astype(np.float32)
        found = form.difference(policy.network, onnx_bytes, drawn)
        if not found <= TOLERANCE:
            raise ValueError(f"the ONNX form differs from the run's policy by {found:.1e}; it is not written")
        if (run / runs.CONFIG).is_file():
            scores = (run / TABLES).read_text(encoding="utf-8").strip() if (run / TABLES).is_file() else ""
            config = asdict(runs.read_config(run))
            text = card(folder.name, config, policy, env.unwrapped, scores or "None were measured.", found)
    with new_folder(folder) as made:
        shipped.write_policy(made, policy)
        write_bytes(made / shipped.ONNX, onnx_bytes)
        if text:
            write_text(made / shipped.CARD, text)
    return policy
