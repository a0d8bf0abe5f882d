"""Nested values as one npz file of plain arrays and JSON: nothing is executed when it is read."""

import io
import json
import re
from collections.abc import Mapping
from dataclasses import fields, is_dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import torch

from solar_env.support.plain_arrays import parse_json, read_arrays

_TREE = "tree"
_ARRAY = re.compile(rf"{_TREE}|array_\d+")
_MOST_BYTES = 2**34
Arrays = dict[str, np.ndarray]


def packed(value: object) -> bytes:
    """Return the content of a file that holds a nested value.

    It may be made of dictionaries, lists, tuples, arrays, tensors, numbers, texts, bytes and NumPy's generators.
    Dataclasses and named tuples become dictionaries: see `rebuilt`.
    """
    arrays: Arrays = {}
    tree = json.dumps(_tree(value, arrays))
    file = io.BytesIO()
    np.savez(file, **{_TREE: np.frombuffer(tree.encode(), np.uint8)}, **arrays)  # type: ignore[arg-type]
    return file.getvalue()


def unpacked(path: str | Path) -> Any:
    """Read the nested value that `packed` made the content of a file of.

    Raises:
        OSError: The file cannot be read.
        ValueError: It is damaged, or no such file.
    """
    arrays = read_arrays(path, lambda name: _ARRAY.fullmatch(name) is not None, _MOST_BYTES)
    try:
        return _value(parse_json(arrays.pop(_TREE).tobytes()), arrays)
    except (KeyError, TypeError, AttributeError, RuntimeError) as error:
        raise ValueError(f"it holds no nested value ({error!r})") from error


def rebuilt(like: object, content: Any) -> Any:
    """Make named tuples and dataclasses, as those in `like`, of the dictionaries that `unpacked` returns for them."""
    if isinstance(like, tuple) and hasattr(like, "_fields"):
        return type(like)(**{name: rebuilt(getattr(like, name), content[name]) for name in like._fields})
    if is_dataclass(like) and not isinstance(like, type):
        return replace(like, **{f.name: rebuilt(getattr(like, f.name), content[f.name]) for f in fields(like)})
    return content


def _tree(value: object, arrays: Arrays) -> object:
    """Return a value as JSON keeps it, with arrays by their names; what is no scalar is {kind: content}."""
    if isinstance(value, (np.ndarray, np.generic, torch.Tensor, bytes)):
        array = value.detach().cpu().numpy() if isinstance(value, torch.Tensor) else value
        name = f"array_{len(arrays)}"
        arrays[name] = np.frombuffer(array, np.uint8) if isinstance(array, bytes) else np.array(array)
        if arrays[name].dtype.hasobject:
            raise TypeError(f"an array of {arrays[name].dtype} cannot be kept without pickles")
        kinds: tuple[type, ...] = (torch.Tensor, np.generic, bytes, np.ndarray)
        return {next(kind.__name__ for kind in kinds if isinstance(value, kind)): name}
    if isinstance(value, np.random.Generator):
        return {"Generator": _tree(value.bit_generator.state, arrays)}
    if is_dataclass(value) and not isinstance(value, type):
        value = {f.name: getattr(value, f.name) for f in fields(value)}
    if isinstance(value, tuple) and hasattr(value, "_asdict"):
        value = value._asdict()
    if isinstance(value, Mapping):
        return {"dict": [[_tree(key, arrays), _tree(entry, arrays)] for key, entry in value.items()]}
    if isinstance(value, (list, tuple)):
        return {type(value).__name__: [_tree(entry, arrays) for entry in value]}
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    raise TypeError(f"a {type(value).__name__} cannot be kept as arrays and JSON")


def _value(tree: object, arrays: Arrays) -> Any:
    """Return the value of a tree that `_tree` made."""
    if not isinstance(tree, dict):
        return tree
    ((kind, content),) = tree.items()
    match kind:
        case "dict":
            return {_value(key, arrays): _value(entry, arrays) for key, entry in content}
        case "list":
            return [_value(entry, arrays) for entry in content]
        case "tuple":
            return tuple(_value(entry, arrays) for entry in content)
        case "Generator":
            generator = np.random.Generator(np.random.PCG64())
            generator.bit_generator.state = _value(content, arrays)
            return generator
        case "Tensor":
            return torch.from_numpy(arrays[content])
        case "generic":
            return arrays[content][()]
        case "bytes":
            return arrays[content].tobytes()
        case "ndarray":
            return arrays[content]
    raise ValueError(f"a value of the kind {str(kind)[:20]!r} is unknown")
