"""Command that writes a policy in a form for other programs, or ships it: `solar-env export`."""

import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from types import ModuleType
from typing import Annotated, Any

import gymnasium
import numpy as np
import tyro

from agents.comparison.report import read_rows, tabulate
from agents.environments import environment_settings, episode_seeds, make_env
from agents.laws.table import LAWS
from agents.learning import runs
from agents.policies import shipped
from agents.policies.c_form import c_header, interface_comment
from agents.policies.card import card
from agents.policies.policy import ShippedPolicy
from agents.rollout import run_episode
from solar_env.support.files import check_target, copy_file, new_folder, write_bytes, write_text
from solar_env.support.plain_arrays import read_json

TOLERANCE = 1e-5  # of actions, between the network and its ONNX form


@dataclass
class Args:
    """Write a policy as arrays, ONNX or C, or as a folder with a card."""

    policy: Annotated[str, tyro.conf.Positional] = "cma-es-nominal"
    """run folder, or policy of the package, or folder that this command wrote"""
    out: Path = Path("policy.npz")
    """plain arrays, .npz, with their description beside them, .json; .onnx; one C header, .h; without a suffix a folder
    with all but the header, and a card, which is a policy of the package in agents/policies"""
    scores: Path | None = None
    """for the card, folder of a comparison (solar-env evaluate) in which the run, or a policy of the folder's name, was
    measured; by default the run's own, or that of all seeds it was trained with"""


def run_command(args: Args) -> int:
    """Run the command; see `Args`."""
    if args.out.suffix:
        check_target(args.out, tuple(FORMS))
        FORMS[args.out.suffix.lower()](named_policy(args.policy), args.out)
    else:
        export(args.policy, args.out, args.scores)
    print(f"written to {args.out}")
    return 0


def named_policy(name: str) -> ShippedPolicy:
    """Read the policy of a run, or one that was shipped."""
    return of_run(Path(name)) if (Path(name) / runs.CONFIG).is_file() else shipped.load_shipped(name)


def write_arrays(policy: ShippedPolicy, path: Path) -> None:
    """Write arrays, and their description beside them."""
    with TemporaryDirectory() as folder:
        made = Path(folder)
        shipped.save(made, policy)
        copy_file(made / shipped.ARRAYS, path)
        copy_file(made / shipped.DESCRIPTION, path.with_suffix(".json"))


def write_onnx(policy: ShippedPolicy, path: Path) -> None:
    """Write the network as ONNX."""
    write_bytes(path, onnx_form().onnx_model(policy.network).SerializeToString())


def write_header(policy: ShippedPolicy, path: Path) -> None:
    """Write one C header with arrays and the function NAME_action, for the computer of a drive."""
    description = policy.description
    drive = environment_settings(description.env_id, description.env_kwargs).drive
    write_text(path, c_header(policy.network, f"{path.stem}_action", interface_comment(description, drive)))


# Suffix -> what writes a policy to such a file.
FORMS: dict[str, Callable[[ShippedPolicy, Path], None]] = {
    ".npz": write_arrays,
    ".onnx": write_onnx,
    ".h": write_header,
}


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


def of_run(run: Path) -> ShippedPolicy:
    """Read the best policy of a run.

    Raises:
        FileNotFoundError: There is no run, or it has no policy.
        ValueError: The training was interrupted.
    """
    config = runs.read_config(run)
    if not runs.is_complete(run):
        raise ValueError(f"the training in {run} was interrupted; resume it, and export what comes of that")
    with make_env(config["env_id"], config["env_kwargs"]) as env:
        best = runs.load_policy(run, env)
    return ShippedPolicy(best.network, replace(best.description, training_steps=runs.steps_taken(run)))


def observed(policy: ShippedPolicy, env: gymnasium.Env, seed: int) -> np.ndarray:
    """Return what a policy observes in a deployment, and as many random observations: (2 periods, entries)."""
    seen: list[np.ndarray] = []
    run_episode(env, policy, seed, lambda step: seen.append(step.observation))
    space: Any = env.observation_space
    drawn = np.random.default_rng(0).uniform(space.low, space.high, (len(seen), *space.shape))
    return np.concatenate([np.array(seen), drawn]).astype(np.float32)


def export(run: str | Path, folder: Path, comparison: str | Path | None = None) -> ShippedPolicy:
    """Write the best policy of a run, its ONNX form and its card to `folder`, whole or not at all.

    `comparison` is the folder of one in which the run, or a policy named as `folder` is, was measured; by default the
    run's own, or that of all the seeds that it was trained with.

    Raises:
        FileExistsError: `folder` exists.
        OSError: It cannot be written.
        FileNotFoundError: There is no run, or it has no policy.
        ValueError: ONNX is not installed, the name is a law's, the training was interrupted, or `comparison` has no
            scores of it.
    """
    form = onnx_form()
    if folder.name in LAWS or not re.fullmatch(r"\w[\w-]*", folder.name):
        raise ValueError(
            f"the folder's name is {folder.name!r}, and the policy's; choose one of letters, digits, underscores and "
            f"hyphens that is no law's ({', '.join(LAWS)})"
        )
    if folder.exists():
        raise FileExistsError(f"{folder} exists; choose another --out, or remove it")
    run = Path(run)
    policy, config = of_run(run), runs.read_config(run)
    onnx_bytes = form.onnx_model(policy.network).SerializeToString()
    with make_env(config["env_id"], config["env_kwargs"]) as env:
        seed = episode_seeds("validation", config["seed"], 1)[0]
        found = form.difference(policy.network, onnx_bytes, observed(policy, env, seed))
        if not found <= TOLERANCE:
            raise ValueError(f"the ONNX form differs from the run's policy by {found:.1e}; it is not written")
        scores = _scores(run, folder.name, Path(comparison) if comparison else None)
        text = card(folder.name, config, policy, env.unwrapped, scores, found)
    with new_folder(folder) as made:
        shipped.save(made, policy)
        write_bytes(made / shipped.ONNX, onnx_bytes)
        write_text(made / shipped.CARD, text)
    return policy


def _scores(run: Path, name: str, comparison: Path | None) -> str:
    """Read the scores of a run, as `export` says, as a table with the baselines beside it."""
    if comparison is not None:
        folders = [comparison]
    else:  # training ends with a comparison of the run, or of all the seeds together, beside it
        folders = [folder for folder in (run, run.parent) if (folder / "episodes.csv").is_file()]

    def is_own(spec: str) -> bool:
        if comparison is None:
            return Path(spec).name == run.name
        return spec == name or Path(spec).resolve() == run.resolve()

    for folder in folders:
        rows = read_rows(folder / "episodes.csv")
        own = [row for row in rows if row["spec"] not in LAWS and is_own(row["spec"])]
        if own:
            command = _command(folder / "metrics.json")
            tables = tabulate([row for row in rows if row["spec"] in LAWS] + own).folded().strip()
            return f"`{own[0]['controller']}` is this policy. Measured by `{command}`.\n\n{tables}"
    if comparison is not None:
        found = ", ".join(dict.fromkeys(row["spec"] for row in rows))
        raise ValueError(f"{comparison} has no scores of {run}; it has those of {found}")
    return "None were measured."


def _command(path: Path) -> str:
    """Read the command that a comparison was made by."""
    try:
        return str(read_json(path)["settings"]["command"])
    except (KeyError, TypeError, IndexError) as error:
        raise ValueError(
            f"{path} is damaged: it does not say which command the comparison was made by; restore it, or compare anew "
            "(solar-env evaluate) and name that with --scores"
        ) from error
