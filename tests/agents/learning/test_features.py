"""Features that networks see of an observation: magnified or passed on, and nothing in them is learned."""

import numpy as np
import pytest
import torch

from agents.environments import make_env
from agents.learning.features import LIMIT, DriveFeatures, observation_features
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
    features = observation_features(names)
    return features_of(features, space, observations)[:, features.matrix[:, names.index(name)] != 0.0]


def random_observations(space, count=1000):
    corners = np.random.default_rng(1).integers(0, 2, (count, *space.shape))
    inside = np.random.default_rng(2).uniform(space.low, space.high, (count, *space.shape))
    return np.concatenate([np.where(corners, space.high, space.low), inside]).astype(np.float32)


@pytest.mark.parametrize(("observation", "name"), [("drive", "theta_1"), ("history", "theta_2_3_ago")])
def test_angles_have_a_fine_feature_about_the_latch_and_a_coarse_one_from_folded_to_beyond_it(observation, name):
    coarse, fine = features_from(observation, name, [0.0, 0.5, 0.999, 1.0, 1.001, 1.4]).T
    assert fine[2:5] == pytest.approx([-0.2, 0.0, 0.2], abs=1e-4)
    assert coarse[[0, 1, 3, 5]] == pytest.approx([-1.0, 0.0, 1.0, 1.8])


@pytest.mark.parametrize(
    ("observation", "name", "factor"),
    [
        ("drive", "rate_1", 20.0),
        ("history", "rate_2_3_ago", 20.0),
        ("history", "motor_torque_2_ago", 3.0),
        ("drive", "latched_1", 1.0),
        ("privileged", "in_contact_2", 1.0),
    ],
)
def test_rates_are_twentyfold_and_motor_torques_threefold_and_all_else_is_as_it_is(observation, name, factor):
    values = np.array([-0.05, 0.0, 0.01, 1.0])
    (feature,) = features_from(observation, name, values).T
    assert feature == pytest.approx(np.clip(factor * values, -LIMIT, LIMIT))


@pytest.mark.parametrize("observation", OBSERVATIONS)
def test_every_feature_comes_from_one_entry_every_entry_has_one_and_none_is_beyond_the_limit(observation):
    names, space = entries(observation)
    features = observation_features(names)
    used = features.matrix != 0.0
    assert used.sum(axis=1).tolist() == [1] * len(used)
    assert used.any(axis=0).all()
    drawn = random_observations(space)
    values = features_of(features, space, drawn)
    expected = np.clip(drawn @ features.matrix.T + features.offset, -LIMIT, LIMIT)
    assert values.shape == (len(drawn), len(features.offset))
    assert np.max(np.abs(values)) == LIMIT
    np.testing.assert_allclose(values, expected, rtol=0.0, atol=2e-3)


def test_nothing_is_learned_but_the_map_is_kept_with_the_policy():
    names, space = entries("drive")
    features = observation_features(names)
    extractor = DriveFeatures(space, features)
    assert list(extractor.parameters()) == []
    kept = extractor.state_dict()
    for name, expected in features._asdict().items():
        np.testing.assert_array_equal(kept[name].numpy(), expected)
