"""Other libraries take the environments as they are: `pytest -m interoperability`, each where it is installed."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import gymnasium
import numpy as np
import pytest

import solar_env  # noqa: F401 (registers the environments)
from agents.environments import make_env
from agents.learning import runs
from solar_env.environment.registration import DEPLOY

ROOT = Path(__file__).resolve().parents[2]
ZOO = ROOT / "agents" / "configs" / "rl-zoo3" / "ppo.yml"
SHORT = {"model": "rigid-ideal", "deadline": 13.0, "settling_window": 0.5}


def test_a_loop_in_the_style_of_cleanrl_learns_from_the_vector_environment():
    """One update of a policy's gradient on 8 arrays, landings and automatic resets included."""
    import torch

    envs = gymnasium.make_vec(DEPLOY, num_envs=8, model="rigid-ideal")
    torch.manual_seed(0)
    actor = torch.nn.Linear(int(np.prod(envs.single_observation_space.shape)), 1)
    optimizer = torch.optim.Adam(actor.parameters(), lr=1e-2)
    observations, _ = envs.reset(seed=0)
    logs, rewards = [], []
    for _ in range(80):
        distribution = torch.distributions.Normal(actor(torch.as_tensor(observations)), 0.3)
        actions = distribution.sample()
        observations, reward, _, _, _ = envs.step(actions.clamp(-1.0, 1.0).numpy())
        logs.append(distribution.log_prob(actions).sum(dim=1))
        rewards.append(torch.as_tensor(reward, dtype=torch.float32))
    before = actor.weight.detach().clone()
    to_go = torch.stack(rewards).flip(0).cumsum(0).flip(0)
    loss = -(torch.stack(logs) * (to_go - to_go.mean(dim=1, keepdim=True))).mean()
    loss.backward()
    optimizer.step()
    assert torch.isfinite(loss)
    assert not torch.equal(actor.weight, before)


@pytest.mark.interoperability
def test_the_single_file_of_cleanrl_trains(tmp_path):
    """Its version 1.2 is older than Gymnasium 1.0, whose TransformObservation asks for a space besides."""
    package = pytest.importorskip("cleanrl")
    source = (Path(package.__path__[0]) / "ppo_continuous_action.py").read_text()
    clip = "lambda obs: np.clip(obs, -10, 10)"
    assert source.count(clip) == 1
    (tmp_path / "ppo.py").write_text(source.replace(clip, f"{clip}, env.observation_space"))
    command = [sys.executable, "ppo.py", "--env-id", f"solar_env:{DEPLOY}", "--total-timesteps", "4096", "--cuda", "no"]
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        command, capture_output=True, text=True, timeout=300, check=False, cwd=tmp_path, env=environment
    )
    assert done.returncode == 0, done.stderr[-2000:]
    assert "SPS" in done.stdout  # after an update


@pytest.mark.interoperability
def test_the_zoo_trains_with_the_shipped_hyperparameters(tmp_path):
    pytest.importorskip("rl_zoo3")
    command = [
        *(sys.executable, "-W", "ignore", "-m", "rl_zoo3.train", "--algo", "ppo", "--env", DEPLOY),
        *("--gym-packages", "solar_env", "--conf-file", str(ZOO), "-n", "300", "--eval-freq", "-1"),
        *("--hyperparams", "n_envs:2", "n_steps:150", "batch_size:50", "--env-kwargs", "model:'rigid-ideal'"),
        *("--log-folder", str(tmp_path), "--seed", "1"),
    ]
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False, env=environment)
    assert done.returncode == 0, done.stderr[-2000:]
    assert list(tmp_path.rglob("solar_env-Deploy-v2.zip"))


@pytest.mark.interoperability
@pytest.mark.filterwarnings("ignore")
def test_minari_collects_episodes_of_a_shipped_policy(tmp_path, monkeypatch):
    minari = pytest.importorskip("minari")
    monkeypatch.setenv("MINARI_DATASETS_PATH", str(tmp_path))
    policy, keywords = runs.best_policy("rigid"), runs.read_config(runs.folder_of("rigid")).env_kwargs
    env = minari.DataCollector(make_env(DEPLOY, {**keywords, "model": "rigid-ideal"}))
    observation, _ = env.reset(seed=0)
    total, ended = 0.0, False
    while not ended:
        observation, reward, ended, _, _ = env.step(policy.predict(observation)[0])
        total += reward
    dataset = env.create_dataset("solar-array/rigid-v0", algorithm_name="rigid")
    episode = next(dataset.iterate_episodes())
    assert episode.rewards.sum() == pytest.approx(total, rel=1e-12)
    assert episode.observations.shape == (len(episode.actions) + 1, *env.observation_space.shape)


@pytest.mark.interoperability
@pytest.mark.filterwarnings("ignore")
def test_torchrl_collects_a_rollout():
    torchrl = pytest.importorskip("torchrl.envs")
    env = gymnasium.make(DEPLOY, **SHORT)
    rollout = torchrl.GymWrapper(env).rollout(20)
    assert rollout["next", "reward"].shape == (20, 1)
    assert rollout["observation"].shape == (20, *env.observation_space.shape)


@pytest.mark.interoperability
@pytest.mark.filterwarnings("ignore")
def test_rllib_trains_an_iteration():
    ray = pytest.importorskip("ray")
    ppo = pytest.importorskip("ray.rllib.algorithms.ppo")
    ray.tune.register_env(DEPLOY, lambda keywords: gymnasium.make(DEPLOY, **keywords))
    config = ppo.PPOConfig().environment(DEPLOY, env_config=SHORT).env_runners(num_env_runners=0)
    config = config.training(train_batch_size_per_learner=300, minibatch_size=100, num_epochs=1).debugging(seed=0)
    ray.init(num_cpus=1, include_dashboard=False)
    try:
        algorithm = config.build_algo()
        before = algorithm.get_module().get_state()
        result = algorithm.train()
        after = algorithm.get_module().get_state()
        assert result["env_runners"]["num_env_steps_sampled"] >= 300
        assert any(not np.array_equal(before[name], after[name]) for name in before)
        algorithm.stop()
    finally:
        ray.shutdown()
