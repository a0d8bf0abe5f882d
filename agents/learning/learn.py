"""Training PPO, SAC and TD3 through Stable-Baselines3, from a configuration to a run folder."""

import json
import math
import shutil
import time
from collections.abc import Mapping, Sequence
from contextlib import closing
from dataclasses import asdict, dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import torch
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.buffers import NStepReplayBuffer
from stable_baselines3.common.callbacks import CallbackList
from stable_baselines3.common.logger import configure
from stable_baselines3.common.noise import OrnsteinUhlenbeckActionNoise
from stable_baselines3.common.off_policy_algorithm import OffPolicyAlgorithm
from stable_baselines3.common.on_policy_algorithm import OnPolicyAlgorithm
from stable_baselines3.common.policies import ActorCriticPolicy
from stable_baselines3.common.utils import LinearSchedule
from stable_baselines3.common.vec_env import VecEnv, VecMonitor, VecNormalize
from tqdm import tqdm

from agents import runs
from agents.environments import EPISODES_PER_SEED, episode_seeds, make_env
from agents.learning.callbacks import DeploymentLogger, SaveCheckpoint, SavePolicy, Validation, save_checkpoint
from agents.learning.configurations import Configuration, stored_configuration
from agents.learning.features import DriveFeatures, Features, landing, whole_motion
from agents.learning.landings import Landing, LandingVecEnv, record
from agents.learning.optimizers import SlowedAdam, slow_actor
from agents.vec_env import FixedSeeds, LogarithmicCharges, NativeVecEnv, ResidualVecEnv
from solar_env.support.campaigns import Workers, each_done

VALIDATION_EPISODES = 24
VALIDATIONS = 5
SHORTEST_VALIDATION_INTERVAL = 2000  # environment steps; a validation takes about as many itself
CHARGE_SCALE = 0.5  # above what any soft landing costs; see `LogarithmicCharges`
NOISE_PERIODS = 100  # control periods over which the noise of TD3 is correlated


def make_training_env(
    config: Configuration, landings: Sequence[Landing], monitor: Path | None, threads: int | None = None
) -> VecEnv:
    """`n_envs` environments with `LogarithmicCharges`; `threads`: one a processor.

    Episodes begin with `landings` if there are any. Finished ones go to the CSV file `monitor`, with what they really
    cost.
    """
    made = config.n_envs, config.env_id, {**config.env_kwargs, "num_threads": threads}
    lanes = LandingVecEnv(*made, landings) if landings else NativeVecEnv(*made)
    monitored = VecMonitor(_with_law(lanes, config), str(monitor) if monitor else None)
    return LogarithmicCharges(monitored, CHARGE_SCALE)


def make_validation_env(config: Configuration, threads: int | None = None) -> VecNormalize:
    """An environment for every validation episode, the same ones at every reset, with unnormalised rewards."""
    first = episode_seeds("validation", config.seed, VALIDATION_EPISODES)[0]
    lanes = NativeVecEnv(VALIDATION_EPISODES, config.env_id, {**config.env_kwargs, "num_threads": threads})
    venv = VecMonitor(_with_law(FixedSeeds(lanes, first), config))
    return VecNormalize(venv, training=False, norm_obs=False, norm_reward=False)


def _with_law(venv: VecEnv, config: Configuration) -> VecEnv:
    return ResidualVecEnv(venv, config.residual) if config.residual else venv


def prepare(config: Configuration, threads: int | None = None) -> tuple[Features, list[Landing]]:
    """What the networks are to see, and what training episodes begin with: nothing but for agents that add to a law.

    These cost `config.landings` episodes of the law alone.

    Raises:
        ValueError: the law does not land the array.
    """
    if config.residual is not None:
        first = episode_seeds("training", config.seed, EPISODES_PER_SEED)[-(config.segments + 1) * config.landings]
        law = {**config.residual, "scale": 1.0}  # what is added is nothing, whatever the scale
        return _recorded(config.env_id, json.dumps(config.env_kwargs), json.dumps(law), config.landings, first, threads)
    with make_env(config.env_id, config.env_kwargs) as env:
        names = env.get_wrapper_attr("observation_names")
    return whole_motion(names), []


@lru_cache(maxsize=1)  # the trials of a search have the landings in common
def _recorded(
    env_id: str, env_kwargs: str, residual: str, landings: int, first: int, threads: int | None
) -> tuple[Features, list[Landing]]:
    """What `prepare` returns for agents that add to a law; the keywords and the law are JSON."""
    lanes = NativeVecEnv(landings, env_id, {**json.loads(env_kwargs), "num_threads": threads})
    with closing(ResidualVecEnv(FixedSeeds(lanes, first), json.loads(residual))) as venv:
        found, observations = record(venv)
        return landing(venv.get_attr("observation_names", 0)[0], observations), found


