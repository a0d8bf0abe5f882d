"""Command that trains a controller and compares it with the baselines: `solar-env train`, or `python train.py`.

It trains on flexible panels, or on the physics of `--model`, and leaves a run folder;
`tensorboard --logdir runs` shows the training, `solar-env evaluate --controllers passive runs/<run>`
compares runs.
"""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from agents.commands.arguments import ModelOptions
from agents.comparison.evaluation import efforts, evaluate
from agents.comparison.figures import run_figure
from agents.comparison.report import Summary, Tables, write_comparison
from agents.comparison.suites import MODEL, RIGID
from agents.environments import DEFAULT_ENV_ID, INTERFACE, check_episode_seeds, episode_seeds, make_env
from agents.laws.baselines import make_baseline
from agents.learning import configurations, learn, runs
from agents.rollout import Step, run_episode
from solar_env.commands.arguments import Assignments, CommandRecord, WorkerOptions
from solar_env.support.interruption import keeping
from solar_env.support.terminal import print_markdown

BASELINES = ("passive", "servo-untuned", "servo")
FIXED = ("algo", "seed", "env_id", "model", "env_kwargs", "n_envs", "hyperparams")
SQUASHING = ("sac", "td3")  # whose actions are no linear function of what a linear policy observes
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
    """seed of networks, exploration and training episodes, and chooses those of the comparison; by default 0; beside
    --seeds it chooses the comparison's alone"""
    seeds: list[int] = field(default_factory=list)
    """train a run for each of these seeds, side by side, and compare them with the baselines as one controller; runs
    that are complete are not trained again"""
    timesteps: int | None = None
    """environment steps of every run; by default the number in agents/configs"""
    hyperparams: Assignments = field(default_factory=dict)
    """hyperparameters in place of those in agents/configs, for example learning_rate=1e-3"""
    env_id: str | None = None
    """environment id; by default solar_env/Deploy-v1"""
    n_envs: int | None = None
    """environments stepped together; by default the number in agents/configs"""
    start: str | None = None
    """run of cma-es or ars, on whatever model, whose policy a linear one of cma-es, ars or ppo begins with; with
    --seeds a folder of such runs, each of which is gone on with by its own seed"""
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
    if args.start and (args.resume or "first_weights" in args.hyperparams):
        raise ValueError("--start says what training begins with; it goes with neither --resume nor first_weights")
    if args.start and args.algo in SQUASHING:
        raise ValueError(
            f"--start begins with the weights of a linear policy, and {args.algo} acts with the hyperbolic tangent of "
            "what it computes; choose cma-es, ars or ppo"
        )
    if args.seeds:
        return train_seeds(args)
    if args.resume:
        refuse_fixed(args)
        config = runs.stored_configuration(args.resume)
        if args.timesteps is not None:
            config = replace(config, timesteps=args.timesteps)
    else:
        config = configuration(args, args.seed or 0)
    check_comparison(args, config.seed)
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
        summary, tables = compare(args, config, [folder], folder)
        draw(folder, config, {name: entry["return"].mean for name, entry in summary.items()})
    print_markdown(str(tables))
    print(f"written to {folder}")
    return folder


def configuration(args: Args, seed: int) -> configurations.Configuration:
    """Make the configuration that the arguments ask for, with a seed."""
    env_id = args.env_id or DEFAULT_ENV_ID
    algo = args.algo or "ars"
    searches = algo in runs.SEARCHES
    keywords = args.keywords(MODEL if searches else RIGID)
    config = configurations.complete(algo, env_id, keywords, seed, args.n_envs, args.timesteps, args.hyperparams)
    if args.start:
        begun = Path(args.start) / seed_folder(seed) if args.seeds else Path(args.start)
        with make_env(env_id, config.env_kwargs) as env:
            weights = runs.linear_weights(begun, env)
        asked = {**args.hyperparams, configurations.FIRST_WEIGHTS: weights}
        config = configurations.complete(algo, env_id, keywords, seed, args.n_envs, args.timesteps, asked)
    if not searches or args.timesteps is not None or args.model or args.env_kwargs.get("model"):
        return config
    return replace(config, timesteps=min(config.timesteps, SHORT_TIMESTEPS))


