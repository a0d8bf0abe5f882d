"""The wrappers of sensors and motors do to any environment what the built-in hardware does to this package's."""

import math

import gymnasium
import numpy as np
import pytest
from episodes import make

from solar_env.environment.hardware.wrappers import (
    WRAPPERS,
    LaggedAction,
    LateObservation,
    NoisyObservation,
    QuantizedObservation,
)
from solar_env.environment.task.observations import observation_entries

SETTINGS = {
    "actuator": {"lag": 2.0, "largest_change": 0.7},
    "noise": {"deviation": 0.1},
    "encoder": {"resolution": 0.25},
    "delay": {"delay": 2},
}
# As the built-in hardware has them: in radians, seconds and periods. (With noise of the rates it draws some for the
# drive's loop, too.)
HARDWARE = {
    "noise": {"angle_noise": 1e-3},
    "encoder": {"encoder_resolution": 0.02},
    "delay": {"sensor_delay": 2},
    "actuator": {"motor_lag": 0.3, "torque_rate_limit": 0.5},
}
ENTRIES = observation_entries(2, "drive")
LOCK_ANGLES = np.array([math.pi / 2, math.pi])


def watch(env, seed=0, steps=60):
    """Observations (steps + 1, entries) under actions that change at random."""
    actions = np.random.default_rng(1).uniform(-1.0, 1.0, (steps, *env.action_space.shape)).astype(np.float32)
    seen = [env.reset(seed=seed)[0]]
    return np.array([*seen, *(env.step(action)[0] for action in actions)])


def where(holds):
    return [k for k, entry in enumerate(ENTRIES) if holds(entry)]


@pytest.mark.parametrize("name", WRAPPERS)
def test_a_wrapped_standard_environment_keeps_gymnasiums_rules_and_is_made_again_from_its_spec(name):
    env = WRAPPERS[name](gymnasium.make("Pendulum-v1"), **SETTINGS[name])

    plain, seen = watch(gymnasium.make("Pendulum-v1")), watch(env)
    assert all(observation in env.observation_space for observation in seen)
    assert seen.dtype == plain.dtype
    assert not np.array_equal(seen, plain)
    np.testing.assert_array_equal(seen, watch(env), "the same seed, the same bits")
    np.testing.assert_array_equal(seen, watch(gymnasium.make(env.spec)))


@pytest.mark.parametrize("name", WRAPPERS)
def test_with_nothing_to_model_nothing_changes(name):
    nothing = {"actuator": {}, "noise": {"deviation": 0.0}, "encoder": {"resolution": 0.0}, "delay": {"delay": 0}}
    np.testing.assert_array_equal(
        watch(WRAPPERS[name](gymnasium.make("Pendulum-v1"), **nothing[name])), watch(gymnasium.make("Pendulum-v1"))
    )


def wrapped(env, names):
    """The plain environment with the wrappers of `HARDWARE`."""
    angles = where(lambda entry: entry.observable.encoder)
    settings = {
        "actuator": {"lag": 3.0, "largest_change": 0.1},  # 0.5 N m/s times 0.1 s, over 0.5 N m
        "noise": {
            "deviation": [*(1e-3 / LOCK_ANGLES), 0.0, 0.0],
            "entries": where(lambda entry: entry.observable.noise),
        },
        "encoder": {"resolution": list(0.02 / LOCK_ANGLES), "entries": angles},
        "delay": {"delay": 2, "entries": where(lambda entry: entry.observable.delayed)},
    }
    for name, wrapper in WRAPPERS.items():
        if name in names:
            env = wrapper(env, **settings[name])
    return env


@pytest.mark.parametrize("names", [*([name] for name in WRAPPERS), list(WRAPPERS)], ids=" ".join)
def test_wrapped_around_the_plain_array_they_give_what_the_built_in_hardware_gives(names):
    hardware = {key: value for name in names for key, value in HARDWARE[name].items()}
    built_in, plain = make("rigid-ideal", hardware=hardware), make("rigid-ideal")
    expected, seen = watch(built_in), watch(wrapped(plain, names))
    assert not np.array_equal(expected, watch(plain))
    # Torques go through float32 outside, and through float64 inside.
    np.testing.assert_allclose(seen, expected, rtol=0.0, atol=2e-6 if "actuator" in names else 0.0)


def test_noise_has_the_deviation_asked_for_on_the_entries_asked_for():
    env = NoisyObservation(gymnasium.make("MountainCarContinuous-v0"), 0.01, entries=[0])
    plain, seen = (watch(each, steps=500) for each in (env.env, env))
    difference = seen - plain
    assert not difference[:, 1].any()
    assert difference[:, 0].std() == pytest.approx(0.01, rel=0.15)


def test_an_encoder_shows_multiples_of_its_step_alone():
    seen = watch(QuantizedObservation(gymnasium.make("Pendulum-v1"), [0.25, 0.5], entries=[0, 1]))
    np.testing.assert_array_equal(np.unique(seen[:, 1]), np.unique(np.rint(seen[:, 1] / 0.5) * 0.5))
    assert np.any(np.rint(seen[:, 2] / 0.25) * 0.25 != seen[:, 2])


def test_a_delay_shows_what_was_and_forgets_it_with_the_episode():
    env = LateObservation(gymnasium.make("Pendulum-v1"), 3)
    plain = watch(gymnasium.make("Pendulum-v1"))
    for _ in range(2):
        seen = watch(env)
        np.testing.assert_array_equal(seen[3:], plain[:-3])
        np.testing.assert_array_equal(seen[:3], plain[[0, 0, 0]])


def test_a_lag_is_the_exponential_approach_and_a_rate_limit_a_ramp():
    env = gymnasium.make("Pendulum-v1")
    lagged, limited = LaggedAction(env, lag=4.0), LaggedAction(env, largest_change=0.5)
    for each in (lagged, limited):
        each.reset(seed=0)
    steps = np.arange(1, 6)
    np.testing.assert_allclose([lagged.action([1.5])[0] for _ in steps], 1.5 * (1.0 - np.exp(-steps / 4.0)), rtol=1e-6)
    assert [limited.action([9.0])[0] for _ in steps] == [0.5, 1.0, 1.5, 2.0, 2.0]
    limited.reset()
    assert limited.action([-2.0])[0] == -0.5


@pytest.mark.parametrize(
    ("make_wrapped", "words"),
    [
        (lambda env: NoisyObservation(env, -0.1), "deviation = -0.1"),
        (lambda env: NoisyObservation(env, [0.1, 0.2]), "one number or 3"),
        (lambda env: NoisyObservation(env, 0.1, entries=[3]), r"entries = \[3\].* 3 entries"),
        (lambda env: QuantizedObservation(env, math.nan), "resolution = nan"),
        (lambda env: LateObservation(env, 1.5), "delay = 1.5"),
        (lambda env: LateObservation(env, -1), "delay = -1"),
        (lambda env: LaggedAction(env, lag=-1.0), "lag = -1.0"),
        (lambda env: LaggedAction(env, largest_change=0.0), "largest_change = 0.0"),
        (lambda _: LaggedAction(gymnasium.make("CartPole-v1")), "action space is Discrete"),
        (lambda _: LateObservation(gymnasium.make("FrozenLake-v1"), 1), "observation space is Discrete"),
    ],
)
def test_impossible_hardware_is_refused_by_name(make_wrapped, words):
    with pytest.raises(ValueError, match=words):
        make_wrapped(gymnasium.make("Pendulum-v1"))