def make_model(config: Configuration, venv: VecEnv, features: Features, device: str = "cpu") -> BaseAlgorithm:
    """A fresh model on `venv` with normalised rewards, whose networks see `features`.

    An agent that adds to a law begins with nothing to add: the last layer of its actor is zero (T. Silver et al.,
    Residual Policy Learning, 2018, arXiv:1812.06298). That layer has no bias: where its features are zero, exploration
    noise is next to nothing, the least bias next to impossible, and the bias's gradient would bury all others.
    """
    hyperparameters = dict(config.hyperparameters)
    hyperparameters["policy_kwargs"] = {
        **hyperparameters.get("policy_kwargs", {}),
        "features_extractor_class": DriveFeatures,
        "features_extractor_kwargs": {"features": features},
    }
    actor_rate = hyperparameters.pop("actor_learning_rate", None)
    if actor_rate is not None:
        hyperparameters["policy_kwargs"]["optimizer_class"] = SlowedAdam
    noise = hyperparameters.pop("exploration_noise", None)
    if noise is not None:
        n_actions = venv.action_space.shape[0]  # type: ignore[index]
        # White noise would shake the latched array rather than explore: this one forgets as slowly as gSDE's does.
        forgetting = 1.0 / NOISE_PERIODS
        spread = np.full(n_actions, noise * math.sqrt(2.0 * forgetting))
        hyperparameters["action_noise"] = OrnsteinUhlenbeckActionNoise(np.zeros(n_actions), spread, forgetting, dt=1.0)
    gamma = hyperparameters.get("gamma", 0.99)
    normalized = VecNormalize(venv, norm_obs=False, gamma=gamma)
    seed = episode_seeds("training", config.seed, 1)[0]
    cls: Any = runs.algorithm(config.algo)
    # Returns scatter so much that steps of constant size would end in a random walk. The rate given is that of the
    # first update, which PPO makes at the end of the first rollout; after the last update it would be zero.
    rate, step = hyperparameters["learning_rate"], 0.0
    if issubclass(cls, OnPolicyAlgorithm):
        step = rate / math.ceil(config.timesteps / (config.n_envs * hyperparameters["n_steps"]))
    else:
        _use_n_step_returns(hyperparameters, gamma)
    hyperparameters["learning_rate"] = LinearSchedule(rate + step, step, 1.0)
    model = cls("MlpPolicy", normalized, seed=seed, device=device, **hyperparameters)
    if actor_rate is not None:
        slow_actor(model, actor_rate / rate if rate else 0.0)
    if config.residual:
        for layer in _actor_layers(model):
            torch.nn.init.zeros_(layer.weight)
            torch.nn.init.zeros_(layer.bias)
        _freeze_bias(model)
    return model


def _use_n_step_returns(hyperparameters: dict[str, Any], gamma: float) -> None:
    """Name the replay buffer that "n_steps" asks for: left to itself Stable-Baselines3 warns of it when it loads."""
    n_steps = hyperparameters.pop("n_steps", 1)
    if n_steps > 1:
        hyperparameters["replay_buffer_class"] = NStepReplayBuffer
        hyperparameters["replay_buffer_kwargs"] = {"n_steps": n_steps, "gamma": gamma}


def _actor_layers(model: BaseAlgorithm) -> list[torch.nn.Linear]:
    """The last layer of the actor, and that of its target where there is one."""
    policy: Any = model.policy
    actors = [policy.action_net] if isinstance(policy, ActorCriticPolicy) else [policy.actor.mu]
    if hasattr(policy, "actor_target"):
        actors.append(policy.actor_target.mu)
    return [[layer for layer in actor.modules() if isinstance(layer, torch.nn.Linear)][-1] for actor in actors]


def _freeze_bias(model: BaseAlgorithm) -> None:
    """Keep the bias of the actor's last layer as it is, which a saved model does not remember."""
    for layer in _actor_layers(model):
        layer.bias.requires_grad_(False)


def load_checkpoint(config: Configuration, folder: str | Path, venv: VecEnv, device: str = "cpu") -> BaseAlgorithm:
    """The model as the run in `folder` left it, with optimiser, step count, normalisation and replay buffer.

    Random number generators are not part of it: a resumed run gets new training episodes, and so does not
    repeat an uninterrupted one bit by bit. Load only runs you trust: the files are pickles.

    Raises:
        FileNotFoundError: the run left no checkpoint.
    """
    checkpoint = Path(folder) / runs.CHECKPOINT
    if not (checkpoint / "model.zip").is_file():
        raise FileNotFoundError(f"{folder} has no checkpoint to resume from; start a new run")
    normalized = VecNormalize.load(str(checkpoint / "vecnormalize.pkl"), venv)
    model = runs.algorithm(config.algo).load(checkpoint / "model.zip", env=normalized, device=device)
    if config.residual:
        _freeze_bias(model)
    if isinstance(model, OffPolicyAlgorithm):
        model.load_replay_buffer(checkpoint / "replay_buffer.pkl")
        _end_last_episodes(model)
    # One seed an environment and segment, all within the run's own training block.
    first = config.segments * config.n_envs
    model.set_random_seed(episode_seeds("training", config.seed, first + 1)[first])
    return model