def train_seeds(args: Args) -> Path:
    """Train a run for every seed that has none yet, compare them together, and return the folder of all runs.

    Raises:
        ValueError: A run was to be resumed, a seed is given twice, or there is no folder to come back to.
    """
    if args.resume or args.out is None:
        raise ValueError("--seeds takes --out, the folder of their runs, and does not go with --resume")
    for seed in args.seeds:
        if (times := args.seeds.count(seed)) > 1:  # its run would count as two
            raise ValueError(f"seed {seed} is given {times} times; give it once")
    check_comparison(args, args.seed or 0)
    out = Path(args.out)
    wanted = {out / seed_folder(seed): configuration(args, seed) for seed in args.seeds}
    learn.train_missing(wanted, args.command, "cpu", args.workers, not args.quiet, args.checkpoint_interval)
    with keeping(lambda: f"the trainings are complete in {out}; the same command compares them"):
        _, tables = compare(args, wanted[out / seed_folder(args.seeds[-1])], list(wanted), out)
    print_markdown(str(tables))
    print(f"written to {out}")
    return out


def seed_folder(seed: int) -> str:
    """Name of the folder of a run of several."""
    return f"seed-{seed}"


def check_comparison(args: Args, seed: int) -> None:
    """Refuse settings of the comparison, by a ValueError, before anything is trained."""
    args.workers  # noqa: B018 (checks them)
    if args.checkpoint_interval < 1:
        raise ValueError(f"--checkpoint-interval is {args.checkpoint_interval}; give a positive number of steps")
    check_episode_seeds(seed, args.eval_episodes)


def compare(
    args: Args, config: configurations.Configuration, folders: Sequence[Path], out: Path
) -> tuple[Summary, Tables]:
    """Compare runs, as training seeds of one controller, with the baselines; for the rest see `write_comparison`."""
    seed = args.seed or 0 if args.seeds else config.seed
    controllers = [*BASELINES, *(f"{config.algo}={folder}" for folder in folders)]
    env_id, env_kwargs = config.env_id, _of_laws(config)
    rows = evaluate(controllers, args.eval_episodes, seed, env_id, env_kwargs, not args.quiet, args.workers)
    settings = {"command": args.command, "eval_episodes": args.eval_episodes, "seed": seed}
    return write_comparison(out, rows, settings, efforts(controllers, config.env_id, config.env_kwargs))


def _of_laws(config: configurations.Configuration) -> dict[str, Any]:
    """Environment keywords without what the agent alone observes and does."""
    return {name: value for name, value in config.env_kwargs.items() if name not in INTERFACE}


def refuse_fixed(args: Args) -> None:
    """Refuse, by a ValueError, options that a run to resume has fixed."""
    for name in FIXED:
        given = getattr(args, name)
        if given not in (None, {}):
            raise ValueError(f"--{name.replace('_', '-')} {given}: --resume goes on with the run's own; leave it out")


def draw(folder: Path, config: configurations.Configuration, returns: dict[str, float]) -> None:
    """Draw the run's figure: the learning curve, and one evaluation episode, learned and passive."""
    env, of_laws = (make_env(config.env_id, keywords) for keywords in (config.env_kwargs, _of_laws(config)))
    seed = episode_seeds("evaluation", config.seed, 1)[0]
    episodes: dict[str, list[Step]] = {config.algo: [], "passive": []}
    run_episode(env, runs.load_policy(folder, env), seed, episodes[config.algo].append)
    run_episode(of_laws, make_baseline("passive", of_laws), seed, episodes["passive"].append)
    run_figure(folder, {name: returns[name] for name in BASELINES}, episodes)
