"""Command that trains a controller and compares it with laws: `solar-env train`, or `python train.py`."""

import io
import json
import zipfile
from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import torch
from sb3_contrib import ARS, TQC
from stable_baselines3 import PPO, SAC, TD3
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.callbacks import BaseCallback, EvalCallback
from stable_baselines3.common.vec_env import VecEnv, VecMonitor

from agents.commands.arguments import ModelOptions
from agents.comparison.evaluation import evaluate
from agents.comparison.figures import learning_curve_figure
from agents.comparison.report import write_comparison
from agents.environments import episode_seeds
from agents.learning import runs
from agents.learning.vec_env import FixedSeeds, NativeVecEnv
from agents.learning.weight_search import CMAES
from solar_env.commands.arguments import Assignments, CommandRecord, WorkerOptions
from solar_env.environment.registration import DEPLOY
from solar_env.support.files import write_bytes
from solar_env.support.interruption import keeping
from solar_env.support.progress import print_markdown
from solar_env.support.versions import versions

ALGORITHMS: dict[str, Any] = {"ppo": PPO, "sac": SAC, "td3": TD3, "tqc": TQC, "ars": ARS, "cma-es": CMAES}
LAWS = ("passive", "pd", "servo")
VALIDATIONS, EPISODES = 15, 8


@dataclass
class Args(ModelOptions, WorkerOptions, CommandRecord):
    """Train a controller, and compare it with laws.

    The algorithms are those of Stable-Baselines3 with their defaults, and a search over weights.
    """

    algo: str = "ppo"
    """algorithm: ppo, sac, td3, tqc, ars or cma-es"""
    timesteps: int = 100_000
    """environment steps in all"""
    seed: int = 0
    """seed of networks, exploration and training episodes, and chooses those of the comparison"""
    n_envs: int = 1
    """environments stepped together, in one process"""
    hyperparams: Assignments = field(default_factory=dict)
    """hyperparameters in place of the algorithm's defaults, for example learning_rate=1e-3"""
    env_id: str = DEPLOY
    """environment id"""
    resume: str | None = None
    """run folder to go on in, with its algorithm, environment, seed and hyperparameters, to --timesteps in all"""
    out: str | None = None
    """run folder; by default runs/<id>__<algo>__<seed>__<timestamp>"""
    eval_episodes: int = 20
    """held-out episodes of the comparison with the laws"""


class Keep(BaseCallback):
    """Writes the model to a file whenever another callback calls this one."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self._path = path

    def _on_step(self) -> bool:
        file = io.BytesIO()  # written to memory first: the model is there whole or not at all
        self.model.save(file)
        write_bytes(self._path, file.getvalue())
        return True


def run_command(args: Args) -> int:
    """Train, compare, and leave a run folder: models, configuration, table and figure."""
    episode_seeds("evaluation", 0, args.eval_episodes)  # refuses a number without any
    args.workers  # noqa: B018 (checks them)
    config, folder = begin(args)
    print(f"{config.algo} on {config.env_id}, {args.timesteps} steps -> {folder}")
    with keeping(lambda: f"solar-env train --resume {folder} goes on from the last validation"):
        train(config, folder, args.timesteps, progress=not args.quiet)
        episodes = args.eval_episodes, config.seed, config.env_id, config.env_kwargs
        rows = evaluate([*LAWS, f"{config.algo}={folder}"], *episodes, not args.quiet, args.workers)
    summary, tables = write_comparison(folder, rows, {"command": args.command, "eval_episodes": args.eval_episodes})
    learning_curve_figure(folder, {name: summary[name]["return"].mean for name in LAWS})
    print_markdown(tables)
    print(f"written to {folder}")
    return 0


def begin(args: Args) -> tuple[runs.Configuration, Path]:
    """The run that the arguments ask for, and its folder; a training that is refused leaves none."""
    if args.resume:
        return runs.read_config(args.resume), Path(args.resume)
    config = configuration(args)
    with closing(NativeVecEnv(config.n_envs, config.env_id, config.env_kwargs)) as env:
        make_model(config, env)
    return config, runs.new_run_folder(args.out, config)


def configuration(args: Args) -> runs.Configuration:
    """The settings of the run; rollouts of PPO are as long in all as those of one environment."""
    if args.algo not in ALGORITHMS:
        raise ValueError(f"no algorithm {args.algo!r}; available: {', '.join(ALGORITHMS)}")
    usual = {"n_steps": max(2048 // max(args.n_envs, 1), 1)} if args.algo == "ppo" else {}
    asked = args.algo, args.env_id, args.keywords(), args.seed, args.n_envs, args.timesteps, usual | args.hyperparams
    return runs.Configuration(*asked, args.command, versions(*runs.LIBRARIES))


def make_model(config: runs.Configuration, env: VecEnv, **keywords: Any) -> BaseAlgorithm:
    """A fresh model; a ValueError says where the algorithm refuses its hyperparameters."""
    seed = episode_seeds("training", config.seed, 1)[0]
    try:
        given = {"seed": seed, "device": "cpu", **keywords, **config.hyperparameters}
        return ALGORITHMS[config.algo]("MlpPolicy", env, **given)
    except Exception as error:  # of values that nobody has thought of the libraries may raise anything
        reason = " ".join(str(error).split())[:300] or type(error).__name__
        raise ValueError(f"{config.algo} refuses {config.hyperparameters} ({reason}); change --hyperparams") from error


def train(config: runs.Configuration, folder: Path, timesteps: int, progress: bool = True) -> None:
    """Train to a number of steps in all, from the last validation of the folder where there is one."""
    torch.set_num_threads(1)  # small networks: more threads only contend
    first = episode_seeds("validation", config.seed, 1)[0]
    env = VecMonitor(NativeVecEnv(config.n_envs, config.env_id, config.env_kwargs))
    judged = VecMonitor(FixedSeeds(NativeVecEnv(EPISODES, config.env_id, config.env_kwargs), first))
    with closing(env), closing(judged):
        model = make_model(config, env, tensorboard_log=str(folder))
        every = max(timesteps // (VALIDATIONS * config.n_envs), 1)
        keep = Keep(folder / runs.BEST), Keep(folder / runs.LAST)
        validation = EvalCallback(judged, *keep, EPISODES, every, str(folder), verbose=0)
        done = go_on(model, validation, folder) if (folder / runs.LAST).is_file() else 0
        model.learn(max(timesteps - done, 0), validation, reset_num_timesteps=not done, progress_bar=progress)


def go_on(model: BaseAlgorithm, validation: EvalCallback, folder: Path) -> int:
    """Take over what a run's last validation has left; return the steps until then. A replay buffer begins anew."""
    model.set_parameters(str(folder / runs.LAST), device="cpu")
    with zipfile.ZipFile(folder / runs.LAST) as file:
        model.num_timesteps = json.loads(file.read("data"))["num_timesteps"]
    history = runs.read_evaluations(folder)
    validation.evaluations_timesteps = history["timesteps"].tolist()
    validation.evaluations_results = history["results"].tolist()
    validation.evaluations_length = history["ep_lengths"].tolist()
    validation.best_mean_reward = history["results"].mean(axis=1).max()
    return model.num_timesteps