def _end_last_episodes(model: OffPolicyAlgorithm) -> None:
    """Mark the last transitions as truncated: what is collected next begins new episodes, not the rest of these."""
    buffer: Any = model.replay_buffer
    last = buffer.pos - 1
    buffer.timeouts[last] = np.logical_or(buffer.timeouts[last], buffer.dones[last] == 0)


def train(
    config: Configuration,
    folder: Path,
    resume: str | Path | None = None,
    command: str = "",
    device: str = "cpu",
    progress: bool = True,
    threads: int | None = None,
) -> None:
    """Train and fill the run folder with policy, checkpoint, configuration and logs.

    Ctrl-C leaves a checkpoint before it ends the process.

    Args:
        config: What to train.
        folder: An existing run folder without a run.
        resume: Folder of the run to go on from.
        command: Command line to record.
        device: Torch device.
        progress: Show a progress bar.
        threads: Most threads that step environments; by default one a processor.
    """
    torch.set_num_threads(1)  # small networks: more threads only contend
    start = time.perf_counter()
    features, landings = prepare(config, threads)
    preparing = time.perf_counter() - start
    venv = make_training_env(config, landings, folder / "monitor.csv", threads)
    if resume:
        model = load_checkpoint(config, resume, venv, device)
    else:
        model = make_model(config, venv, features, device)
    before = model.num_timesteps
    record = {**asdict(config), "resumed_from": str(resume) if resume else None, "timesteps_before": before}
    runs.write_json(folder / runs.CONFIG, {**record, "command": command, "versions": runs.versions()})
    model.set_logger(configure(str(folder / "tensorboard"), ["tensorboard"]))

    interval = max(config.timesteps // VALIDATIONS, min(config.timesteps, SHORTEST_VALIDATION_INTERVAL))
    validation = Validation(
        make_validation_env(config, threads),
        callback_on_new_best=SavePolicy(folder),
        callback_after_eval=SaveCheckpoint(folder),
        n_eval_episodes=VALIDATION_EPISODES,
        eval_freq=max(interval // config.n_envs, 1),
        log_path=str(folder),
        verbose=0,
    )
    if resume and (Path(resume) / runs.POLICY).is_file():
        for name in (runs.POLICY, "evaluations.npz"):
            shutil.copy(Path(resume) / name, folder / name)
        validation.restore(folder / "evaluations.npz")
    try:
        model.learn(
            config.timesteps,
            callback=CallbackList([DeploymentLogger(), validation]),
            reset_num_timesteps=not resume,
            progress_bar=progress,
        )
    finally:
        save_checkpoint(model, folder)
        model.logger.close()
        validation.eval_env.close()
        venv.close()
    wall, stepping = time.perf_counter() - start, venv.unwrapped.stepping_time  # type: ignore[attr-defined]
    timing = {
        "wall_time_s": wall,
        "preparing_s": preparing,
        "stepping_s": stepping,
        "validation_s": validation.wall_time,
        "learning_s": wall - preparing - stepping - validation.wall_time,
    }
    runs.write_json(folder / runs.TIMING, timing)


@dataclass(frozen=True)
class Training:
    """One run of several: what to train, and where to."""

    config: Configuration
    folder: Path
    command: str
    device: str


def train_one(training: Training) -> None:
    """Train without a progress bar and with one thread: several of these run side by side."""
    train(
        training.config,
        training.folder,
        command=training.command,
        device=training.device,
        progress=False,
        threads=1,
    )


def train_missing(
    wanted: Mapping[Path, Configuration], command: str, device: str, workers: Workers, progress: bool = True
) -> None:
    """Train those runs that are not complete, side by side.

    Args:
        wanted: Run folder -> what is to be in it.
        command: Command line to record.
        device: Torch device.
        workers: Where.
        progress: Show a progress bar.

    Raises:
        ValueError: a run has another configuration.
    """
    for folder, config in wanted.items():
        if (folder / runs.CONFIG).is_file() and asdict(stored_configuration(folder)) != runs.jsonable(asdict(config)):
            raise ValueError(f"{folder} holds a run with another configuration; choose another --out")
    missing = [
        Training(config, folder, command, device) for folder, config in wanted.items() if not runs.is_complete(folder)
    ]
    for training in missing:
        runs.discard_incomplete(training.folder)
        runs.new_run_folder(training.folder, training.config.env_id, training.config.algo, training.config.seed)
    with tqdm(total=len(wanted), desc="train", unit="run", disable=not progress) as bar:
        bar.update(len(wanted) - len(missing))
        for _ in each_done(train_one, missing, workers):
            bar.update()
