"""Trained policies as data: arrays and a description, run in plain NumPy and loaded without executing anything.

A shipped policy is a folder with ``policy.npz``, ``policy.json``, ``policy.onnx`` and ``card.md``, written by
`agents.export`. This module needs neither Stable-Baselines3 nor PyTorch.
"""

import itertools
import json
import zipfile
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any, NamedTuple

import gymnasium
import numpy as np

from agents.laws.residual import ResidualController
from agents.torque_laws import Controller, Signals

SHIPPED = Path(__file__).parent / "policies"
ARRAYS = "policy.npz"
DESCRIPTION = "policy.json"
ONNX = "policy.onnx"
CARD = "card.md"
FORMAT = 3
GATES = "gates"  # in place of a layer's number

ACTIVATIONS = ("relu", "tanh")
OUTPUTS = ("clip", "tanh")


class Layer(NamedTuple):
    """Weights (outputs, inputs) and biases (outputs,) of a fully connected layer."""

    weights: np.ndarray
    biases: np.ndarray


@dataclass(frozen=True, eq=False)
class PolicyNetwork:
    """The deterministic action of a policy: features of the observation in double precision, the rest in single.

    An action is the same, to the last bit, alone and among others.

    Attributes:
        layers: From the observation to the mean of the action; the first, in float64, gives features of the
            observation, see `agents.learning.features`, the others are float32.
        gates: From the observation to what the features are multiplied by once it is clipped to [0, 1]; float64.
        feature_limit: The features are clipped to plus and minus this before.
        activation: Between the other layers: relu or tanh.
        output: What makes an action in [-1, 1] of the mean: clip or tanh.
        mean_limit: The mean is first clipped to plus and minus this; None: it is not.

    Raises:
        ValueError: on construction; a layer does not fit the one before it, holds something else than finite numbers
            of its precision, or a name or limit is unknown. The message names the layer and the value.
    """

    layers: tuple[Layer, ...]
    gates: Layer
    feature_limit: float
    activation: str
    output: str
    mean_limit: float | None = None

    def __post_init__(self) -> None:
        for name, allowed in (("activation", ACTIVATIONS), ("output", OUTPUTS)):
            if getattr(self, name) not in allowed:
                raise ValueError(f"{name} is {getattr(self, name)!r}; choose from {', '.join(allowed)}")
        if self.mean_limit is not None and not 0.0 < self.mean_limit < np.inf:
            raise ValueError(f"mean_limit is {self.mean_limit!r}; give a positive finite number or None")
        if not 0.0 < self.feature_limit < np.inf:
            raise ValueError(f"feature_limit is {self.feature_limit!r}; give a positive finite number")
        if len(self.layers) < 2:
            raise ValueError(f"there are {len(self.layers)} layers; a policy network needs features and an output")
        for number, layer in enumerate(self.layers, start=1):
            _check_layer(f"layer {number}", layer, np.float64 if number == 1 else np.float32)
        _check_layer("gates", self.gates, np.float64)
        if self.gates.weights.shape != self.layers[0].weights.shape:
            raise ValueError(
                f"gates: weights have shape {self.gates.weights.shape}; expected those of layer 1, "
                f"{self.layers[0].weights.shape}"
            )
        for number, (before, layer) in enumerate(itertools.pairwise(self.layers), start=2):
            if layer.weights.shape[1] != before.biases.size:
                raise ValueError(
                    f"layer {number}: weights have shape {layer.weights.shape}, but layer {number - 1} has "
                    f"{before.biases.size} outputs"
                )

    @property
    def inputs(self) -> int:
        """Entries of an observation."""
        return self.layers[0].weights.shape[1]

    @property
    def outputs(self) -> int:
        """Entries of an action."""
        return self.layers[-1].biases.size

    def predict(
        self,
        observation: np.ndarray,
        state: tuple[np.ndarray, ...] | None = None,
        episode_start: np.ndarray | None = None,
        deterministic: bool = True,
    ) -> tuple[np.ndarray, tuple[np.ndarray, ...] | None]:
        """Map observations (inputs,) or (n, inputs) to actions (outputs,) or (n, outputs) in [-1, 1], float32.

        The action is the deterministic one whatever `deterministic` says.

        Raises:
            ValueError: an observation has another number of entries.
        """
        values = np.asarray(observation, dtype=np.float32)
        if values.ndim not in (1, 2) or values.shape[-1] != self.inputs:
            raise ValueError(
                f"the observation has shape {values.shape}; expected ({self.inputs},) or (n, {self.inputs})"
            )
        if values.ndim == 1:
            return self._action(values), state
        # One by one: a product of matrices may add up in another order than one of a matrix and a vector.
        return np.array([self._action(row) for row in values]).reshape(len(values), self.outputs), state

    def _action(self, observation: np.ndarray) -> np.ndarray:
        """Action (outputs,) of an observation (inputs,)."""
        features, seen = self.layers[0], observation.astype(np.float64)
        values = np.clip(features.weights @ seen + features.biases, -self.feature_limit, self.feature_limit)
        values *= np.clip(self.gates.weights @ seen + self.gates.biases, 0.0, 1.0)
        values = values.astype(np.float32)
        for layer in self.layers[1:-1]:
            values = layer.weights @ values + layer.biases
            values = np.tanh(values) if self.activation == "tanh" else np.maximum(values, np.float32(0.0))
        mean = self.layers[-1].weights @ values + self.layers[-1].biases
        if self.mean_limit is not None:
            mean = np.clip(mean, -self.mean_limit, self.mean_limit)
        return np.tanh(mean) if self.output == "tanh" else np.clip(mean, -1.0, 1.0)


