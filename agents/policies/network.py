"""The network of a policy as plain arrays, in NumPy."""

import itertools
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from agents.torque_laws import DeterministicController

ACTIVATIONS = ("relu", "tanh")
OUTPUTS = ("clip", "tanh")


class Layer(NamedTuple):
    """Weights (outputs, inputs) and biases (outputs,) of a fully connected layer."""

    weights: np.ndarray
    biases: np.ndarray


@dataclass(frozen=True, eq=False)
class PolicyNetwork(DeterministicController):
    """The deterministic action of a policy as plain arrays: features in double precision, the rest in single.

    An action is the same, to the last bit, alone and among others.

    Attributes:
        layers: Layers from the observation to the mean of the action; the first, in float64, computes the features, see
            `agents.learning.features`, the others are float32.
        feature_limit: Bound to which the features are clipped, in either direction.
        activation: Function between the other layers: relu or tanh.
        output: Function that maps the mean to an action in [-1, 1]: clip or tanh.
        mean_limit: Bound to which the mean is clipped before that; None: no bound.

    Raises:
        ValueError: On construction; a layer does not fit the one before it, holds something else than finite numbers
            of its precision, or a name or limit is unknown. The message names the layer and the value.
    """

    layers: tuple[Layer, ...]
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
        for number, (before, layer) in enumerate(itertools.pairwise(self.layers), start=2):
            if layer.weights.shape[1] != before.biases.size:
                raise ValueError(
                    f"layer {number}: weights have shape {layer.weights.shape}, but layer {number - 1} has "
                    f"{before.biases.size} outputs"
                )

    @property
    def inputs(self) -> int:
        """Number of entries of an observation."""
        return self.layers[0].weights.shape[1]

    @property
    def outputs(self) -> int:
        """Number of entries of an action."""
        return self.layers[-1].biases.size

    def act(self, observation: np.ndarray) -> np.ndarray:
        """Map observations (inputs,) or (n, inputs) to actions (outputs,) or (n, outputs) in [-1, 1], float32.

        Raises:
            ValueError: An observation has another number of entries.
        """
        values = np.asarray(observation, dtype=np.float32)
        if values.ndim not in (1, 2) or values.shape[-1] != self.inputs:
            raise ValueError(
                f"the observation has shape {values.shape}; expected ({self.inputs},) or (n, {self.inputs})"
            )
        if values.ndim == 1:
            return self._action(values)
        # One by one: a product of matrices may add in another order than one of a matrix and a vector.
        return np.array([self._action(row) for row in values]).reshape(len(values), self.outputs)

    def _action(self, observation: np.ndarray) -> np.ndarray:
        """Action (outputs,) of an observation (inputs,)."""
        features, seen = self.layers[0], observation.astype(np.float64)
        values = np.clip(features.weights @ seen + features.biases, -self.feature_limit, self.feature_limit)
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
