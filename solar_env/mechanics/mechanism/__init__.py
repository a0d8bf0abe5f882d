"""Mechanisms as data: bodies, joints, springs, stops, bearings, cables, drives and loads.

`description` defines the parts; `textbook` and `beams` build mechanisms of the literature from these parts. To add a
part, write a frozen dataclass in SI units that checks its values when it is made, and compile it in `equations.build`.
"""

# ruff: noqa: F401 - names that the package exports

from solar_env.mechanics.mechanism.beams import PANEL, Beam, cantilever
from solar_env.mechanics.mechanism.description import (
    GROUND,
    Bearing,
    Body,
    CableLoop,
    Drive,
    FlexibleBody,
    Joint,
    Load,
    Mechanism,
    ModalPanel,
    Point,
    Spring,
    Stop,
)
from solar_env.mechanics.mechanism.textbook import STANDARD_GRAVITY, Link, four_bar, loaded_journal, pendulum
