"""Training with Stable-Baselines3: an algorithm by name with its defaults, regular validation, and saved models."""

import io
import json
import zipfile
from contextlib import closing
from dataclasses import asdict
from pathlib import Path
from typing import Any

import torch
from sb3_contrib import ARS, TQC
from stable_baselines3 import PPO, SAC
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.callbacks import BaseCallback, EvalCallback
from stable_baselines3.common.vec_env import VecEnv, VecMonitor

from agents.environments import episode_seeds
from agents.learning import runs
from agents.learning.weight_search import CMAES
from solar_env.environment.stable_baselines3 import NativeVecEnv
from solar_env.support.files import make_folder, write_bytes

ALGORITHMS: dict[str, Any] = {"ppo": PPO, "sac": SAC, "tqc": TQC, "ars": ARS, "cma-es": CMAES}
VALIDATIONS, EPISODES = 15, 8


class Keep(BaseCallback):
    """Callback that writes the model to a file whenever another callback calls it."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self._path = path

    def _on_step(self) -> bool:
        file = io.BytesIO()  # save to memory first, so that the file is never incomplete
        self.model.save(file)
        write_bytes(self._path, file.getvalue())
        return True


def make_model(config: runs.Configuration, env: VecEnv, **keywords: Any) -> BaseAlgorithm:
    """Make an untrained model; raise a ValueError with the reason if the algorithm refuses its hyperparameters."""
    seed = episode_seeds("training", config.seed, 1)[0]
    try:
        given = {"seed": seed, "device": "cpu", **keywords, **config.hyperparameters}
        return ALGORITHMS[config.algo]("MlpPolicy", env, **given)
    except Exception as error:  # the libraries may raise anything for unexpected values
        reason = " ".join(str(error).split())[:300] or type(error).__name__
        raise ValueError(f"{config.algo} refuses {config.hyperparameters} ({reason}); change --hyperparams") from error


def train(config: runs.Configuration, folder: Path, timesteps: int, progress: bool = True) -> None:
    """Train until `timesteps` environment steps in all; a run in `folder` continues from its last validation.

    The folder is made only after the algorithm has accepted its hyperparameters.
    """
    torch.set_num_threads(1)  # small networks: more threads only contend
    first = episode_seeds("validation", config.seed, 1)[0]
    env = VecMonitor(NativeVecEnv(config.n_envs, config.env_id, config.env_kwargs))
    judged = VecMonitor(NativeVecEnv(EPISODES, config.env_id, config.env_kwargs, first))
    with closing(env), closing(judged):
        model = make_model(config, env, tensorboard_log=str(folder))
        if not (folder / runs.CONFIG).is_file():
            make_folder(folder)
            runs.write_json(folder / runs.CONFIG, asdict(config))
        every = max(timesteps // (VALIDATIONS * config.n_envs), 1)
        keep = Keep(folder / runs.BEST), Keep(folder / runs.LAST)
        validation = EvalCallback(judged, *keep, EPISODES, every, str(folder), verbose=0)
        done = go_on(model, validation, folder) if (folder / runs.LAST).is_file() else 0
        model.learn(max(timesteps - done, 0), validation, reset_num_timesteps=not done, progress_bar=progress)


def go_on(model: BaseAlgorithm, validation: EvalCallback, folder: Path) -> int:
    """Restore `model` and `validation` from a run's last validation, with an empty replay buffer; return steps done."""
    model.set_parameters(str(folder / runs.LAST), device="cpu")
    with zipfile.ZipFile(folder / runs.LAST) as file:
        model.num_timesteps = json.loads(file.read("data"))["num_timesteps"]
    history = runs.read_evaluations(folder)
    validation.evaluations_timesteps = history["timesteps"].tolist()
    validation.evaluations_results = history["results"].tolist()
    validation.evaluations_length = history["ep_lengths"].tolist()
    validation.best_mean_reward = history["results"].mean(axis=1).max()
    return model.num_timesteps
