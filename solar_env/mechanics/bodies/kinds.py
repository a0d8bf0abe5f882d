"""Table of the kinds of body, and the record type of a body, which has the fields of all kinds."""

from typing import Any

import numpy as np

from solar_env.mechanics.arrays.model import record
from solar_env.mechanics.bodies.cable_element.element import CableElements
from solar_env.mechanics.bodies.description import AnyBody
from solar_env.mechanics.bodies.kind import BodyKind, Fields
from solar_env.mechanics.bodies.natural_coordinates import NaturalCoordinates

# A kind's index in the table is its code in kernels.
KINDS: tuple[BodyKind[Any], ...] = (NaturalCoordinates(), CableElements())
NATURAL, CABLE_ELEMENTS = range(len(KINDS))

_BODY: Fields = [
    ("kind", np.int64),
    ("offset", np.int64),  # first generalized coordinate
    ("coordinates", np.int64),  # number of generalized coordinates
    ("fixed", np.int64),  # whether the body is held in place
    ("constraints", np.int64),  # number of constraints between its own coordinates: 1 for its length, or 0
    ("length", np.float64),
]
body_type = record(list(dict([*_BODY, *(member for kind in KINDS for member in kind.body_fields)]).items()))


def code_of(body: AnyBody) -> int:
    """Return the index in `KINDS` of a body's kind; raise a ValueError if the body's class is not in the table."""
    for code, kind in enumerate(KINDS):
        if type(body) is kind.description:
            return code
    known = ", ".join(kind.description.__name__ for kind in KINDS)
    raise ValueError(f"body {body.name!r} is a {type(body).__name__}; describe it as one of {known}")
