"""The keywords of the environments are one list, with defaults and checks, for one environment and for a vector."""

from __future__ import annotations

from dataclasses import FrozenInstanceError, fields, replace

import gymnasium
import numpy as np
import pytest

import solar_env
from solar_env.array.parameters import checks
from solar_env.array.parameters.checks import UnitWarning
from solar_env.environment.registration import DEPLOY
from solar_env.environment.settings import EnvironmentSettings

KEYWORDS = [item.name for item in fields(EnvironmentSettings)]


def makers():
    """Both environments, by class and by id."""
    return {
        "single": solar_env.SolarArrayEnv,
        "vector": lambda **keywords: solar_env.SolarArrayVectorEnv(2, **keywords),
        "make": lambda **keywords: gymnasium.make(DEPLOY, **keywords),
        "make_vec": lambda **keywords: gymnasium.make_vec(DEPLOY, 2, **keywords),
    }


@pytest.mark.parametrize("make", makers().values(), ids=makers())
def test_every_keyword_is_taken_with_its_default_and_an_unknown_one_refused_with_the_closest(make):
    left_out = make().unwrapped
    for name in KEYWORDS:
        given = make(**{name: getattr(EnvironmentSettings(), name)}).unwrapped
        for attribute in ("model", "parameters", "randomize", "hardware", "task", "observation_names"):
            assert getattr(given, attribute) == getattr(left_out, attribute)
        assert given.reward.prices == left_out.reward.prices
    for name, close in (("torque_limits", "torque_limit"), ("modle", "model"), ("colour", "choose from model, param")):
        with pytest.raises(TypeError, match=f"keyword '{name}' is unknown; .*{close}"):
            make(**{name: 1.0})


def test_every_keyword_is_documented():
    for name in KEYWORDS:
        assert f"`{name}`" in solar_env.SolarArrayEnv.__doc__
        assert name in EnvironmentSettings.__doc__


def test_settings_cannot_be_changed_and_a_changed_copy_is_checked_anew():
    settings = EnvironmentSettings(deadline=5.0)
    with pytest.raises(FrozenInstanceError):
        settings.deadline = 6.0
    assert replace(settings, settling_window=2.0).task.settling_window == 2.0
    with pytest.raises(ValueError, match=r"deadline = 0\.01 s is below control_period"):
        replace(settings, deadline=0.01)
    for joint, words in ((2, "= 2 must be below panel_count = 2"), (-1, "-1"), (0.5, "0.5"), (True, "True")):
        with pytest.raises(ValueError, match=words):
            replace(settings, driven_joint=joint)


@pytest.mark.parametrize("value", [-5, 2.5, "nonsense", ["torque"], {"a": 1}, {"scaled"}, b"x", 3 + 2j, object, True])
@pytest.mark.parametrize("name", KEYWORDS)
def test_a_value_of_another_kind_is_refused_by_the_keywords_name_or_taken(name, value):
    try:
        EnvironmentSettings(**{name: value})
    except ValueError as error:
        told = str(error)
        words = {"randomize": "parameter", "parameters": "parameter", "observation": "observable"}
        assert name in told or words.get(name, name) in told


def test_numbers_of_numpy_are_taken_as_pythons():
    numbers = {"driven_joint": np.int64(1), "torque_limit": np.float32(0.5), "deadline": np.array(30.0)}
    taken = EnvironmentSettings(**numbers, hardware={"motor_lag": np.float16(0.5)}, max_steps=np.int32(10**6))
    assert taken.task == replace(EnvironmentSettings().task, driven_joint=1, torque_limit=0.5, deadline=30.0)
    assert type(taken.devices.motor_lag) is type(taken.task.torque_limit) is float


@pytest.mark.parametrize(
    ("keywords", "told"),
    [
        ({"torque_limit": 1000.0}, r"torque_limit = 1000 N m is .* not in N mm"),
        ({"deadline": 20000.0, "settling_window": 10.0}, r"deadline = 20000 s is .* not in ms"),
        ({"control_period": 500.0, "deadline": 1e3, "settling_window": 1e3}, r"control_period = 500 s is .* not in ms"),
        ({"hardware": {"rate_loop_gain": 25000.0}}, r"rate_loop_gain = 25000 N m s/rad is .* not in N mm s/rad"),
        ({"hardware": {"angle_noise": 1.7}}, r"angle_noise = 1\.7 rad is .* not in degrees"),
        ({"hardware": {"motor_lag": 50.0}}, r"motor_lag = 50 s is .* not in ms"),
    ],
)
def test_a_value_of_task_or_hardware_that_is_probably_in_another_unit_is_told(keywords, told, monkeypatch):
    monkeypatch.setattr(checks, "_told", set())
    with pytest.warns(UnitWarning, match=told):
        EnvironmentSettings(**keywords)


def test_what_is_of_a_rate_loop_is_refused_where_there_is_none():
    with pytest.raises(ValueError, match=r"hardware\['rate_loop_gain'\] is of the drive's rate loop, .* 'torque'"):
        EnvironmentSettings(version="v1", hardware={"rate_loop_gain": 5.0})
    assert EnvironmentSettings(action="torque", hardware={"rate_loop_gain": 5.0}).devices.rate_loop_gain == 5.0
