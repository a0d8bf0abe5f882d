"""Models that Stable-Baselines3 has saved, read as plain arrays without unpickling any part of a file."""

import io
import json
import zipfile
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import torch

from agents.policies.network import Layer, PolicyNetwork

_MOST_BYTES = 2**28


class Architecture(NamedTuple):
    """A policy of Stable-Baselines3 with fully connected layers.

    Attributes:
        parts: Prefixes of the layers' parameter names, from the observation to the action's mean.
        activation: Function between the layers, unless the model's `policy_kwargs` name another.
        output: Function from the mean to the action.
    """

    parts: tuple[str, ...]
    activation: str
    output: str


# A model has the first architecture whose parts are all in its file and need no other parameters.
ARCHITECTURES = {
    "PPO, A2C, TRPO": Architecture(("mlp_extractor.policy_net", "action_net"), "tanh", "clip"),
    "SAC, TQC": Architecture(("actor.latent_pi", "actor.mu"), "relu", "tanh"),
    "TD3, DDPG": Architecture(("actor.mu",), "relu", "tanh"),
    "ARS and the searches": Architecture(("action_net",), "relu", "tanh"),
}
# Prefixes of parameter names without effect on a deterministic action.
_OTHERS = ("critic", "actor_target", "mlp_extractor.value_net", "value_net", "log_std", "actor.log_std")


def read_model(path: str | Path) -> PolicyNetwork:
    """Read a file that Stable-Baselines3's `model.save` wrote; return the network that gives deterministic actions.

    Raises:
        FileNotFoundError: The file does not exist.
        ValueError: The file is not a saved model, is damaged, or no entry of `ARCHITECTURES` fits its policy.
    """
    path = Path(path)
    if not path.is_file():
        raise FileNotFoundError(f"no model {path}; Stable-Baselines3's model.save writes such files")
    try:
        with zipfile.ZipFile(path) as file:
            if sum(entry.file_size for entry in file.infolist()) > _MOST_BYTES:
                raise ValueError(f"it is larger than {_MOST_BYTES} bytes")
            settings, stored = json.loads(file.read("data")), io.BytesIO(file.read("policy.pth"))
        parameters = torch.load(stored, map_location="cpu", weights_only=True)
        return _network({name: value.numpy() for name, value in parameters.items()}, settings)
    except Exception as error:  # zipfile, json and torch may raise anything for bytes that are no model
        reason = " ".join(str(error).split())[:300] or type(error).__name__
        raise ValueError(f"{path} is no model of Stable-Baselines3 that can be read ({reason})") from error


def _network(parameters: dict[str, np.ndarray], settings: dict[str, Any]) -> PolicyNetwork:
    """Make the network from a policy's parameters (name -> array) and the `settings` saved with the model."""
    acting = {name: value for name, value in parameters.items() if not name.startswith(_OTHERS)}
    stems = list(dict.fromkeys(name.rpartition(".")[0] for name in acting))
    for architecture in ARCHITECTURES.values():
        parts = [[stem for stem in stems if f"{stem}.".startswith(f"{part}.")] for part in architecture.parts]
        layers = [stem for part in parts for stem in part]
        usual = {f"{stem}.{name}" for stem in layers for name in ("weight", "bias")}
        if all(parts) and set(acting) <= usual:
            break
    else:
        raise ValueError(f"its policy has the parameters {', '.join(acting)}")
    given = settings.get("policy_kwargs") or {}
    bare = f"{layers[-1]}.bias" not in acting  # the linear policy of ARS
    squashed = given.get("squash_output", architecture.output == "tanh") and not bare
    return PolicyNetwork(
        tuple(_layer(acting, stem) for stem in layers),
        activation=_activation(given, architecture.activation),
        output="tanh" if squashed else "clip",
        # SAC with state-dependent exploration keeps the mean away from where tanh is flat.
        mean_limit=2.0 if settings.get("use_sde") and architecture.parts[0] == "actor.latent_pi" else None,
    )


def _layer(parameters: dict[str, np.ndarray], stem: str) -> Layer:
    weights = parameters[f"{stem}.weight"]
    return Layer(weights, parameters.get(f"{stem}.bias", np.zeros(len(weights), weights.dtype)))


def _activation(policy_kwargs: dict[str, Any], usual: str) -> str:
    """Return the name of the function between the layers: `usual`, unless `policy_kwargs` name another class."""
    told = str(policy_kwargs.get("activation_fn", usual)).rpartition(".")[2].lower()
    return told.strip("'>")
