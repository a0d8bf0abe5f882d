"""Extraction of a policy as plain arrays from a model of Stable-Baselines3."""

from typing import Any

import torch
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.policies import ActorCriticPolicy
from stable_baselines3.sac.policies import SACPolicy
from torch import nn

from agents.environments import environment_settings
from agents.learning.models import LIMIT, ClippedEntries
from agents.learning.runs import Configuration
from agents.learning.weight_search import WeightSearch
from agents.policies.network import Layer, PolicyNetwork
from agents.policies.shipped import UNITS, Description, ShippedPolicy

GREATEST = 1e6  # above whatever is observed

ACTIVATIONS: dict[type[nn.Module], str] = {nn.ReLU: "relu", nn.Tanh: "tanh"}


def policy_of(model: BaseAlgorithm, config: Configuration) -> ShippedPolicy:
    """Extract the policy of a model, with the description of its training.

    Raises:
        ValueError: As `network_of`.
    """
    network = network_of(model)
    settings = environment_settings(config.env_id, config.env_kwargs)
    description = Description(
        algorithm=config.algo,
        **{name: getattr(network, name) for name in ("observation_limit", "activation", "output", "mean_limit")},
        training_steps=model.num_timesteps,
        env_id=config.env_id,
        env_kwargs=config.env_kwargs,
        observation_names=tuple(settings.observation_names),
        **{name: getattr(settings.task, name) for name in UNITS},
    )
    return ShippedPolicy(network, description)


def network_of(model: BaseAlgorithm) -> PolicyNetwork:
    """Extract the deterministic action of a Stable-Baselines3 model.

    Raises:
        ValueError: The policy has layers that `PolicyNetwork` has not.
    """
    policy: Any = model.policy
    if isinstance(model, WeightSearch):
        weights = policy.action_net[0].weight
        return PolicyNetwork((_layer(weights, torch.zeros(1)),), GREATEST, activation="tanh", output="clip")
    if isinstance(policy, ActorCriticPolicy):
        extractor, *parts = policy.pi_features_extractor, policy.mlp_extractor.policy_net, policy.action_net
    elif isinstance(policy, SACPolicy):
        extractor, *parts = policy.actor.features_extractor, policy.actor.latent_pi, policy.actor.mu
    else:
        extractor, *parts = policy.actor.features_extractor, policy.actor.mu
    leaves: list[Any] = [leaf for part in parts for leaf in part.modules() if not isinstance(leaf, nn.Sequential)]
    mean = max(index for index, leaf in enumerate(leaves) if isinstance(leaf, nn.Linear))
    linear, between, after = leaves[: mean + 1 : 2], leaves[1:mean:2], leaves[mean + 1 :]
    fits = (
        type(extractor) is ClippedEntries
        and all(type(leaf) is nn.Linear for leaf in linear)
        and all(type(leaf) in ACTIVATIONS and type(leaf) is type(between[0]) for leaf in between)
        and [type(leaf) for leaf in after] in ([], [nn.Tanh], [nn.Hardtanh])
    )
    if not fits:
        raise ValueError(
            f"the policy computes {', '.join(type(leaf).__name__ for leaf in [extractor, *leaves])}; exported can be "
            "fully connected layers on clipped entries with one activation, Tanh or ReLU, between them"
        )
    return PolicyNetwork(
        tuple(_layer(leaf.weight, leaf.bias) for leaf in linear),
        observation_limit=LIMIT,
        activation=ACTIVATIONS[type(between[0])] if between else "tanh",
        # TD3's actor ends with the Tanh that the others leave to the distribution.
        output="tanh" if policy.squash_output else "clip",
        # SAC with state-dependent exploration keeps the mean away from where tanh is flat.
        mean_limit=next((float(leaf.max_val) for leaf in after if isinstance(leaf, nn.Hardtanh)), None),
    )


def _layer(weights: torch.Tensor, biases: torch.Tensor) -> Layer:
    return Layer(*(tensor.detach().cpu().numpy().copy() for tensor in (weights, biases)))
