"""Command that trains a controller and compares it with torque laws: `solar-env train`, or `python train.py`."""

from dataclasses import dataclass, field
from pathlib import Path

from agents.commands.arguments import ModelOptions
from agents.comparison.evaluation import evaluate, fitting
from agents.comparison.figures import Panel, learning_curves_figure
from agents.comparison.report import write_comparison
from agents.environments import INTERFACE, episode_seeds
from agents.learning import runs
from agents.learning.training import ALGORITHMS, train
from solar_env.commands.arguments import Assignments, CommandRecord, WorkerOptions
from solar_env.environment.registration import DEPLOY
from solar_env.support.interruption import keeping
from solar_env.support.progress import print_markdown
from solar_env.support.versions import versions

LAWS = ("passive", "pd", "servo")
OF_A_RUN = {"--algo", "--seed", "--n-envs", "--hyperparams", "--env-id", "--model", "--env-kwargs", "--out"}
TIMESTEPS = 100_000


@dataclass
class Args(ModelOptions, WorkerOptions, CommandRecord):
    """Train a controller, and compare it with torque laws.

    Algorithms of Stable-Baselines3 have their default settings; cma-es searches for the weights of a policy.
    """

    algo: str = "ppo"
    """algorithm: ppo, sac, tqc, ars or cma-es"""
    timesteps: int | None = None
    """environment steps in all; by default 100,000, or the number of the run that --resume continues"""
    seed: int = 0
    """seed of networks, exploration, training episodes and evaluation episodes"""
    n_envs: int = 1
    """environments stepped together, in one process"""
    hyperparams: Assignments = field(default_factory=dict)
    """hyperparameters that replace the algorithm's defaults, for example learning_rate=1e-3"""
    env_id: str = DEPLOY
    """environment id"""
    resume: str | None = None
    """run folder to continue, with its algorithm, environment, seed
    and hyperparameters, up to --timesteps in all"""
    out: str | None = None
    """run folder; by default runs/<id>__<algo>__<seed>__<timestamp>"""
    eval_episodes: int = 20
    """held-out episodes of the comparison with the drive laws"""


def run_command(args: Args) -> int:
    """Train a policy, compare it with torque laws, and write a run folder: models, configuration, table and plot."""
    episode_seeds("evaluation", 0, args.eval_episodes)  # refuses a number out of range
    args.workers  # noqa: B018 (checks them)
    if args.resume:
        given = {word.partition("=")[0].replace("_", "-") for word in args.command.split()}
        for name in sorted(given & OF_A_RUN):
            raise ValueError(f"{name} beside --resume: a run keeps its own; leave it out")
        config, folder = runs.read_config(args.resume), Path(args.resume)
    else:
        config = configuration(args)
        folder = runs.new_run_folder(args.out, config)
    timesteps = config.timesteps if args.timesteps is None else args.timesteps
    shared = {name: value for name, value in config.env_kwargs.items() if name not in INTERFACE}
    laws = fitting(LAWS, config.env_id, shared)
    print(f"{config.algo} on {config.env_id}, {timesteps} steps -> {folder}")
    with keeping(lambda: f"solar-env train --resume {folder} goes on from the last validation"):
        train(config, folder, timesteps, progress=not args.quiet)
        episodes = args.eval_episodes, config.seed, config.env_id, shared
        rows = evaluate([*laws, f"{config.algo}={folder}"], *episodes, not args.quiet, args.workers)
    summary, tables = write_comparison(folder, rows, {"command": args.command, "eval_episodes": args.eval_episodes})
    history = runs.read_evaluations(folder)
    curve = history["timesteps"], history["results"].mean(axis=1)
    panel = Panel({config.algo: [curve]}, {name: summary[name]["return"].mean for name in laws})
    learning_curves_figure({config.env_id: panel}, folder / "figure.png", ("environment steps",))
    print_markdown(tables)
    print(f"written to {folder}")
    return 0


def configuration(args: Args) -> runs.Configuration:
    """Return the run's settings; PPO's n_steps defaults to min(2048, timesteps) / n_envs, rounded down, at least 2."""
    if args.algo not in ALGORITHMS:
        raise ValueError(f"no algorithm {args.algo!r}; available: {', '.join(ALGORITHMS)}")
    timesteps = TIMESTEPS if args.timesteps is None else args.timesteps
    usual = {"n_steps": max(min(2048, timesteps) // max(args.n_envs, 1), 2)} if args.algo == "ppo" else {}
    asked = args.algo, args.env_id, args.keywords(), args.seed, args.n_envs, timesteps, usual | args.hyperparams
    return runs.Configuration(*asked, args.command, versions(*runs.LIBRARIES))
