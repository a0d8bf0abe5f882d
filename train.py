"""Train a controller that deploys the solar array softly, and compare it with the baselines.

``python train.py`` trains on flexible panels, or on the physics of ``--model``, and leaves a run folder;
``tensorboard --logdir runs`` shows the training, ``python -m agents.evaluate --controllers passive runs/<run>``
compares runs.
"""

import shlex
import sys
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from agents import runs
from agents.arguments import parse_arguments, run_command
from agents.comparison.figures import run_figure
from agents.comparison.report import Summary, Tables, write_comparison
from agents.comparison.suites import WHOLE_TORQUE_MODEL
from agents.environments import DEFAULT_ENV_ID, check_seeds, episode_seeds, make_env, with_model
from agents.evaluate import efforts, evaluate
from agents.laws.baselines import make_baseline
from agents.learning import configurations, learn
from agents.rollout import Step, run_episode
from solar_env.array import DEFAULT_ELEMENTS
from solar_env.support.campaigns import Workers

BASELINES = ("passive", "servo-untuned", "servo")
# The cheapest model from which agents that beat the servo transfer to six elements, see `agents.transfer`, and as many
# steps on it as leave a training with its comparison within ten minutes on two cores.
MODEL = {"model": "flexible-clearance", "elements": 2}
TIMESTEPS = 86_400


@dataclass
class Args:
    """Train a controller that deploys the solar array softly, and compare it with the baselines."""

    algo: str | None = None
    """algorithm: ppo, sac or td3; None: ppo, or that of the run to resume"""
    timesteps: int | None = None
    """environment steps to train for; None: at most 86,400, or the number in agents/configs for a model that was named
    and for the whole torque, or as many as the run to resume was given"""
    seed: int | None = None
    """seed of networks, exploration and training episodes, and chooses those of the comparison; None: 0, or that of the
    run to resume; beside --seeds it chooses the comparison's alone"""
    seeds: list[int] = field(default_factory=list)
    """train a run for each of these seeds, side by side, and compare them with the baselines as one controller; runs
    that are complete are not trained again"""
    jobs: int | None = None
    """processes, for several seeds and for the comparison; None: one a processor"""
    cluster: str | None = None
    """ray: several seeds and the comparison on the Ray cluster that this machine belongs to"""
    env_id: str | None = None
    """environment id; None: solar_env/Deploy-v0, or that of the run to resume"""
    model: str | None = None
    """rigid-ideal, rigid-clearance, flexible-ideal, flexible-clearance, or auto (see the environment); None:
    flexible-clearance with 2 elements, or rigid-clearance for the whole torque"""
    elements: int | None = None
    """beam elements of each flexible panel (rigid ones have none); None: 2, or 6 for a model that was named"""
    env_kwargs: dict[str, Any] = field(default_factory=dict)
    """environment keywords, for example torque_limit=0.3 observation=privileged"""
    hyperparams: dict[str, Any] = field(default_factory=dict)
    """hyperparameters in place of those in agents/configs, for example learning_rate=1e-3"""
    n_envs: int | None = None
    """environments stepped together; None: the number in agents/configs, or that of the run to resume"""
    residual: float | None = None
    """the agent adds up to this share of the torque limit to the torque of a tuned law; 0: it commands the whole
    torque; None: as in agents/configs"""
    law: str | None = None
    """that law: servo, soft-start, or another that agents.tune tunes; None: servo, or that of the run to resume"""
    landings: int | None = None
    """episodes of the law alone with whose landings training begins; None: the number in agents/configs"""
    resume: str | None = None
    """run folder to go on from, with its algorithm, environment, seed, hyperparameters, residual and landings"""
    out: str | None = None
    """run folder; None: runs/<id>__<algo>__<seed>__<timestamp>"""
    eval_episodes: int = 30
    """held-out episodes of the comparison with the baselines"""
    device: str = "cpu"
    """torch device; for networks this small the CPU is faster"""
    quiet: bool = False
    """no progress bars"""


def main(args: Args, command: str) -> Path:
    """Train, compare, and return the run folder."""
    if args.seeds:
        return train_seeds(args, command)
    if args.resume:
        config = configurations.resumed_configuration(args.resume, args.timesteps)
        check_resumable(args, config)
    else:
        config = configuration(args, args.seed or 0)
    check_comparison(args, config.seed)
    folder = runs.new_run_folder(args.out, config.env_id, config.algo, config.seed)
    print(f"{config.algo} on {config.env_id}, {config.timesteps} steps -> {folder}")
    learn.train(config, folder, args.resume, command, args.device, progress=not args.quiet)

    summary, tables = compare(args, config, [folder], folder, command)
    draw(folder, config, {name: entry["return"].mean for name, entry in summary.items()})
    print(tables)
    print(f"written to {folder}")
    return folder


