"""Features that networks see of an observation: magnified or passed on, and nothing in them is learned."""

import numpy as np
import pytest
import torch

from agents.environments import make_env
from agents.learning.features import LEAST_DEVIATION, LIMIT, DriveFeatures, _gates, landing, whole_motion
from solar_env.environment.task.observations import OBSERVATIONS


def entries(observation):
    """Names of the entries of an observation, and their bounds."""
    with make_env(env_kwargs={"model": "rigid-ideal", "observation": observation}) as env:
        return env.unwrapped.observation_names, env.observation_space


def features_of(features, space, observations):
    return DriveFeatures(space, features)(torch.from_numpy(np.asarray(observations, dtype=np.float32))).numpy()


def features_from(observation, name, values):
    """Those features that come from the entry `name` at some of its values, (values, features); the others are 0."""
    names, space = entries(observation)
    observations = np.zeros((len(values), len(names)))
    observations[:, names.index(name)] = values
    features = whole_motion(names)
    return features_of(features, space, observations)[:, features.matrix[:, names.index(name)] != 0.0]


def random_observations(space, count=1000):
    corners = np.random.default_rng(1).integers(0, 2, (count, *space.shape))
    inside = np.random.default_rng(2).uniform(space.low, space.high, (count, *space.shape))
    return np.concatenate([np.where(corners, space.high, space.low), inside]).astype(np.float32)


THETAS = [("drive", "theta_1"), ("drive", "theta_2"), ("history", "theta_1_1_ago"), ("history", "theta_2_3_ago")]
RATES = [("drive", "rate_1"), ("drive", "rate_2"), ("history", "rate_1_1_ago"), ("history", "rate_2_3_ago")]
TORQUES = [("drive", "motor_torque"), ("history", "motor_torque_2_ago")]


@pytest.mark.parametrize(("observation", "name"), THETAS)
def test_a_thousandth_of_the_lock_angle_about_the_latch_changes_a_feature_by_a_fifth(observation, name):
    _, fine = features_from(observation, name, [0.999, 1.0, 1.001]).T
    assert fine == pytest.approx([-0.2, 0.0, 0.2], abs=1e-4)


@pytest.mark.parametrize(("observation", "name"), THETAS)
def test_another_feature_tells_angles_apart_from_folded_to_beyond_the_latch(observation, name):
    coarse, _ = features_from(observation, name, [0.0, 0.5, 1.0, 1.4]).T
    assert coarse == pytest.approx([-1.0, 0.0, 1.0, 1.8])


@pytest.mark.parametrize(("observation", "name"), RATES)
def test_rates_are_twentyfold(observation, name):
    (feature,) = features_from(observation, name, [-0.05, 0.0, 0.01, 0.2]).T
    assert feature == pytest.approx([-1.0, 0.0, 0.2, LIMIT])


@pytest.mark.parametrize(("observation", "name"), TORQUES)
def test_motor_torques_are_threefold(observation, name):
    (feature,) = features_from(observation, name, [-0.5, 0.0, 0.1, 1.0]).T
    assert feature == pytest.approx([-1.5, 0.0, 0.3, 3.0])


@pytest.mark.parametrize(
    ("observation", "name"),
    [
        ("drive", "latched_1"),
        ("drive", "latched_2"),
        ("drive", "time_to_deadline"),
        ("drive", "time_since_latch"),
        ("history", "latched_1"),
        ("privileged", "in_contact_2"),
        ("privileged", "eccentricity_x_1"),
    ],
)
def test_flags_times_and_what_only_a_simulator_knows_pass_through(observation, name):
    (feature,) = features_from(observation, name, [0.0, 0.3, 1.0]).T
    assert feature.tolist() == np.float32([0.0, 0.3, 1.0]).tolist()


@pytest.mark.parametrize("observation", OBSERVATIONS)
def test_every_feature_of_the_whole_motion_comes_from_one_entry_and_every_entry_has_one(observation):
    features = whole_motion(entries(observation)[0])
    used = features.matrix != 0.0
    assert used.sum(axis=1).tolist() == [1] * len(used)
    assert used.any(axis=0).all()
    assert not features.gate_matrix.any()
    assert (features.gate_offset == 1.0).all()


def a_landing(observation, count=400):
    """Observations (n, entries) as of a law that lands the array: in flight, in approach, and, half of them, after."""
    names, space = entries(observation)
    random = np.random.default_rng(3)
    drawn = random.uniform(0.0, 0.1, (count, len(names)))
    time = np.linspace(-1.0, 1.0, count)
    latched = time >= 0.0
    theta = np.where(latched, random.normal(1.0, 0.002, count), 1.0 + 0.5 * time)
    for name, values in {
        "theta_1": theta,
        "theta_2": theta - 0.01 * random.random(count),
        "rate_1": np.where(latched, random.normal(0.0, 0.003, count), -0.1 * time),
        "rate_2": np.where(latched, random.normal(0.0, 0.003, count), -0.2 * time + 0.01 * random.random(count)),
        "latched_1": latched,
        "latched_2": latched,
        "time_since_latch": np.maximum(time, 0.0),
    }.items():
        drawn[:, names.index(name)] = values
    return names, space, drawn