def _check_layer(which: str, layer: Layer, precision: type[np.floating]) -> None:
    for name, array, dimensions in (("weights", layer.weights, 2), ("biases", layer.biases, 1)):
        if array.dtype != precision:
            raise ValueError(f"{which}: {name} are of type {array.dtype}; expected {precision.__name__}")
        if array.ndim != dimensions or not array.size:
            raise ValueError(
                f"{which}: {name} have shape {array.shape}; expected {dimensions} dimensions, none of them 0"
            )
        if not np.isfinite(array).all():
            raise ValueError(f"{which}: {name} hold {array[~np.isfinite(array)][0]}; expected finite numbers")
    if layer.biases.size != layer.weights.shape[0]:
        raise ValueError(
            f"{which}: biases have shape {layer.biases.shape}, but weights have shape {layer.weights.shape}"
        )


@dataclass(frozen=True)
class Description:
    """What ``policy.json`` says of a shipped policy, besides the network's arrays.

    Attributes:
        algorithm: ppo, sac or td3.
        feature_limit: See `PolicyNetwork`.
        activation: See `PolicyNetwork`.
        output: See `PolicyNetwork`.
        mean_limit: See `PolicyNetwork`.
        training_steps: Environment steps that it was trained for, those of the runs it was resumed from included.
        env_id: Environment that it was trained on.
        env_kwargs: Keywords of that environment.
        observation_names: Name of every entry, in order.
        torque_limit: Motor torque of a unit action [N m].
        deadline: Unit of the observed time [s].
        control_period: For which an action is held [s].
        postlock_window: Unit of the observed time since the last latch [s].
        residual: {"law": name in `baselines.TUNABLE`, "parameters": those of the law, "tuning_episodes": what
            they have cost, "scale": share of the torque limit}; the action is then ``clip(law + scale * network, -1,
            1)``. None: it is the network's.
    """

    algorithm: str
    feature_limit: float
    activation: str
    output: str
    mean_limit: float | None
    training_steps: int
    env_id: str
    env_kwargs: dict[str, Any]
    observation_names: tuple[str, ...]
    torque_limit: float
    deadline: float
    control_period: float
    postlock_window: float
    residual: dict[str, Any] | None

    @property
    def signals(self) -> Signals:
        """What a torque law needs to know of the environment."""
        return Signals(
            self.observation_names,
            self.torque_limit,
            self.deadline,
            self.control_period,
            self.postlock_window,
            self.env_kwargs.get("driven_joint", 0),
        )


