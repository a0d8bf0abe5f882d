"""Mechanisms as data: every wrong input is refused by an exception that names the thing and the value."""

from __future__ import annotations

import math
import re
from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest

from solar_env.mechanics.joints.laws import PowerLaw
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
    Spring,
    Stop,
)

BODY = Body("arm", 1.0, 0.1, 1.0, (0.5, 0.0))
SPRING = Spring(1.0, 0.5)
STOP = Stop(0.01, 100.0, 1.0, 1e-3, 1.0)
CONTACT = PowerLaw(1e9)
BEARING = Bearing(1e-3, 0.01, CONTACT)
JOINT = Joint("pin", GROUND, "arm", (0.0, 0.0), (0.0, 0.0), spring=SPRING, stop=STOP, lock_angle=1.0)
OTHER = replace(JOINT, name="other", inboard="arm", outboard="beam")
CABLE = CableLoop("pin", "other", 1.0, 2.0, 2.0)
DRIVE = Drive("arm", 0.0, 1.0)
LOAD = Load("arm", (0.1, 0.0), (1.0, 2.0), 0.3)
BEAM = FlexibleBody("beam", 1.5, 4, linear_density=0.8, axial_stiffness=5.0, bending_stiffness=0.6)
PANEL = ModalPanel("panel", 1.5, 1.2, axial_stiffness=5.0, bending_stiffness=0.6, modes=3)
MECHANISM = Mechanism((BODY, BEAM), (JOINT, OTHER), (CABLE,), (DRIVE,), (LOAD,))
PARTS: list[Any] = [BODY, BEAM, PANEL, SPRING, STOP, CONTACT, BEARING, JOINT, CABLE, DRIVE, LOAD, MECHANISM]

NOT_POSITIVE = {
    BODY: ("mass", "inertia", "length"),
    BEAM: ("length", "linear_density", "axial_stiffness", "bending_stiffness"),
    PANEL: ("length", "mass", "axial_stiffness", "bending_stiffness"),
    STOP: ("stiffness", "ramp_depth"),
    CONTACT: ("stiffness",),
    BEARING: ("clearance", "journal_radius", "minimum_impact_speed", "width"),
    CABLE: ("wheel_ratio",),
}
NEGATIVE = {
    BEAM: ("damping",),
    PANEL: ("damping",),
    DRIVE: ("ramp_time",),
    SPRING: ("stiffness",),
    STOP: ("gap", "damping"),
    CONTACT: ("damping",),
    BEARING: ("friction_coefficient", "wear_coefficient"),
    CABLE: ("stiffness", "torque_ratio", "preload_torque"),
}


def refuses(part: Any, name: str, value: Any, rule: str) -> None:
    with pytest.raises(ValueError, match=re.escape(f"{type(part).__name__}.{name} = {value!r}: {rule}")):
        replace(part, **{name: value})


@pytest.mark.parametrize(("part", "name"), [(p, n) for p, names in NOT_POSITIVE.items() for n in names])
@pytest.mark.parametrize("value", [0.0, -1.0])
def test_a_quantity_that_must_be_positive_is_refused_otherwise(part: Any, name: str, value: Any) -> None:
    refuses(part, name, value, "must be positive")


@pytest.mark.parametrize(("part", "name"), [(p, n) for p, names in NEGATIVE.items() for n in names])
def test_a_quantity_that_must_not_be_negative_is_refused_if_it_is_and_may_be_zero(part: Any, name: str) -> None:
    refuses(part, name, -1e-9, "must not be negative")
    assert getattr(replace(part, **{name: 0.0}), name) == 0.0


def numbers() -> list[tuple[Any, str]]:
    """Every number of every part."""
    found = []
    for part in PARTS:
        for item in fields(part):
            value = getattr(part, item.name)
            point = isinstance(value, tuple) and len(value) == 2 and all(isinstance(x, float) for x in value)
            if isinstance(value, float) or point:
                found.append((part, item.name))
    return found