def test_the_features_of_a_landing_are_standardised_in_approach_and_after_latching():
    names, space, observations = a_landing("drive")
    values = features_of(landing(names, observations), space, observations)
    theta, latched = (observations[:, names.index(name)] for name in ("theta_1", "latched_2"))
    approach, settling = (theta > 0.9) & (latched == 0.0), latched == 1.0
    on = {name: values[rows].any(axis=0) for name, rows in (("approach", approach), ("settling", settling))}
    assert not (on["approach"] & on["settling"]).any()
    assert (on["approach"] | on["settling"]).all()
    for name, rows in (("approach", approach), ("settling", settling)):
        ones, *components = values[rows][:, on[name]].T
        assert ones == pytest.approx(np.clip(10.0 * (theta[rows] - 0.85), 0.0, 1.0), abs=1e-5)
        assert len(components) >= 3
    _, *components = values[settling][:, on["settling"]].T
    covariance = np.cov(np.array(components), bias=True)
    assert np.abs(np.mean(components, axis=1)).max() < 0.05
    assert covariance == pytest.approx(np.eye(len(components)), abs=0.1)  # but for what is clipped


def test_angles_that_hardly_vary_are_standardised_of_observations_in_single_precision_too():
    """A latched angle of rigid panels varies by some 1e-5 about 1: single-precision means are no closer."""
    names, _, observations = a_landing("drive", 20_000)
    latched = observations[:, names.index("latched_1")] == 1.0
    for name in ("theta_1", "theta_2"):
        column = names.index(name)
        spread = 1e-5 * np.random.default_rng(column).normal(size=len(observations))
        observations[latched, column] = 1.0008 + spread[latched]
    observed = observations.astype(np.float32)
    features = landing(names, observed)
    settling = features.gate_matrix[:, names.index("latched_2")] > 0.0
    values = observed[latched].astype(np.float64) @ features.matrix[settling].T + features.offset[settling]
    assert np.abs(values.mean(axis=0)[1:]).max() < 1e-3
    assert values.std(axis=0)[1:] == pytest.approx(1.0, abs=1e-3)


def test_there_is_nothing_to_see_long_before_the_latches():
    names, space, observations = a_landing("drive")
    values = features_of(landing(names, observations), space, observations)
    opening = observations[:, names.index("theta_1")]
    assert not values[opening < 0.85].any()
    assert values[opening > 0.86].any(axis=1).all()


def test_what_hardly_varies_beside_the_rest_is_left_out():
    names, _, observations = a_landing("drive")
    rate = observations[:, names.index("rate_1")]
    noise = np.std(rate) * np.random.default_rng(4).normal(size=len(observations))
    counts = []
    for share in (0.0, 0.2 * LEAST_DEVIATION, 4.0 * LEAST_DEVIATION):
        observations[:, names.index("rate_2")] = 2.0 * rate + share * noise
        counts.append(len(landing(names, observations).offset))
    assert counts[0] == counts[1] < counts[2]


def test_a_law_that_does_not_land_the_array_is_refused():
    names, _, observations = a_landing("drive")
    with pytest.raises(ValueError, match=r"the law that the agent adds to does not land the array: .* tune it first"):
        landing(names, observations[observations[:, names.index("latched_1")] == 0.0])


@pytest.mark.parametrize("observation", [name for name in OBSERVATIONS if "theta" in OBSERVATIONS[name]])
@pytest.mark.parametrize("kind", ["whole_motion", "landing"])
def test_features_are_clipped_and_gated_and_never_beyond_the_limit(observation, kind):
    names, space, observations = a_landing(observation)
    features = whole_motion(names) if kind == "whole_motion" else landing(names, observations)
    drawn = random_observations(space)
    values = features_of(features, space, drawn)
    gates = np.clip(drawn @ features.gate_matrix.T + features.gate_offset, 0.0, 1.0)
    expected = gates * np.clip(drawn @ features.matrix.T + features.offset, -LIMIT, LIMIT)
    assert values.shape == (len(drawn), len(features.offset))
    assert np.max(np.abs(values)) == LIMIT
    np.testing.assert_allclose(values, expected, rtol=0.0, atol=2e-3)


def test_nothing_is_learned_but_the_map_is_kept_with_the_policy():
    names, space = entries("drive")
    features = whole_motion(names)
    extractor = DriveFeatures(space, features)
    assert list(extractor.parameters()) == []
    kept = extractor.state_dict()
    for name, expected in features._asdict().items():
        np.testing.assert_array_equal(kept[name].numpy(), expected)


def test_the_gates_are_those_of_the_driven_joint_and_open_when_all_joints_have_latched():
    names = [f"{name}_{joint}" for name in ("theta", "latched") for joint in (1, 2, 3)]
    (approach, begins), (latched, offset) = _gates(names, driven_joint=2)
    for theta, switches, expected in (
        ((0.0, 0.0, 0.8), (0, 0, 0), (False, False)),
        ((0.0, 0.0, 0.97), (0, 0, 0), (True, False)),
        ((1.0, 1.0, 0.97), (1, 1, 0), (True, False)),
        ((1.0, 1.0, 1.0), (1, 1, 1), (False, True)),
    ):
        seen = np.array([*theta, *switches], dtype=float)
        assert (seen @ approach + begins > 0.5, seen @ latched + offset > 0.5) == expected
