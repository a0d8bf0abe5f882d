"""Scenarios draw what they say, and are perfect by default."""

from __future__ import annotations

import math
from dataclasses import replace

import gymnasium
import numpy as np
import pytest
from episodes import watch

from solar_env import ArrayParameters, Hardware
from solar_env.environment.registration import DEPLOY_RANDOMISED_V1, DEPLOY_V1, ENVIRONMENTS
from solar_env.environment.scenarios import SCENARIOS
from solar_env.environment.task.task import VERSIONS


def make(name=DEPLOY_V1, **keywords):
    return gymnasium.make(name, model="rigid-ideal", **keywords).unwrapped


def test_every_scenario_is_made_by_its_id_or_by_the_keyword():
    assert {scenario for scenario, _ in ENVIRONMENTS.values()} == set(SCENARIOS)
    assert {version for _, version in ENVIRONMENTS.values()} == set(VERSIONS)
    for name, (scenario, version) in ENVIRONMENTS.items():
        by_id, by_keyword = make(name), make(scenario=scenario, version=version)
        assert by_id.reward.prices == by_keyword.reward.prices
        assert by_id.task == by_keyword.task == VERSIONS[version].task
        assert by_id.scenario == scenario
        assert np.array_equal(watch(by_id, [0.1, -0.2, 0.3]), watch(by_keyword, [0.1, -0.2, 0.3]))
    with pytest.raises(ValueError, match=r"calm.*nominal, randomised"):
        make(scenario="calm")
    with pytest.raises(ValueError, match=r"version 'v9' is unknown.*v1"):
        make(version="v9")


def test_the_randomised_scenario_draws_everything_within_its_ranges():
    env = make(DEPLOY_RANDOMISED_V1)
    drawn = {name: [] for name in env.randomize}
    for seed in range(200):
        env.reset(seed=seed)
        for name, values in drawn.items():
            values.append(getattr(env.episode_parameters, name))
    for name, values in drawn.items():
        low, high = (np.asarray(bound) for bound in env.randomize[name])
        sample = np.asarray(values)
        assert np.all((low <= sample) & (sample <= high)), name
        assert np.all(np.ptp(sample, axis=0) > 0.9 * (high - low)), name
        if sample.ndim == 2:
            assert abs(np.corrcoef(sample.T)[0, 1]) < 0.3, f"{name} is drawn for every joint by itself"


def test_the_randomised_scenario_is_the_documented_one():
    env = make(DEPLOY_RANDOMISED_V1)
    documented = {
        "clearance": (0.05e-3, 0.5e-3),
        "friction_coefficient": (0.05, 0.3),
        "restitution": (0.7, 0.95),
        "spring_stiffness": ((0.09, 0.0675), (0.11, 0.0825)),
        "cable_stiffness": (18.0, 22.0),
        "panel_young": (252e6, 308e6),
        "initial_rate": (0.0, 0.01),
        "initial_spin": (-0.005, 0.005),
    }
    assert set(env.randomize) == set(documented)
    for name, pair in documented.items():
        for bound, expected in zip(env.randomize[name], pair, strict=True):
            by_joint = np.broadcast_to(expected, np.shape(bound))
            assert np.asarray(bound) == pytest.approx(by_joint, rel=1e-12), name
    assert env.hardware == Hardware(5e-4, 1e-3, 2 * math.pi / 2**13, 1, 0.1, 1.0)
    assert env.parameters == ArrayParameters(contact_law="flores")


