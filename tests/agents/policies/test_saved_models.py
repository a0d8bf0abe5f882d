"""What Stable-Baselines3 saves is read as plain arrays that act alike, and nothing in it is unpickled."""

from __future__ import annotations

import pickle
import zipfile

import gymnasium
import numpy as np
import pytest
import torch
from sb3_contrib import ARS, TQC, CrossQ
from stable_baselines3 import A2C, DDPG, PPO, SAC, TD3

from agents.comparison.controllers import parse_controller
from agents.policies.saved_models import read_model

RELU = {"policy_kwargs": {"activation_fn": torch.nn.ReLU, "net_arch": [16, 8, 8]}}
SMALL = {"buffer_size": 10}
# Name -> class, policy, keywords.
MODELS = {
    "ppo": (PPO, "MlpPolicy", {}),
    "ppo, other layers": (PPO, "MlpPolicy", RELU),
    "ppo, squashed": (PPO, "MlpPolicy", {"use_sde": True, "policy_kwargs": {"squash_output": True}}),
    "a2c": (A2C, "MlpPolicy", {}),
    "sac": (SAC, "MlpPolicy", SMALL),
    "sac, state-dependent": (SAC, "MlpPolicy", {"use_sde": True, **SMALL}),
    "td3": (TD3, "MlpPolicy", SMALL),
    "ddpg": (DDPG, "MlpPolicy", SMALL),
    "tqc": (TQC, "MlpPolicy", SMALL),
    "ars": (ARS, "MlpPolicy", {}),
    "ars, linear": (ARS, "LinearPolicy", {}),
}


class Plain(gymnasium.Env):
    """Spaces alone."""

    observation_space = gymnasium.spaces.Box(-5.0, 5.0, (8,))
    action_space = gymnasium.spaces.Box(-1.0, 1.0, (1,))

    def reset(self, *, seed=None, options=None):
        return np.zeros(8, np.float32), {}

    def step(self, action):
        return np.zeros(8, np.float32), 0.0, False, False, {}


def saved(name, path):
    cls, policy, keywords = MODELS[name]
    model = cls(policy, Plain(), seed=1, device="cpu", **keywords)
    torch.manual_seed(4)
    with torch.no_grad():  # some actions are clipped or flat
        for parameters in model.policy.parameters():
            parameters.copy_(torch.randn_like(parameters) / parameters.shape[-1] ** 0.5)
    model.save(path)
    return model


@pytest.mark.parametrize("name", MODELS)
def test_a_network_acts_as_the_model_did(name, tmp_path):
    model = saved(name, tmp_path / "model.zip")
    network = read_model(tmp_path / "model.zip")
    observations = np.random.default_rng(0).uniform(-5.0, 5.0, (200, 8)).astype(np.float32)
    expected = model.predict(observations, deterministic=True)[0]
    assert network.act(observations) == pytest.approx(expected, abs=1e-5)
    assert len(np.unique(expected)) > 20


def test_a_policy_with_other_layers_is_refused_with_their_names(tmp_path):
    CrossQ("MlpPolicy", Plain(), buffer_size=10, device="cpu").save(tmp_path / "model.zip")
    with pytest.raises(ValueError, match=r"model\.zip is no model .*the parameters actor.latent_pi.0.scale"):
        read_model(tmp_path / "model.zip")


def test_an_environment_with_other_observations_is_refused(tmp_path):
    saved("ppo", tmp_path / "model.zip")
    controller = parse_controller(str(tmp_path / "model.zip"))
    controller.load(gymnasium.make("solar_env/Deploy-v2", model="rigid-ideal"))
    with pytest.raises(ValueError, match=r"observes \(11,\) .*maps \(8,\) .*give with --env-id"):
        controller.load(gymnasium.make("solar_env/Deploy-v2", model="rigid-ideal", parameters={"panel_count": 3}))


class Trap:
    """Runs when the object is unpickled."""

    def __reduce__(self):
        return pytest.fail, ("a stranger's file was executed",)


def test_nothing_is_unpickled(tmp_path):
    saved("ppo", tmp_path / "model.zip")
    with zipfile.ZipFile(tmp_path / "model.zip") as file:
        content = {name: file.read(name) for name in file.namelist()}
    with zipfile.ZipFile(tmp_path / "evil.zip", "w") as file:
        for name, of in content.items():
            file.writestr(name, pickle.dumps(Trap()) if name == "policy.pth" else of)
    with pytest.raises(ValueError, match=r"evil\.zip is no model of Stable-Baselines3 that can be read"):
        read_model(tmp_path / "evil.zip")


def test_a_file_that_is_missing_is_told():
    with pytest.raises(FileNotFoundError, match=r"no model nowhere\.zip; .*model\.save"):
        read_model("nowhere.zip")