@pytest.mark.parametrize(("part", "name"), numbers(), ids=lambda x: x if isinstance(x, str) else type(x).__name__)
@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_every_number_of_every_part_must_be_finite(part: Any, name: str, bad: float) -> None:
    value = (bad, 0.5) if isinstance(getattr(part, name), tuple) else bad
    if name == "preload_torque" and bad == math.inf:
        assert replace(part, **{name: bad}).preload_torque == math.inf  # a loop that never slackens
        return
    with pytest.raises(ValueError, match=f"{type(part).__name__}.{name} = ") as caught:
        replace(part, **{name: value})
    assert repr(value) in str(caught.value)


BARE = replace(JOINT, stop=None, lock_angle=None)


@pytest.mark.parametrize(
    ("part", "name", "value", "rule"),
    [
        (STOP, "exponent", 0.5, "must be at least 1"),
        *((CONTACT, "exponent", value, "must lie between 1 and 2") for value in (0.9, 2.1)),
        (BEARING, "sliding", "paper", "must be one of ('material', 'centres', 'places')"),
        *((BEARING, "friction_speeds", v, "must satisfy 0 <= first < second") for v in ((1e-3, 1e-3), (-1e-3, 1e-3))),
        (JOINT, "sign", 0, "must be +1 or -1"),
        (BARE, "lock_angle", 1.0, "needs a stop"),
        (BARE, "stow_angle", 1.0, "needs a stop"),
        (replace(JOINT, lock_angle=0.5), "stow_angle", 0.5, "must be below lock_angle = 0.5"),
        (BODY, "name", GROUND, "is reserved for the fixed frame"),
        (BEAM, "name", GROUND, "is reserved for the fixed frame"),
        *((BEAM, "elements", value, "must be a whole number") for value in (2.0, True, "3", None)),
        *((BEAM, "elements", value, "must lie between 1 and 1000") for value in (0, -1, 1001)),
    ],
)
def test_a_value_that_means_nothing_is_refused(part: Any, name: str, value: Any, rule: str) -> None:
    refuses(part, name, value, rule)


def test_a_body_cannot_be_joined_to_itself() -> None:
    with pytest.raises(ValueError, match=r"Joint\.outboard = 'arm': must differ from the inboard body"):
        replace(JOINT, inboard="arm")


def test_the_nodes_of_a_beam_are_found_by_their_points() -> None:
    assert [BEAM.node((x, 0.0)) for x in np.linspace(0.0, 1.5, 5)] == [0, 1, 2, 3, 4]
    assert [replace(BEAM, elements=n).elements for n in (1, 1000)] == [1, 1000]
    # Rounding is forgiven.
    assert replace(BEAM, elements=7).node((1.5 / 7.0 * 3.0 * (1.0 + 1e-15), 0.0)) == 3
    with pytest.raises(ValueError, match=re.escape("FlexibleBody.point = (0.3, 0.0): is not a node of flexible body")):
        BEAM.node((0.3, 0.0))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"bodies": ()}, "bodies = ()"),
        ({"wear_bins": 0}, "wear_bins = 0: must be at least 1"),
        ({"bodies": (BODY, BODY)}, "names must be unique"),
        ({"bodies": (BODY, replace(BEAM, name="arm"))}, "names must be unique"),
        ({"joints": (JOINT, JOINT), "cables": ()}, "names must be unique"),
        (
            {"joints": (replace(JOINT, outboard="leg"), OTHER)},
            "'leg': is not a body of the mechanism ['arm', 'beam', 'ground']",
        ),
        ({"drives": (replace(DRIVE, body="leg"),)}, "'leg': is not a body"),
        ({"loads": (replace(LOAD, body="leg"),)}, "'leg': is not a body"),
        ({"loads": (replace(LOAD, body=GROUND),)}, "'ground': does not move"),
        ({"drives": (replace(DRIVE, body=GROUND),)}, "'ground': does not move"),
        ({"cables": (replace(CABLE, joint_b="knee"),)}, "'knee': is not a joint of the mechanism ['other', 'pin']"),
        (
            {"joints": (JOINT, replace(OTHER, inboard=GROUND))},
            "CableLoop.joint_b = 'other': must have 'arm', the outboard body of 'pin', as its inboard body",
        ),
    ],
)
def test_a_mechanism_whose_parts_do_not_fit_is_refused(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=re.escape(message)):
        replace(MECHANISM, **changes)
