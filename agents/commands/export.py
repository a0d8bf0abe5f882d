"""Command that ships a trained policy as plain arrays and as ONNX, with a card: `solar-env export`."""

import re
from dataclasses import dataclass, replace
from pathlib import Path
from types import ModuleType
from typing import Annotated, Any

import gymnasium
import numpy as np
import tyro

from agents.comparison.report import read_rows, tabulate
from agents.environments import episode_seeds, make_env
from agents.laws.table import LAWS
from agents.learning import runs
from agents.policies import shipped
from agents.policies.card import card
from agents.policies.policy import ShippedPolicy
from agents.rollout import run_episode
from solar_env.support.files import check_name, new_folder, write_bytes, write_text
from solar_env.support.plain_arrays import read_json

TOLERANCE = 1e-5  # of actions, between the network and its ONNX form


@dataclass
class Args:
    """Write the best policy of a run to agents/policies as arrays and as ONNX, with a card."""

    run: Annotated[str | None, tyro.conf.Positional] = None
    """run folder"""
    name: str | None = None
    """name of the policy: letters, digits, dots, dashes and underscores"""
    scores: str | None = None
    """folder of a comparison (`solar-env evaluate`) in which the run, or the policy of this name, was measured, for the
    card; by default the run's own, or that of all seeds it was trained with"""


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
        ValueError: ONNX is not installed, the training was interrupted, the policy has layers that cannot be exported,
            or `comparison` has no scores of it.
    """
    onnx_form = _onnx_form()
    check_name(folder)
    if folder.exists():
        raise FileExistsError(f"{folder} exists; choose another --name, or remove it")
    run = Path(run)
    config = runs.read_config(run)
    if not runs.is_complete(run):
        raise ValueError(f"the training in {run} was interrupted; resume it, and export what comes of that")
    with make_env(config["env_id"], config["env_kwargs"]) as env:
        best = runs.load_policy(run, env)
        policy = ShippedPolicy(best.network, replace(best.description, training_steps=runs.steps_taken(run)))
        onnx_bytes = onnx_form.onnx_model(policy.network).SerializeToString()
        seed = episode_seeds("validation", config["seed"], 1)[0]
        found = onnx_form.difference(policy.network, onnx_bytes, observed(policy, env, seed))
        if not found <= TOLERANCE:
            raise ValueError(f"the ONNX form differs from the run's policy by {found:.1e}; it is not written")
        scores = _scores(run, folder.name, Path(comparison) if comparison else None)
        text = card(folder.name, config, policy, env.unwrapped, scores, found)
    with new_folder(folder) as made:
        shipped.save(made, policy)
        write_bytes(made / shipped.ONNX, onnx_bytes)
        write_text(made / shipped.CARD, text)
    return policy


def _onnx_form() -> ModuleType:
    try:
        from agents.policies import onnx_form
    except ImportError as error:
        raise ValueError("exporting needs ONNX and its runtime: pip install 'solar-env[onnx]'") from error
    return onnx_form


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


def run_command(args: Args) -> int:
    """Run the command; see `Args`."""
    if args.run is None or not re.fullmatch(r"\w[\w.-]*", args.name or ""):
        raise ValueError(
            f"run is {args.run!r}, name {args.name!r}; give both, the name of letters, digits, underscores, dots and "
            "hyphens: solar-env export runs/<run> --name NAME"
        )
    if args.name in LAWS:
        raise ValueError(f"name is {args.name!r}, which is that of a controller without learning; choose another one")
    folder = shipped.SHIPPED / str(args.name)
    export(args.run, folder, args.scores)
    print(f"written to {folder}")
    return 0
