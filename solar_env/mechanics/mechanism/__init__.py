"""Mechanisms as data: bodies, joints, springs, stops, bearings, cables, drives and loads.

`description` holds the parts, `textbook` and `beams` build mechanisms of the literature from them. Imports the rooms
below. A new part is a frozen dataclass in SI units, checked when it is made, and its place in `equations.build`.
"""

# ruff: noqa: F401 - names of the room

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
