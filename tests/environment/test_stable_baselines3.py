"""Stable-Baselines3 sees the native vector environment as it would see single ones, bit for bit."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest
from stable_baselines3.common.monitor import Monitor
from stable_baselines3.common.vec_env import DummyVecEnv

from agents.environments import DEFAULT_ENV_ID, environment_settings, make_env
from solar_env.environment.registration import DEPLOY_V1
from solar_env.environment.stable_baselines3 import NativeVecEnv

LANES = 3
KEYWORDS = {
    "randomize": {"clearance": (1e-4, 3e-4)},
    "parameters": {"spring_stiffness": 2.0},  # deploys within three seconds
    "settling_window": 1.0,
}


def both(**changes):
    keywords = {**KEYWORDS, **changes}
    native = NativeVecEnv(LANES, env_kwargs=keywords)
    dummy = DummyVecEnv([partial(make_env, env_kwargs=keywords)] * LANES)
    for venv in (native, dummy):
        venv.seed(3)
    return native, dummy


def assert_same_info(one, other):
    assert set(one) == set(other)
    for key, value in one.items():
        if isinstance(value, dict):
            assert_same_info(value, other[key])
        elif isinstance(value, np.ndarray):
            assert value.tobytes() == other[key].tobytes()
        else:
            assert value == other[key]


@pytest.mark.parametrize("longest", [None, 17], ids=["whole episodes", "truncated"])
def test_it_gives_what_dummy_vec_env_gives_bit_for_bit(longest):
    native, dummy = both(max_episode_steps=longest)
    assert native.reset().tobytes() == dummy.reset().tobytes()
    assert native.reset_infos == dummy.reset_infos
    rng = np.random.default_rng(0)
    ends = 0
    for _ in range(60):
        actions = rng.uniform(-1.0, 1.0, (LANES, 1)).astype(np.float32)
        one, other = native.step(actions), dummy.step(actions)
        for array, expected in zip(one[:3], other[:3], strict=True):
            assert array.dtype == expected.dtype
            assert array.tobytes() == expected.tobytes()
        for info, expected in zip(one[3], other[3], strict=True):
            assert_same_info(info, expected)
        ends += one[2].sum()
    assert native.reset_infos == dummy.reset_infos
    assert ends >= LANES


def test_attributes_and_methods_are_by_lane():
    native, dummy = both(render_mode="rgb_array")
    native.reset(), dummy.reset()
    assert native.get_attr("episode_parameters") == dummy.get_attr("episode_parameters")
    assert native.get_attr("model", indices=1) == ["rigid-clearance"]
    assert [s.time for s in native.get_attr("simulation", indices=[0, 2])] == [0.0, 0.0]
    assert native.env_is_wrapped(Monitor) == [False] * LANES
    frames = native.env_method("render", indices=[1])
    assert np.array_equal(frames[0], dummy.env_method("render", indices=[1])[0])
    assert native.render().shape == dummy.render().shape
    with pytest.raises(AttributeError, match="'task' cannot be set in a lane"):
        native.set_attr("task", None)
    with pytest.raises(AttributeError, match="unheard_of"):
        native.get_attr("unheard_of")


def test_options_of_the_next_reset_are_those_of_the_environments():
    vectors = both()
    some = {"parameters": {"clearance": 3.5e-4}}
    for options in ([some, {}, {}], some, {}):
        for vector in vectors:
            vector.seed(0)
            vector.set_options(options)
            vector.reset()
        drawn, same = ([each.clearance for each in vector.get_attr("episode_parameters")] for vector in vectors)
        assert drawn == same
        assert drawn.count(3.5e-4) == (1 if isinstance(options, list) else 3 * len(options))
    native, _ = vectors
    native.set_options([{}, {"parameter": {}}, {}])
    with pytest.raises(ValueError, match="reset option 'parameter' is unknown"):
        native.reset()


def test_fixed_seeds_begin_the_same_episodes_at_every_reset():
    venv = NativeVecEnv(LANES, env_kwargs=KEYWORDS, first_seed=40)
    designs = []
    for _ in range(2):
        venv.reset()
        designs.append(venv.get_attr("episode_parameters"))
        venv.step(np.zeros((LANES, 1)))
    assert designs[0] == designs[1]
    for lane, design in enumerate(designs[0]):
        env = make_env(DEPLOY_V1, KEYWORDS)
        env.reset(seed=40 + lane)
        assert env.unwrapped.episode_parameters == design


@pytest.mark.parametrize("env_id", ["solar_env/Fold-v0", "a_strangers_module:solar_env/Deploy-v1", ""])
@pytest.mark.parametrize("made", [make_env, environment_settings])
def test_an_id_of_no_environment_is_refused_with_those_that_there_are(env_id, made):
    with pytest.raises(ValueError, match=rf"no environment '{env_id}' .*available: .*{DEFAULT_ENV_ID}"):
        made(env_id)
