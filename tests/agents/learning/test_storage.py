"""Nested values come back from a file as they were, to the last bit, and nothing but values is kept."""

from collections import namedtuple
from dataclasses import dataclass

import numpy as np
import pytest
import torch

from agents.learning.storage import packed, rebuilt, unpacked

Pair = namedtuple("Pair", "first second")


@dataclass(frozen=True)
class Point:
    x: float
    y: Pair


def kept(value, folder):
    (folder / "file.npz").write_bytes(packed(value))
    return unpacked(folder / "file.npz")


@pytest.mark.parametrize(
    "value",
    [None, True, 3, 0.1, -np.inf, "text", b"bytes", (1, [2.5, None]), {0: {"a": ()}, "b": [[]]}, np.float32(0.1)],
)
def test_a_value_comes_back_with_its_type(value, tmp_path):
    found = kept(value, tmp_path)
    assert found == value
    assert type(found) is type(value)


def test_arrays_tensors_and_generators_come_back_to_the_last_bit(tmp_path):
    rows = np.zeros(2, dtype=np.dtype([("time", float), ("count", np.int64)], align=True))
    generator = np.random.default_rng(1)
    array, tensor, other = kept([rows, torch.arange(3.0), generator], tmp_path)
    assert (array.dtype, array.tobytes()) == (rows.dtype, rows.tobytes())
    assert torch.equal(tensor, torch.arange(3.0))
    assert other.random() == generator.random()


def test_records_come_back_as_those_that_they_are_to_be_like(tmp_path):
    point = Point(0.5, Pair(np.ones(2), None))
    found = rebuilt(Point(0.0, Pair(np.zeros(2), 1)), kept(point, tmp_path))
    assert (found.x, found.y.first.tolist(), found.y.second) == (0.5, [1.0, 1.0], None)


@pytest.mark.parametrize("value", [object(), print, np.array([object()])])
def test_what_is_no_value_is_not_kept(value):
    with pytest.raises(TypeError, match="cannot be kept"):
        packed({"value": value})
