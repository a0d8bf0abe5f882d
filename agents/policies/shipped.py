"""Trained policies as controllers, and their files: arrays and a description, loaded without executing anything.

A policy of this package is a folder with `policy.npz`, `policy.json`, `policy.onnx` and `card.md`, written by
`solar-env export`. This module needs neither Stable-Baselines3 nor PyTorch.
"""

import json
import re
from dataclasses import asdict, dataclass, fields
from pathlib import Path

import gymnasium
import numpy as np

from agents.environments import Keywords, environment_settings
from agents.policies.network import Layer, PolicyNetwork
from agents.torque_laws import DeterministicController, Signals
from solar_env.support.files import PART, write_text, writing
from solar_env.support.plain_arrays import read_arrays, read_json
from solar_env.support.values import check_types

SHIPPED = Path(__file__).parent
ARRAYS = "policy.npz"
DESCRIPTION = "policy.json"
ONNX = "policy.onnx"
CARD = "card.md"
FORMAT = 5
UNITS = ("torque_limit", "deadline", "control_period", "settling_window")
_MEMBER = re.compile(rf"({'|'.join(Layer._fields)})_\d{{1,3}}")
_MOST_BYTES = 2**26


@dataclass(frozen=True)
class Description:
    """Content of `policy.json`: all of a trained policy but the network's arrays.

    Attributes:
        algorithm: Name in `agents.learning.training.ALGORITHMS`.
        observation_limit, activation, output, mean_limit: See `PolicyNetwork`.
        training_steps: Environment steps of its training, with those of the runs that it was resumed from.
        env_id: Environment that it was trained on.
        env_kwargs: Keywords of that environment.
        observation_names: Name of every entry, in order; they stand in the comment of a C header.
        torque_limit, deadline, control_period, settling_window: See `Signals`.

    Raises:
        ValueError: On construction, for a value of another kind, a module in the environment's id, or a unit that is
            not positive.
    """

    algorithm: str
    observation_limit: float
    activation: str
    output: str
    mean_limit: float | None
    training_steps: int
    env_id: str
    env_kwargs: Keywords
    observation_names: tuple[str, ...]
    torque_limit: float
    deadline: float
    control_period: float
    settling_window: float

    def __post_init__(self) -> None:
        check_types(self)
        if ":" in self.env_id:  # Gymnasium imports what stands before it
            raise ValueError(f"env_id is {self.env_id!r}; give an environment id that names no module")
        for name in UNITS:
            if getattr(self, name) <= 0.0:
                raise ValueError(f"{name} is {getattr(self, name)}; give a positive number")

    @property
    def signals(self) -> Signals:
        """Names and units of the environment that it was trained on."""
        task = environment_settings(self.env_id, self.env_kwargs).task
        units = {name: getattr(self, name) for name in UNITS}
        return Signals(self.observation_names, **units, driven_joint=task.driven_joint, action=task.action)


class ShippedPolicy(DeterministicController):
    """A trained policy as a controller.

    Raises:
        ValueError: The network does not fit the observation or the action.
    """

    def __init__(self, network: PolicyNetwork, description: Description) -> None:
        names = description.observation_names
        if (network.inputs, network.outputs) != (len(names), 1):
            raise ValueError(
                f"the layers map {network.inputs} inputs to {network.outputs} outputs; expected {len(names)} inputs, "
                f"one for each of the observation's {', '.join(names)}, and 1 output, the action"
            )
        self.network = network
        self.description = description

    def act(self, observation: np.ndarray) -> np.ndarray:
        """Map observations (n_obs,) or (n, n_obs) to actions (1,) or (n, 1); see `PolicyNetwork.act`."""
        return self.network.act(observation)

    def check(self, env: gymnasium.Env) -> None:
        """Refuse an environment whose observations or actions have another meaning than in training.

        Raises:
            ValueError: As `Signals.check`.
        """
        self.description.signals.check(env, f"{self.description.env_id} with {self.description.env_kwargs}")


def write_policy(folder: Path, policy: ShippedPolicy, stem: str = "policy") -> None:
    """Write `policy.npz`, which holds plain arrays alone, and `policy.json` into an existing folder."""
    layers = enumerate(policy.network.layers, start=1)
    arrays = {f"{name}_{number}": array for number, layer in layers for name, array in layer._asdict().items()}
    with writing(folder / f"{stem}.npz") as file:
        np.savez(file, **arrays)
    content = {"format": FORMAT, **asdict(policy.description)}
    write_text(folder / f"{stem}.json", json.dumps(content, indent=2, allow_nan=False) + "\n")


def available() -> list[str]:
    """List the names of the policies that come with this package."""
    names = (path.parent.name for path in SHIPPED.glob(f"*/{DESCRIPTION}"))
    return sorted(name for name in names if not name.endswith(PART))  # what a kill has left unfinished


def load_shipped(name: str | Path) -> ShippedPolicy:
    """Load the policy `name` of this package, or the one in the folder `name`; nothing is unpickled or executed.

    Raises:
        FileNotFoundError: There is none.
        OSError: A file cannot be read.
        ValueError: Its files are damaged, too large, of another format, hold pickled objects, or do not fit each other;
            the message names the folder.
    """
    folder = SHIPPED / name if str(name) in available() else Path(name)
    if not (folder / DESCRIPTION).is_file():
        raise FileNotFoundError(
            f"no shipped policy {str(name)!r}, and no folder of that name with a {DESCRIPTION}; "
            f"available: {', '.join(available()) or 'none'}"
        )
    try:
        d = _read_description(folder / DESCRIPTION)
        layers = _read_layers(folder / ARRAYS)
        return ShippedPolicy(PolicyNetwork(layers, d.observation_limit, d.activation, d.output, d.mean_limit), d)
    except ValueError as error:
        raise ValueError(f"{folder}: {error}") from error


def _read_description(path: Path) -> Description:
    content = read_json(path)
    found = content.pop("format", None) if isinstance(content, dict) else None
    if found != FORMAT:
        raise ValueError(f"{path.name} has format {found!r}; this version reads format {FORMAT}")
    if "postlock_window" in content:  # what files call it that were written before
        content["settling_window"] = content.pop("postlock_window")
    expected = {field.name for field in fields(Description)}
    if set(content) != expected:
        raise ValueError(f"{path.name} has the keys {sorted(content)}; expected {sorted(expected)}")
    names = content["observation_names"]
    return Description(**{**content, "observation_names": tuple(names) if isinstance(names, list) else names})


def _read_layers(path: Path) -> tuple[Layer, ...]:
    """Read the layers in their order."""
    try:
        arrays = read_arrays(path, lambda name: _MEMBER.fullmatch(name) is not None, _MOST_BYTES)
    except ValueError as error:
        raise ValueError(f"{path.name} cannot be read as plain arrays, and is not unpickled: {error}") from error
    numbers = range(1, len(arrays) // 2 + 1)
    if not arrays or set(arrays) != {f"{name}_{number}" for number in numbers for name in Layer._fields}:
        raise ValueError(f"{path.name} holds {sorted(arrays)}; expected weights_1, biases_1, weights_2 and so on")
    return tuple(Layer(arrays[f"weights_{number}"], arrays[f"biases_{number}"]) for number in numbers)
