"""Extraction of a policy as plain arrays from a model of Stable-Baselines3."""

from typing import Any, cast

import numpy as np
import torch
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.policies import ActorCriticPolicy
from stable_baselines3.sac.policies import SACPolicy
from torch import nn

from agents.environments import environment_settings
from agents.learning.features import LIMIT, DriveFeatures
from agents.learning.runs import Configuration
from agents.learning.weight_search import WeightSearch
from agents.policies.network import Layer, PolicyNetwork
from agents.policies.policy import Description, ShippedPolicy

GREATEST = 1e6  # above whatever is observed

ACTIVATIONS: dict[type[nn.Module], str] = {nn.ReLU: "relu", nn.Tanh: "tanh"}


def policy_of(model: BaseAlgorithm, config: Configuration) -> ShippedPolicy:
    """Extract the policy of a model, with the description of its training.

    Raises:
        ValueError: As `network_of`.
    """
    network = network_of(model)
    settings = environment_settings(config.env_id, config.env_kwargs)
    units = ("torque_limit", "deadline", "control_period", "postlock_window")
    description = Description(
        algorithm=config.algo,
        **{name: getattr(network, name) for name in ("feature_limit", "activation", "output", "mean_limit")},
        training_steps=model.num_timesteps,
        env_id=config.env_id,
        env_kwargs=config.env_kwargs,
        observation_names=tuple(settings.observation_names),
        **{name: getattr(settings.task, name) for name in units},
    )
    return ShippedPolicy(network, description)


def network_of(model: BaseAlgorithm) -> PolicyNetwork:
    """Extract the deterministic action of a Stable-Baselines3 model.

    Raises:
        ValueError: The policy has layers that `PolicyNetwork` has not.
    """
    policy: Any = model.policy
    if isinstance(model, WeightSearch):
        return _linear(policy.action_net[0].weight)
    if isinstance(policy, ActorCriticPolicy):
        parts: list[nn.Module] = [policy.pi_features_extractor, policy.mlp_extractor.policy_net, policy.action_net]
    elif isinstance(policy, SACPolicy):
        parts = [policy.actor.features_extractor, policy.actor.latent_pi, policy.actor.mu]
    else:
        parts = [policy.actor.features_extractor, policy.actor.mu]
    leaves = [leaf for part in parts[1:] for leaf in part.modules() if not isinstance(leaf, nn.Sequential)]
    mean = max(index for index, leaf in enumerate(leaves) if isinstance(leaf, nn.Linear))
    linear, between, after = leaves[: mean + 1 : 2], leaves[1:mean:2], leaves[mean + 1 :]
    fits = (
        type(parts[0]) is DriveFeatures
        and all(type(leaf) is nn.Linear for leaf in linear)
        and all(type(leaf) in ACTIVATIONS and type(leaf) is type(between[0]) for leaf in between)
        and [type(leaf) for leaf in after] in ([], [nn.Tanh], [nn.Hardtanh])
    )
    if not fits:
        raise ValueError(
            f"the policy computes {', '.join(type(leaf).__name__ for leaf in [parts[0], *leaves])}; exported can be "
            "fully connected layers on the features of agents.learning.features with one activation, Tanh or ReLU, "
            "between them"
        )
    features = cast(DriveFeatures, parts[0])
    layers = [_layer(features.matrix, features.offset)]
    layers += [_layer(leaf.weight, leaf.bias) for leaf in cast(list[nn.Linear], linear)]
    return PolicyNetwork(
        tuple(layers),
        feature_limit=LIMIT,
        activation=ACTIVATIONS[type(between[0])] if between else "tanh",
        # TD3's actor ends with the Tanh that the others leave to the distribution.
        output="tanh" if policy.squash_output else "clip",
        # SAC with state-dependent exploration keeps the mean away from where tanh is flat.
        mean_limit=next((float(leaf.max_val) for leaf in after if isinstance(leaf, nn.Hardtanh)), None),
    )


def _linear(weights: torch.Tensor) -> PolicyNetwork:
    """The network of a linear policy without a bias, whose features are the entries of the observation."""
    entries = weights.shape[1]
    layers = Layer(np.eye(entries), np.zeros(entries)), _layer(weights, torch.zeros(1))
    return PolicyNetwork(layers, feature_limit=GREATEST, activation="tanh", output="clip")


def _layer(weights: torch.Tensor, biases: torch.Tensor) -> Layer:
    return Layer(*(tensor.detach().cpu().numpy().copy() for tensor in (weights, biases)))
