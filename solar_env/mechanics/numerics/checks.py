"""Refusal of bad parameters: one sentence with the owner, the quantity, its value and the rule."""

import math
from dataclasses import fields


def require(condition: bool, owner: object, name: str, value: object, rule: str) -> None:
    """Check a rule about the quantity `name` of a description.

    Raises:
        ValueError: if the condition does not hold.
    """
    if not condition:
        raise ValueError(f"{type(owner).__name__}.{name} = {value!r}: {rule}")


def require_finite(owner: object, *skip: str) -> None:
    """Check that the numbers of a description are finite, but for the fields named in `skip`.

    Raises:
        ValueError: if one is not.
    """
    for item in fields(owner):  # type: ignore[arg-type]
        value = getattr(owner, item.name)
        if item.name in skip:
            continue
        values = value if isinstance(value, tuple) else (value,)
        for number in values:
            if isinstance(number, float) and not math.isfinite(number):
                require(False, owner, item.name, value, "must be finite")
