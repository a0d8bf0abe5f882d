"""Arrays of a compiled mechanism, status codes, and the exceptions that they become."""

from __future__ import annotations

import math
import re
from dataclasses import fields

import numba
import numpy as np
from helpers import fingerprint
from mechanisms import ROUND_BEARING, chain, pendulum

from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.arrays.lanes import copied
from solar_env.mechanics.equations.build import compile_mechanism
from solar_env.mechanics.joints.laws import SLIDING_READINGS
from solar_env.mechanics.mechanism.description import Body, Mechanism
from solar_env.mechanics.running.errors import _CAUSES, failure


def example() -> Mechanism:
    return chain(np.random.default_rng(1), angles=np.array([0.3, 0.8]), eccentricities=np.full((2, 2), 0.01))


def test_a_copied_state_shares_nothing_with_the_original() -> None:
    _, state = compile_mechanism(example())
    copy = copied(state)
    assert fingerprint(copy) == fingerprint(state)
    for name, mine, theirs in zip(state._fields, state, copy, strict=True):
        assert not np.shares_memory(mine, theirs), name


def test_mechanisms_of_any_size_and_kind_of_number_share_their_compiled_kernels() -> None:
    decimal = Body(
        "b", mass=2.0, inertia=1.0, length=1.0, centroid=(0.0, 0.0), position=(1.0, 2.0), velocity=(1.0, 0.0)
    )
    whole = Body("b", mass=2, inertia=1, length=1, centroid=(0, 0), position=(1, 2), velocity=(1, 0))
    compiled = [compile_mechanism(Mechanism((body,), gravity=(0, -1))) for body in (decimal, whole)]
    assert numba.typeof(compiled[0]) == numba.typeof(compiled[1]) == numba.typeof(compile_mechanism(example()))
    assert fingerprint(compiled[0][1]) == fingerprint(compiled[1][1])


def test_every_array_is_contiguous() -> None:
    model, state = compile_mechanism(example())
    for part in (model, model.constraints, model.elimination, state):
        for name, array in part._asdict().items():
            assert isinstance(array, tuple) or np.isscalar(array) or array.flags.c_contiguous, name


def test_a_bearing_arrives_in_its_joint_row_unchanged() -> None:
    model, _ = compile_mechanism(example())
    row = model.joints[0]
    for item in fields(ROUND_BEARING):
        if item.name not in ("contact", "friction_speeds", "sliding"):
            name = {"width": "bearing_width"}.get(item.name, item.name)
            assert row[name] == getattr(ROUND_BEARING, item.name), item.name
    assert tuple(row["contact"]) == ROUND_BEARING.contact.parameters()
    assert (row["friction_speed_zero"], row["friction_speed_full"]) == ROUND_BEARING.friction_speeds
    assert SLIDING_READINGS[row["sliding"]] == ROUND_BEARING.sliding


def test_only_joints_whose_torque_depends_on_the_angle_limit_it() -> None:
    free, sprung = (compile_mechanism(pendulum(spring=spring))[0] for spring in (None, pendulum().joints[0].spring))
    assert free.joints["angle_limited"][0] == 0
    assert sprung.joints["angle_limited"][0] == 1


def clock_of(joint: int, value: float) -> np.void:
    clock = np.zeros(1, m.clock_type)
    clock["time"], clock["failure_joint"], clock["failure_value"] = 1.5, joint, value
    return clock[0]


def test_every_failure_names_its_time_a_remedy_and_a_reason_of_its_own() -> None:
    codes = [m.DONE, m.PAUSED, *_CAUSES]
    assert sorted(codes) == list(range(len(codes)))
    errors = {status: failure(status, clock_of(1, math.pi)) for status in _CAUSES}
    for error in errors.values():
        assert re.match(r"at t = 1\.5 s .*(; |, or )", str(error))
        assert error.time == 1.5
        assert error.reason.isidentifier()
    assert len({error.reason for error in errors.values()}) == len(_CAUSES)
    # Joints count from one.
    assert "joint 2 reached 3.142 rad" in str(errors[m.JOINT_ANGLE_RANGE])
