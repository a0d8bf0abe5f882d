"""Command that trains a controller and compares it with the baselines: `solar-env train`, or `python train.py`.

It trains on flexible panels, or on the physics of `--model`, and leaves a run folder;
`tensorboard --logdir runs` shows the training, `solar-env evaluate --controllers passive runs/<run>`
compares runs.
"""

from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path

from agents.commands.arguments import ModelOptions
from agents.comparison.evaluation import evaluate
from agents.comparison.figures import learning_curve_figure
from agents.comparison.report import write_comparison
from agents.environments import DEFAULT_ENV_ID, INTERFACE, MODEL, RIGID, episode_seeds
from agents.learning import learn, runs
from solar_env.commands.arguments import Assignments, CommandRecord, WorkerOptions
from solar_env.support.interruption import keeping
from solar_env.support.progress import print_markdown

BASELINES = ("passive", "servo-untuned", "servo")
FIXED = ("algo", "seed", "env_id", "model", "env_kwargs", "n_envs", "hyperparams")
SHORT_TIMESTEPS = 130_000  # of a search on flexible panels, with its comparison within ten minutes on two cores


@dataclass
class Args(ModelOptions, WorkerOptions, CommandRecord):
    """Train a controller, and compare it with the baselines.

    The model is flexible-clearance, or rigid-clearance for PPO, SAC and TD3, which need more episodes, unless another
    is named. Where neither a model nor a number of steps is asked for, a search on flexible panels takes at most
    130,000 steps. With --resume algorithm, seed, environment and hyperparameters are those of the run to resume.
    """

    algo: str | None = None
    """algorithm: ars or cma-es, which search the weights of a linear policy; ppo, sac or td3; by default ars"""
    seed: int | None = None
    """seed of networks, exploration and training episodes, and chooses those of the comparison; by default 0"""
    timesteps: int | None = None
    """environment steps; by default the number in agents/configs"""
    hyperparams: Assignments = field(default_factory=dict)
    """hyperparameters in place of those in agents/configs, for example learning_rate=1e-3"""
    env_id: str | None = None
    """environment id; by default solar_env/Deploy-v1"""
    n_envs: int | None = None
    """environments stepped together; by default the number in agents/configs"""
    resume: str | None = None
    """run folder to go on from, with its algorithm, environment, seed and hyperparameters: to its end if it was
    interrupted, even before its first checkpoint, by as many steps again, or --timesteps, if it is complete"""
    out: str | None = None
    """run folder; by default runs/<id>__<algo>__<seed>__<timestamp>, or the folder of the run to resume if that was
    interrupted"""
    checkpoint_interval: int = learn.CHECKPOINT_INTERVAL
    """environment steps between checkpoints, the most that is lost; they are written between rollouts"""
    eval_episodes: int = 30
    """held-out episodes of the comparison with the baselines"""


def run_command(args: Args) -> int:
    """Run the command; see `Args`."""
    run(args)
    return 0


def run(args: Args) -> Path:
    """Train, compare, and return the run folder."""
    config = resumed(args, args.resume) if args.resume else configuration(args)
    args.workers  # noqa: B018 (checks them)
    if args.checkpoint_interval < 1:
        raise ValueError(f"--checkpoint-interval is {args.checkpoint_interval}; give a positive number of steps")
    episode_seeds("evaluation", config.seed, args.eval_episodes)
    if args.resume and args.out is None and not runs.is_complete(args.resume):
        folder = Path(args.resume)
    else:
        folder = runs.new_run_folder(args.out, config.env_id, config.algo, config.seed)
    print(f"{config.algo} on {config.env_id}, {config.timesteps} steps -> {folder}")
    training = learn.Training(
        config, folder, args.resume, args.command, progress=not args.quiet, checkpoint_interval=args.checkpoint_interval
    )
    try:
        learn.train(training)
    except BaseException:
        with suppress(OSError):  # a training that was refused leaves no folder, one that has begun has files in its
            folder.rmdir()
        raise
    with keeping(lambda: f"{folder} holds the trained run; solar-env evaluate --controllers {folder} compares it"):
        of_laws = {name: value for name, value in config.env_kwargs.items() if name not in INTERFACE}
        controllers = [*BASELINES, f"{config.algo}={folder}"]
        episodes = args.eval_episodes, config.seed, config.env_id, of_laws
        rows = evaluate(controllers, *episodes, not args.quiet, args.workers)
        settings = {"command": args.command, "eval_episodes": args.eval_episodes, "seed": config.seed}
        summary, tables = write_comparison(folder, rows, settings)
        learning_curve_figure(folder, {name: summary[name]["return"].mean for name in BASELINES})
    print_markdown(tables)
    print(f"written to {folder}")
    return folder


def configuration(args: Args) -> runs.Configuration:
    """Make the configuration that the arguments ask for."""
    env_id, algo = args.env_id or DEFAULT_ENV_ID, args.algo or "ars"
    searches = algo in runs.SEARCHES
    keywords = args.keywords(MODEL if searches else RIGID)
    config = runs.complete(algo, env_id, keywords, args.seed or 0, args.n_envs, args.timesteps, args.hyperparams)
    if not searches or args.timesteps is not None or args.model or args.env_kwargs.get("model"):
        return config
    return replace(config, timesteps=min(config.timesteps, SHORT_TIMESTEPS))


def resumed(args: Args, folder: str) -> runs.Configuration:
    """Read the configuration of the run to resume, and refuse options that it has fixed, by a ValueError."""
    for name in FIXED:
        given = getattr(args, name)
        if given not in (None, {}):
            raise ValueError(f"--{name.replace('_', '-')} {given}: --resume goes on with the run's; leave it out")
    config = runs.read_config(folder)
    return config if args.timesteps is None else replace(config, timesteps=args.timesteps)
