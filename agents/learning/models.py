"""Models of Stable-Baselines3 for a configuration, and their policies as plain arrays."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import torch
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.noise import NormalActionNoise
from stable_baselines3.common.on_policy_algorithm import OnPolicyAlgorithm
from stable_baselines3.common.policies import ActorCriticPolicy
from stable_baselines3.common.torch_layers import FlattenExtractor
from stable_baselines3.common.utils import LinearSchedule
from stable_baselines3.common.vec_env import VecEnv, VecNormalize
from stable_baselines3.sac.policies import SACPolicy
from torch import nn

from agents.environments import environment_settings, episode_seeds
from agents.learning import runs
from agents.learning.runs import Configuration
from agents.learning.weight_search import WeightSearch, all_weights
from agents.policies.network import Layer, PolicyNetwork
from agents.policies.shipped import UNITS, Description, ShippedPolicy

LIMIT = 3.0
"""Networks see the entries of an observation clipped to plus and minus this."""
SHARE = "share"
GREATEST = 1e6  # above whatever is observed
ACTIVATIONS: dict[type[nn.Module], str] = {nn.ReLU: "relu", nn.Tanh: "tanh"}


class ClippedEntries(FlattenExtractor):
    """Features extractor of Stable-Baselines3: the observation, clipped to `LIMIT`."""

    def forward(self, observations: torch.Tensor) -> torch.Tensor:
        """Clip observations (n, entries)."""
        return torch.clamp(super().forward(observations), -LIMIT, LIMIT)


class SlowedAdam(torch.optim.Adam):
    """Adam whose parameter groups learn at a "share" of their rate.

    Stable-Baselines3 sets one rate for actor and critics, anew before every update. The share is part of the
    optimiser's state, and so of a checkpoint.
    """

    def step(self, closure: Callable[[], float] | None = None) -> Any:
        """Update the parameters once; returns the loss of the closure."""
        rates = [group["lr"] for group in self.param_groups]
        for group in self.param_groups:
            group["lr"] *= group.get(SHARE, 1.0)
        loss = super().step(closure)
        for group, rate in zip(self.param_groups, rates, strict=True):
            group["lr"] = rate
        return loss


def make_model(config: Configuration, venv: VecEnv) -> BaseAlgorithm:
    """Make a fresh model on `venv` with normalised rewards, whose networks see clipped observations.

    A search over weights has rewards as they are, and its policy sees the observation. The noise and the steps of ARS
    fall linearly from those given to nothing, and so do the learning rates of the others.

    The hyperparameters are keywords of the Stable-Baselines3 class and three more. With "first_weights" a linear policy
    begins as the searches do, see `WeightSearch`; SAC and TD3 act with the hyperbolic tangent of its output.
    "actor_learning_rate" of SAC and TD3 is in place of the "learning_rate", which is then the critics' alone, and
    "exploration_noise" is the standard deviation of their action noise.

    Raises:
        ValueError: The algorithm refuses its hyperparameters.
    """
    try:
        return _made(config, venv)
    except Exception as error:  # of values that nobody has thought of the libraries may raise anything
        reason = " ".join(str(error).split())[:300] or type(error).__name__
        raise ValueError(
            f"{config.algo} refuses its hyperparameters {config.hyperparameters} ({reason}); change them by "
            f"--hyperparams or in agents/configs/{config.algo}.json"
        ) from error


def _made(config: Configuration, venv: VecEnv) -> BaseAlgorithm:
    seed = episode_seeds("training", config.seed, 1)[0]
    cls: Any = runs.ALGORITHMS[config.algo]
    hyperparameters = dict(config.hyperparameters)
    if issubclass(cls, WeightSearch):
        # The best weights are a narrow funnel on a rough plateau, which noise that stays as large does not find.
        for name in ("learning_rate", "delta_std"):
            if name in hyperparameters:
                hyperparameters[name] = LinearSchedule(hyperparameters[name], 0.0, 1.0)
        unchanged = VecNormalize(venv, norm_obs=False, norm_reward=False)
        return cls("LinearPolicy", unchanged, seed=seed, device="cpu", **hyperparameters)
    policy_kwargs = {**hyperparameters.get("policy_kwargs", {}), "features_extractor_class": ClippedEntries}
    hyperparameters["policy_kwargs"] = policy_kwargs
    actor_rate = hyperparameters.pop("actor_learning_rate", None)
    if actor_rate is not None:
        policy_kwargs["optimizer_class"] = SlowedAdam
    first_weights = hyperparameters.pop(runs.FIRST_WEIGHTS, None)
    noise = hyperparameters.pop("exploration_noise", None)
    if noise is not None:
        nothing = np.zeros(venv.action_space.shape or ())
        hyperparameters["action_noise"] = NormalActionNoise(nothing, nothing + noise)
    normalized = VecNormalize(venv, norm_obs=False, gamma=hyperparameters.get("gamma", 0.99))
    # Returns scatter so much that steps of constant size would end in a random walk. The rate given is that of the
    # first update, which PPO makes at the end of the first rollout; after the last update it would be zero.
    rate, step = hyperparameters["learning_rate"], 0.0
    if issubclass(cls, OnPolicyAlgorithm):
        step = rate / math.ceil(config.timesteps / (config.n_envs * hyperparameters["n_steps"]))
    hyperparameters["learning_rate"] = LinearSchedule(rate + step, step, 1.0)
    model = cls("MlpPolicy", normalized, seed=seed, device="cpu", **hyperparameters)
    if actor_rate is not None:
        for group in model.policy.actor.optimizer.param_groups:
            group[SHARE] = actor_rate / rate if rate else 0.0
    if first_weights is not None:
        for layer in _actor_layers(model):
            weights = all_weights(first_weights, layer.weight.shape[1])
            layer.weight.data = torch.as_tensor(weights, dtype=layer.weight.dtype)[None]
            nn.init.zeros_(layer.bias)
    return model


def _actor_layers(model: BaseAlgorithm) -> list[nn.Linear]:
    """Return the last layer of the actor, and that of its target where there is one."""
    policy: Any = model.policy
    actors = [policy.action_net] if isinstance(policy, ActorCriticPolicy) else [policy.actor.mu]
    if hasattr(policy, "actor_target"):
        actors.append(policy.actor_target.mu)
    return [[layer for layer in actor.modules() if isinstance(layer, nn.Linear)][-1] for actor in actors]


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
