"""Policies that come with the package: arrays and a description, run in NumPy and loaded without executing anything.

A shipped policy is a folder with `policy.npz`, `policy.json`, `policy.onnx` and `card.md`, written by
`solar-env export`. This module needs neither Stable-Baselines3 nor PyTorch.
"""

import json
import re
from dataclasses import asdict, fields
from pathlib import Path

import numpy as np

from agents.policies.network import Layer, PolicyNetwork
from agents.policies.policy import Description, ShippedPolicy
from solar_env.support.files import PART, write_text, writing
from solar_env.support.plain_arrays import read_arrays, read_json

SHIPPED = Path(__file__).parent
ARRAYS = "policy.npz"
DESCRIPTION = "policy.json"
ONNX = "policy.onnx"
CARD = "card.md"
FORMAT = 4
_MEMBER = re.compile(rf"({'|'.join(Layer._fields)})_\d{{1,3}}")
_MOST_BYTES = 2**26


def save(folder: Path, policy: ShippedPolicy) -> None:
    """Write `policy.npz`, which holds plain arrays alone, and `policy.json` into an existing folder."""
    layers = enumerate(policy.network.layers, start=1)
    arrays = {f"{name}_{number}": array for number, layer in layers for name, array in layer._asdict().items()}
    with writing(folder / ARRAYS) as file:
        np.savez(file, **arrays)
    content = {"format": FORMAT, **asdict(policy.description)}
    write_text(folder / DESCRIPTION, json.dumps(content, indent=2, allow_nan=False) + "\n")


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
            the message names the file.
    """
    folder = SHIPPED / name if str(name) in available() else Path(name)
    if not (folder / DESCRIPTION).is_file():
        raise FileNotFoundError(
            f"no shipped policy {str(name)!r}, and no folder of that name with a {DESCRIPTION}; "
            f"available: {', '.join(available()) or 'none'}"
        )
    try:
        description = _read_description(folder / DESCRIPTION)
        d = description
        network = PolicyNetwork(_read_layers(folder / ARRAYS), d.feature_limit, d.activation, d.output, d.mean_limit)
        return ShippedPolicy(network, description)
    except ValueError as error:
        raise ValueError(f"{folder}: {error}") from error


def _read_description(path: Path) -> Description:
    content = read_json(path)
    found = content.pop("format", None) if isinstance(content, dict) else None
    if found != FORMAT:
        raise ValueError(f"{path.name} has format {found!r}; this version reads format {FORMAT}")
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
