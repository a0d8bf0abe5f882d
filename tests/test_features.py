"""What an agent's networks see of an observation: what is magnified, what is passed on, and that nothing is learned."""

import numpy as np
import pytest
import torch

from agents.environments import make_env
from agents.features import LIMIT, DriveFeatures, affine
from solar_env.task import OBSERVATIONS


def extractor_of(observation):
    """Extractor, names of the entries, and their bounds."""
    with make_env(env_kwargs={"model": "rigid-ideal", "observation": observation}) as env:
        names, space = env.unwrapped.observation_names, env.observation_space
    return DriveFeatures(space, names), names, space


def features_of(extractor, observations):
    return extractor(torch.from_numpy(np.asarray(observations, dtype=np.float32))).numpy()


def features_from(observation, name, values):
    """Those features that come from the entry `name` at some of its values, (values, features); the others are 0."""
    extractor, names, _ = extractor_of(observation)
    observations = np.zeros((len(values), len(names)))
    observations[:, names.index(name)] = values
    features = features_of(extractor, observations)
    return features[:, affine(names)[0][:, names.index(name)] != 0.0]


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
    assert feature == pytest.approx([-1.5, 0.0, 0.3, LIMIT])


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
def test_features_are_the_affine_map_clipped_and_never_beyond_the_limit(observation):
    extractor, names, space = extractor_of(observation)
    observations = random_observations(space)
    features = features_of(extractor, observations)
    matrix, offset = affine(names)
    assert features.shape == (len(observations), extractor.features_dim)
    assert np.max(np.abs(features)) == LIMIT
    np.testing.assert_allclose(features, np.clip(observations @ matrix.T + offset, -LIMIT, LIMIT), rtol=0.0, atol=1e-5)


@pytest.mark.parametrize("observation", OBSERVATIONS)
def test_every_feature_comes_from_one_entry_and_every_entry_has_one(observation):
    matrix, _ = affine(extractor_of(observation)[1])
    used = matrix != 0.0
    assert used.sum(axis=1).tolist() == [1] * len(matrix)
    assert used.any(axis=0).all()


def test_nothing_is_learned_but_the_map_is_kept_with_the_policy():
    extractor, names, _ = extractor_of("drive")
    assert list(extractor.parameters()) == []
    kept = extractor.state_dict()
    for tensor, expected in zip((kept["matrix"], kept["offset"]), affine(names), strict=True):
        np.testing.assert_array_equal(tensor.numpy(), expected)
