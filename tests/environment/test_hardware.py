"""Sensors and motor of the hinge drives as the environments have them."""

from __future__ import annotations

import math
from functools import partial

import episodes
import numpy as np
import pytest
from episodes import STRONG, watch

JOINTS = 2
ANGLES, RATES, LATCHED = range(JOINTS), range(JOINTS, 2 * JOINTS), range(2 * JOINTS, 3 * JOINTS)
TORQUE, SINCE_LATCH = 3 * JOINTS, 3 * JOINTS + 2
make = partial(episodes.make, "rigid-ideal")


def test_noise_comes_with_the_seed():
    env = make(hardware={"rate_noise": 1e-3})
    assert np.array_equal(watch(env, [0.0] * 4, seed=3), watch(env, [0.0] * 4, seed=3))
    assert not np.array_equal(watch(env, [0.0] * 4, seed=3), watch(env, [0.0] * 4, seed=4))


@pytest.mark.parametrize("delay", [1, 3])
def test_what_is_measured_comes_late_and_what_the_controller_knows_does_not(delay):
    actions = np.sin(np.arange(60.0))
    keywords = {"parameters": STRONG, "settling_window": 5.0}
    exact = watch(make(**keywords), actions)
    late = watch(make(hardware={"sensor_delay": delay}, **keywords), actions)
    measured = [*ANGLES, *RATES, *LATCHED, SINCE_LATCH]
    assert np.array_equal(late[delay:, measured], exact[:-delay, measured])
    assert np.all(late[:delay, measured] == exact[0, measured]), "before that, what was seen at the start"
    known = [TORQUE, TORQUE + 1]
    assert np.array_equal(late[:, known], exact[:, known])
    assert exact[-1, LATCHED[0]] == 1.0, "the delay of a latching is among what was compared"


def test_the_motor_follows_like_a_system_of_first_order():
    lag = 0.3
    torque = watch(make(hardware={"motor_lag": lag}), [0.8] * 10)[:, TORQUE]
    time = 0.1 * np.arange(11)
    assert torque == pytest.approx(0.8 * (1.0 - np.exp(-time / lag)), abs=1e-6)


def test_the_motor_torque_changes_no_faster_than_its_limit():
    env = make(hardware={"torque_rate_limit": 0.75}, torque_limit=0.5)
    torque = 0.5 * watch(env, [1.0] * 8 + [-1.0] * 16)[:, TORQUE]
    rate = np.diff(torque) / 0.1
    assert np.max(np.abs(rate)) == pytest.approx(0.75, rel=1e-5)
    assert torque[7] == pytest.approx(0.5, rel=1e-6)
    assert torque[-1] == pytest.approx(-0.5, rel=1e-6)


def test_impossible_hardware_is_refused_by_name():
    for changes, words in (
        ({"angle_noise": -1e-3}, "angle_noise.*-0.001.*not negative"),
        ({"rate_noise": math.nan}, "rate_noise.*nan"),
        ({"encoder_resolution": math.inf}, "encoder_resolution.*inf"),
        ({"sensor_delay": 0.5}, "sensor_delay.*0.5.*whole number"),
        ({"sensor_delay": 101}, "sensor_delay.*101"),
        ({"motor_lag": "slow"}, "motor_lag.*'slow'.*number"),
        ({"torque_rate_limit": 0.0}, "torque_rate_limit.*0.0.*positive"),
        ({"colour": 1.0}, "colour.*angle_noise"),
    ):
        with pytest.raises(ValueError, match=words):
            make(hardware=changes)