def configuration(args: Args, seed: int) -> configurations.Configuration:
    """What the arguments ask to train, with a seed."""
    env_id = args.env_id or DEFAULT_ENV_ID
    whole = args.residual == 0.0
    named = args.model or args.env_kwargs.get("model")
    config = configurations.configuration(
        args.algo or "ppo",
        env_id,
        with_model(args.env_kwargs, args.model, args.elements, env_id, WHOLE_TORQUE_MODEL if whole else MODEL),
        seed,
        args.n_envs,
        args.timesteps,
        args.hyperparams,
        args.residual,
        args.landings,
        args.law,
    )
    quick = args.timesteps is None and not (named or whole)
    return replace(config, timesteps=min(config.timesteps, TIMESTEPS)) if quick else config


def train_seeds(args: Args, command: str) -> Path:
    """Train a run for every seed that has none yet, compare them together, and return the folder of all runs.

    Raises:
        ValueError: a run was to be resumed, a seed is given twice, or there is no folder to come back to.
    """
    if args.resume or args.out is None:
        raise ValueError("--seeds takes --out, the folder of their runs, and does not go with --resume")
    check_seeds(args.seeds)
    check_comparison(args, args.seed or 0)
    out = Path(args.out)
    wanted = {out / f"seed-{seed}": configuration(args, seed) for seed in args.seeds}
    learn.train_missing(wanted, command, args.device, Workers(args.jobs, args.cluster), not args.quiet)
    _, tables = compare(args, wanted[out / f"seed-{args.seeds[-1]}"], list(wanted), out, command)
    print(tables)
    print(f"written to {out}")
    return out


def check_comparison(args: Args, seed: int) -> None:
    """Refuse now what the comparison would refuse once everything is trained.

    Raises:
        ValueError: the number of episodes or processes, the cluster or the seed is out of range.
    """
    Workers(args.jobs, args.cluster)
    episode_seeds("evaluation", seed, args.eval_episodes)


def references(config: configurations.Configuration) -> list[str]:
    """What a run is compared with: the baselines, and the law that it adds to if that is none of them."""
    law = [config.residual["law"]] if config.residual else []
    return list(dict.fromkeys([*BASELINES, *law]))


def compare(
    args: Args, config: configurations.Configuration, folders: Sequence[Path], out: Path, command: str
) -> tuple[Summary, Tables]:
    """Compare runs, as training seeds of one controller, with the baselines; for the rest see `write_comparison`."""
    seed = args.seed or 0 if args.seeds else config.seed
    controllers = [*references(config), *(f"{config.algo}={folder}" for folder in folders)]
    rows = evaluate(
        controllers,
        args.eval_episodes,
        seed,
        config.env_id,
        config.env_kwargs,
        not args.quiet,
        Workers(args.jobs, args.cluster),
    )
    settings = {"command": command, "eval_episodes": args.eval_episodes, "seed": seed}
    return write_comparison(out, rows, settings, efforts(controllers, config.env_id, config.env_kwargs))


def check_resumable(args: Args, config: configurations.Configuration) -> None:
    """Refuse arguments that contradict the run to resume.

    Raises:
        ValueError: an argument was given that the resumed run has fixed.
    """
    fixed_values = {
        **vars(config),
        "hyperparams": config.hyperparameters,
        "model": config.env_kwargs.get("model", "rigid-clearance"),
        "elements": config.env_kwargs.get("elements", DEFAULT_ELEMENTS),
        "residual": config.residual["scale"] if config.residual else 0.0,
        "law": config.residual["law"] if config.residual else None,
    }
    learning = ("algo", "seed", "hyperparams", "n_envs", "residual", "law", "landings")
    for name in ("env_id", "model", "elements", "env_kwargs", *learning):
        given, fixed = getattr(args, name), fixed_values[name]
        if isinstance(given, dict):
            agrees = all(fixed.get(key) == value for key, value in runs.jsonable(given).items())
        else:
            agrees = given is None or given == fixed
        if not agrees:
            raise ValueError(
                f"--{name.replace('_', '-')} {given} contradicts the run to resume, which has {fixed}; leave it out"
            )


def draw(folder: Path, config: configurations.Configuration, returns: dict[str, float]) -> None:
    """Draw the run's figure: the learning curve, and one evaluation episode, learned and passive."""
    env = make_env(config.env_id, config.env_kwargs)
    seed = episode_seeds("evaluation", config.seed, 1)[0]
    episodes: dict[str, list[Step]] = {config.algo: [], "passive": []}
    run_episode(env, runs.load_policy(folder, env), seed, episodes[config.algo].append)
    run_episode(env, make_baseline("passive", env), seed, episodes["passive"].append)
    levels = {name: returns[name] for name in references(config)}
    signals: Any = env.unwrapped
    run_figure(folder, levels, episodes, signals.observation_names, signals.task.torque_limit)


if __name__ == "__main__":
    run_command(lambda: main(parse_arguments(Args), shlex.join(["python", *sys.argv])))
