"""Changed inputs end in the documented exceptions, whatever reads them; `tests/fuzzing.py` searches for hours."""

import fuzzing
import numpy as np
import pytest


def changed(beginnings, random):
    """An input with some bytes changed, left out, doubled or from another place."""
    content = bytearray(beginnings[random.integers(len(beginnings))])
    for _ in range(random.integers(1, 5)):
        if not content:
            break
        start = int(random.integers(len(content)))
        piece = slice(start, start + int(random.integers(1, 20)))
        match random.integers(5):
            case 0:
                content[start] = random.integers(256)
            case 1:
                del content[piece]
            case 2:
                content[start:start] = content[piece]
            case 3:
                content[start:start] = random.choice([b"-1", b"1e999", b"nan", b"null", b"[", b'"', b"\x00", b"\xff"])
            case _:
                del content[start:]
    return bytes(content)


@pytest.mark.parametrize("name", fuzzing.TARGETS)
def test_changed_inputs_are_refused_as_documented_or_read(name):
    target, random = fuzzing.TARGETS[name], np.random.default_rng(0)
    beginnings = target.beginnings()
    for content in beginnings:
        fuzzing.try_input(target, content)
    refused = sum(fuzzing.try_input(target, changed(beginnings, random)) for _ in range(150))
    assert refused > 15