class ShippedPolicy:
    """A trained policy as a controller: the network's action, added to that of a torque law where it was trained so.

    Args:
        network: What was learned.
        description: What it was learned on, and the law.

    Raises:
        ValueError: the network does not fit the observation or the action, or the law or one of its parameters is
            unknown.
    """

    def __init__(self, network: PolicyNetwork, description: Description) -> None:
        names = description.observation_names
        if network.inputs != len(names):
            raise ValueError(
                f"layer 1: weights have shape {network.layers[0].weights.shape}; expected {len(names)} inputs, one for "
                f"each of the observation's {', '.join(names)}"
            )
        if network.outputs != 1:
            raise ValueError(
                f"layer {len(network.layers)}: there are {network.outputs} outputs; expected 1, the torque"
            )
        self.network = network
        self.description = description
        residual = description.residual
        self._controller: Controller = (
            ResidualController(network, residual, description.signals) if residual else network
        )

    def predict(
        self,
        observation: np.ndarray,
        state: tuple[np.ndarray, ...] | None = None,
        episode_start: np.ndarray | None = None,
        deterministic: bool = True,
    ) -> tuple[np.ndarray, tuple[np.ndarray, ...] | None]:
        """Map observations (n_obs,) or (n, n_obs) to actions (1,) or (n, 1); see `PolicyNetwork.predict`."""
        return self._controller.predict(observation, state, episode_start, deterministic)

    def check(self, env: gymnasium.Env) -> None:
        """Refuse an environment in which observations or actions mean something else than in training.

        Raises:
            ValueError: as `Signals.check`.
        """
        self.description.signals.check(env, f"{self.description.env_id} with {self.description.env_kwargs}")


def save(folder: Path, policy: ShippedPolicy) -> None:
    """Write ``policy.npz``, with arrays and nothing else, and ``policy.json`` into an existing folder."""
    layers = dict(enumerate(policy.network.layers, start=1)) | {GATES: policy.network.gates}
    arrays = {f"{name}_{key}": array for key, layer in layers.items() for name, array in layer._asdict().items()}
    np.savez(folder / ARRAYS, **arrays)
    content = {"format": FORMAT, **asdict(policy.description)}
    (folder / DESCRIPTION).write_text(json.dumps(content, indent=2, allow_nan=False) + "\n")


def available() -> list[str]:
    """Names of the policies that come with this package."""
    return sorted(path.parent.name for path in SHIPPED.glob(f"*/{DESCRIPTION}"))


def load_shipped(name: str | Path) -> ShippedPolicy:
    """The policy `name` of this package, or the one in the folder `name`; nothing is unpickled or executed.

    Raises:
        FileNotFoundError: there is none.
        ValueError: its files are of another format, hold pickled objects, or do not fit each other; the message names
            the file.
    """
    folder = next((path for path in (SHIPPED / name, Path(name)) if (path / DESCRIPTION).is_file()), None)
    if folder is None:
        raise FileNotFoundError(
            f"no shipped policy {str(name)!r}, and no folder of that name with a {DESCRIPTION}; "
            f"available: {', '.join(available()) or 'none'}"
        )
    try:
        description = _read_description(folder / DESCRIPTION)
        *layers, gates = _read_layers(folder / ARRAYS)
        network = PolicyNetwork(
            tuple(layers),
            gates,
            description.feature_limit,
            description.activation,
            description.output,
            description.mean_limit,
        )
        return ShippedPolicy(network, description)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{folder}: {error}") from error


def _read_description(path: Path) -> Description:
    content = json.loads(path.read_text())
    found = content.pop("format", None) if isinstance(content, dict) else None
    if found != FORMAT:
        raise ValueError(f"{path.name} has format {found!r}; this version reads format {FORMAT}")
    expected = {field.name for field in fields(Description)}
    if set(content) != expected:
        raise ValueError(f"{path.name} has the keys {sorted(content)}; expected {sorted(expected)}")
    return Description(**{**content, "observation_names": tuple(content["observation_names"])})


def _read_layers(path: Path) -> tuple[Layer, ...]:
    """Layers in their order, and last the gates."""
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = {name: np.asarray(file[name]) for name in file.files}
    except (EOFError, OSError, TypeError, ValueError, zipfile.BadZipFile) as error:
        raise ValueError(f"{path.name} cannot be read as plain arrays, and is not unpickled: {error}") from error
    keys = [*range(1, len(arrays) // 2), GATES]
    if not arrays or set(arrays) != {f"{name}_{key}" for key in keys for name in Layer._fields}:
        raise ValueError(
            f"{path.name} holds {sorted(arrays)}; expected weights_1, biases_1, weights_2 and so on, and those of the "
            "gates"
        )
    return tuple(Layer(arrays[f"weights_{key}"], arrays[f"biases_{key}"]) for key in keys)
