"""Extraction of policies: the arrays act as Stable-Baselines3 does, and what they cannot hold is refused."""

import numpy as np
import onnxruntime
import pytest
from stable_baselines3 import PPO, SAC, TD3
from stable_baselines3.common.torch_layers import FlattenExtractor
from torch import nn
from trained import TRAINED, random_observations
from training import last_model

from agents.environments import make_env
from agents.learning import runs
from agents.learning.models import ClippedEntries, network_of, policy_of
from agents.policies import onnx_form


@pytest.mark.parametrize("name", TRAINED)
def test_the_policy_of_a_training_acts_as_its_model(finished, name):
    run = finished[name][0]
    model, observations = last_model(run), random_observations(500)
    policy = policy_of(model, runs.read_config(run))
    expected, _ = model.predict(observations, deterministic=True)
    actions, _ = policy.predict(observations)
    assert (actions.shape, actions.dtype) == ((500, 1), np.float32)
    np.testing.assert_allclose(actions, expected, rtol=0.0, atol=1e-6)
    np.testing.assert_allclose(policy.predict(observations[3])[0], expected[3], rtol=0.0, atol=1e-6)


def untrained(cls, **keywords):
    env = make_env(env_kwargs={"model": "rigid-ideal", "observation": "drive"})
    kwargs = {"net_arch": [32, 16], "features_extractor_class": ClippedEntries, **keywords.pop("policy_kwargs", {})}
    return cls("MlpPolicy", env, policy_kwargs=kwargs, seed=3, device="cpu", **keywords)


def last_linear(model):
    policy = model.policy
    output = policy.action_net if isinstance(model, PPO) else policy.actor.mu
    return [module for module in output.modules() if isinstance(module, nn.Linear)][-1]


KINDS = [
    (PPO, {}, "tanh", "clip", None),
    (PPO, {"use_sde": True, "policy_kwargs": {"squash_output": True}}, "tanh", "tanh", None),
    (PPO, {"policy_kwargs": {"activation_fn": nn.ReLU, "net_arch": []}}, "tanh", "clip", None),
    (SAC, {}, "relu", "tanh", None),
    (SAC, {"use_sde": True, "policy_kwargs": {"clip_mean": 1.2}}, "relu", "tanh", 1.2),
    (TD3, {}, "relu", "tanh", None),
    (TD3, {"policy_kwargs": {"activation_fn": nn.Tanh}}, "tanh", "tanh", None),
]


@pytest.mark.parametrize(("cls", "keywords", "activation", "output", "mean_limit"), KINDS)
def test_means_beyond_the_limits_are_handled_as_the_algorithm_does(cls, keywords, activation, output, mean_limit):
    model = untrained(cls, **keywords)
    last = last_linear(model)
    last.weight.data *= 2.0 / last.weight.data.norm()
    last.bias.data += 1.2
    network = network_of(model)
    assert (network.activation, network.output) == (activation, output)
    assert network.mean_limit == mean_limit
    observations = random_observations(2000)
    expected, _ = model.predict(observations, deterministic=True)
    greatest = 1.0 if output == "clip" else np.tanh(mean_limit or 9.0)
    assert expected.max() == pytest.approx(greatest, abs=0.05)
    assert expected.min() < 0.9 * greatest
    actions, _ = network.predict(observations)
    np.testing.assert_allclose(actions, expected, rtol=0.0, atol=1e-6)
    session = onnxruntime.InferenceSession(onnx_form.onnx_model(network).SerializeToString())
    np.testing.assert_allclose(session.run(None, {"observation": observations})[0], actions, rtol=0.0, atol=1e-6)


@pytest.mark.parametrize(
    ("keywords", "message"),
    [
        ({"activation_fn": nn.ELU}, "computes ClippedEntries, Linear, ELU, Linear, ELU, Linear; exported can be"),
        (
            {"features_extractor_class": FlattenExtractor},
            "computes FlattenExtractor, Linear.*exported can be .* layers on clipped entries",
        ),
    ],
)
def test_policies_of_another_kind_are_refused(keywords, message):
    with pytest.raises(ValueError, match=message):
        network_of(untrained(PPO, policy_kwargs=keywords))