def test_the_ranges_of_a_scenario_are_around_the_array_that_is_given():
    given = {"spring_stiffness": (1.0, 3.0), "clearance": 1e-3, "friction_coefficient": 0.0, "initial_spin": 0.1}
    env = make(DEPLOY_RANDOMISED_V1, parameters={**given, "panel_count": 3, "restitution": 0.5})
    expected = {
        "spring_stiffness": ((0.9, 2.7, 2.7), (1.1, 3.3, 3.3)),
        "clearance": (2.5e-4, 2.5e-3),
        "friction_coefficient": (0.0, 0.0),
        "initial_spin": (0.095, 0.105),
        "restitution": (0.5 ** (math.log(0.7) / math.log(0.9)), 0.5 ** (math.log(0.95) / math.log(0.9))),
    }
    for name, pair in expected.items():
        for bound, by_joint in zip(env.randomize[name], pair, strict=True):
            assert np.asarray(bound) == pytest.approx(np.broadcast_to(by_joint, np.shape(bound)), rel=1e-12), name
    perfect = make(DEPLOY_RANDOMISED_V1, parameters=ArrayParameters(restitution=1.0, body_fixed=True))
    assert perfect.randomize["restitution"] == (1.0, 1.0)
    assert "initial_spin" not in perfect.randomize, "a hub that is held"
    with pytest.raises(ValueError, match="scenario='randomised' draws around the array's parameters: clearance = "):
        make(DEPLOY_RANDOMISED_V1, parameters={"clearance": 5e-3})


def test_keywords_change_a_scenario_or_take_the_place_of_its_parts():
    env = make(DEPLOY_RANDOMISED_V1, randomize={"clearance": (1e-4, (2e-4, 3e-4))}, hardware={"sensor_delay": 0})
    assert env.randomize == {"clearance": ((1e-4, 1e-4), (2e-4, 3e-4))}
    assert env.hardware == replace(SCENARIOS["randomised"].hardware, sensor_delay=0)
    assert make(DEPLOY_RANDOMISED_V1, hardware=Hardware()).hardware == Hardware()
    assert make(DEPLOY_RANDOMISED_V1, parameters={"body_mass": 900.0}).parameters == ArrayParameters(
        contact_law="flores", body_mass=900.0
    )


def test_hinges_differ_where_their_range_does_and_else_in_what_varies_from_hinge_to_hinge():
    ranges = {"clearance": (1e-4, 3e-4), "latch_gap": ((0.0, 0.01), 0.02), "latch_damping": (5.0, 20.0)}
    env = make(randomize=ranges)
    env.reset(seed=0)
    drawn = env.episode_parameters
    assert len(drawn.clearance) == len(drawn.latch_gap) == 2
    assert drawn.latch_gap[1] >= 0.01
    assert isinstance(drawn.latch_damping, float)


def test_ranges_that_make_no_sense_are_refused_by_name():
    for ranges, words in (
        ({"wear_coefficient": ((1e-14, 1e-14), (2e-14, 2e-14))}, "wear_coefficient.*single number"),
        ({"clearance": ((1e-4, 3e-4), (2e-4, 2e-4))}, "clearance.*low <= high"),
        ({"clearance": (1e-4, 2e-4, 3e-4)}, "clearance.*pair"),
        ({"clearance": ((1e-4, 1e-4, 1e-4), 2e-4)}, "clearance.*1 to 2 entries"),
        ({"clearance": ((), 2e-4)}, "clearance.*1 to 2 entries"),
        ({"cable_torque_ratio": (None, 1.0)}, "cable_torque_ratio.*None.*finite number"),
        ({"friction_coefficient": ("low", "high")}, "friction_coefficient.*low.*finite number"),
        ({"wear_bins": (10, 20)}, "wear_bins.*cannot be drawn"),
        ({"contact_law": ("flores", "hertz")}, "contact_law.*cannot be drawn"),
        # Each of the two ranges is possible, but not their greatest and least value together.
        (
            {"friction_speed_zero": (1e-4, 8e-4), "friction_speed_full": (5e-4, 1e-3)},
            "friction_speed_zero.*0.0008.*friction_speed_full.*0.0005",
        ),
        ({"clearance": (1e-4, 9e-3), "journal_radius": (8e-3, 0.02)}, "clearance.*0.009.*journal_radius"),
        ([("clearance", (1e-4, 2e-4))], "randomize.*must be a mapping of parameter names to pairs"),
    ):
        with pytest.raises(ValueError, match=words):
            make(randomize=ranges)
