"""The network of a policy as plain NumPy arrays."""

from dataclasses import dataclass
from typing import NamedTuple

import gymnasium
import numpy as np

from agents.torque_laws import DeterministicController

ACTIVATIONS = ("relu", "tanh")
OUTPUTS = ("clip", "tanh")


class Layer(NamedTuple):
    """Weights (outputs, inputs) and biases (outputs,) of a fully connected layer, both float32."""

    weights: np.ndarray
    biases: np.ndarray


@dataclass(frozen=True, eq=False)
class PolicyNetwork(DeterministicController):
    """A network that maps observations to a policy's deterministic actions, as plain arrays in single precision.

    An observation gives the same action, to the last bit, alone and in a batch.

    Attributes:
        layers: Layers from the observation to the mean of the action.
        activation: Function between the layers: relu or tanh.
        output: Function that maps the mean to an action in [-1, 1]: clip or tanh.
        mean_limit: Bound to which the mean is clipped before `output`; None stands for no bound.

    Raises:
        ValueError: On construction, if a layer does not fit the layer before it, if its values are not finite numbers
            of single precision, or if `activation` or `output` is unknown. The message names the layer and the value.
    """

    layers: tuple[Layer, ...]
    activation: str
    output: str
    mean_limit: float | None = None

    def __post_init__(self) -> None:
        for name, allowed in (("activation", ACTIVATIONS), ("output", OUTPUTS)):
            if getattr(self, name) not in allowed:
                raise ValueError(f"{name} is {getattr(self, name)!r}; choose from {', '.join(allowed)}")
        before = None
        for number, (weights, biases) in enumerate(self.layers, start=1):
            if {weights.dtype, biases.dtype} != {np.dtype(np.float32)}:
                raise ValueError(f"layer {number} is of type {weights.dtype} and {biases.dtype}; expected float32")
            if weights.ndim != 2 or not weights.size or biases.shape != weights.shape[:1]:
                raise ValueError(f"layer {number}: biases {biases.shape} do not fit weights {weights.shape}")
            if before not in (None, weights.shape[1]):
                raise ValueError(f"layer {number} takes {weights.shape[1]} inputs, but the one before has {before}")
            if not (np.isfinite(weights).all() and np.isfinite(biases).all()):
                raise ValueError(f"layer {number} holds numbers that are not finite")
            before = biases.size
        if before is None:
            raise ValueError("there are no layers; a policy network needs an output")

    @property
    def inputs(self) -> int:
        """Number of entries of an observation."""
        return self.layers[0].weights.shape[1]

    @property
    def outputs(self) -> int:
        """Number of entries of an action."""
        return self.layers[-1].biases.size

    def check(self, env: gymnasium.Env) -> None:
        """Raise a ValueError if observations or actions of the environment have another number of entries."""
        shapes = env.observation_space.shape, env.action_space.shape
        if shapes != ((self.inputs,), (self.outputs,)):
            raise ValueError(
                f"the environment observes {shapes[0]} and takes {shapes[1]}, the policy maps ({self.inputs},) to "
                f"({self.outputs},); give with --env-id and --env-kwargs what it was trained on"
            )

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
        # Map rows one by one: a matrix-matrix product may add in another order than a matrix-vector product.
        return np.array([self._action(row) for row in values]).reshape(len(values), self.outputs)

    def _action(self, observation: np.ndarray) -> np.ndarray:
        """Evaluate the network: return the action (outputs,) of one observation (inputs,)."""
        values = observation
        for layer in self.layers[:-1]:
            values = layer.weights @ values + layer.biases
            values = np.tanh(values) if self.activation == "tanh" else np.maximum(values, np.float32(0.0))
        mean = self.layers[-1].weights @ values + self.layers[-1].biases
        if self.mean_limit is not None:
            mean = np.clip(mean, -self.mean_limit, self.mean_limit)
        return np.tanh(mean) if self.output == "tanh" else np.clip(mean, -1.0, 1.0)
