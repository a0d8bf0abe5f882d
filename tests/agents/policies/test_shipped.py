"""Policies as plain arrays: that they act as the run did, that nothing is unpickled, and what is refused."""

import json
import pickle

import numpy as np
import onnxruntime
import pytest
from trained import QUICK, TRAINED, random_observations

from agents.environments import make_env
from agents.learning.features import LIMIT, observation_features
from agents.policies import onnx_form, shipped
from agents.policies.shipped import Layer, PolicyNetwork, load_shipped


@pytest.fixture
def own(finished, tmp_path):
    """A copy of an exported policy that a test may spoil."""
    for path in finished["ppo"][1].iterdir():
        (tmp_path / path.name).write_bytes(path.read_bytes())
    return tmp_path


def spoil_description(folder, **changes):
    content = json.loads((folder / shipped.DESCRIPTION).read_text())
    (folder / shipped.DESCRIPTION).write_text(json.dumps({**content, **changes}))


def spoil_arrays(folder, **changes):
    with np.load(folder / shipped.ARRAYS) as file:
        arrays = dict(file)
    np.savez(folder / shipped.ARRAYS, **{**arrays, **changes})


def test_the_first_layer_and_its_limit_are_the_features_of_the_observation(finished):
    policy = load_shipped(finished["ppo"][1])
    features = observation_features(policy.description.observation_names)
    for array, expected in zip(policy.network.layers[0], features, strict=True):
        np.testing.assert_array_equal(array, expected)
    assert policy.network.feature_limit == policy.description.feature_limit == LIMIT


def test_features_are_clipped_and_not_activated():
    features = Layer(np.array([[3.0, 0.0]]), np.zeros(1))
    output = Layer(np.full((1, 1), 0.5, np.float32), np.zeros(1, np.float32))
    network = PolicyNetwork((features, output), feature_limit=1.5, activation="relu", output="clip")
    observations = np.array([[-2.0, 1.0], [-0.2, 1.0], [0.2, 1.0], [2.0, 0.0]], dtype=np.float32)
    expected = np.array([[-0.75], [-0.3], [0.3], [0.75]])
    np.testing.assert_allclose(network.predict(observations)[0], expected, atol=1e-6)
    session = onnxruntime.InferenceSession(onnx_form.onnx_model(network).SerializeToString())
    np.testing.assert_allclose(session.run(None, {"observation": observations})[0], expected, atol=1e-6)


def test_loading_needs_neither_pickle_nor_learning_libraries(finished, run_python):
    program = """
import pickle, sys
pickle.load = pickle.loads = pickle.Unpickler = None
from agents.policies.shipped import load_shipped
print(load_shipped(sys.argv[1]).predict([0.0] * 9)[0].shape)
print([name for name in ("torch", "stable_baselines3", "onnx") if name in sys.modules])
"""
    assert run_python(program, str(finished["sac"][1])).splitlines() == ["(1,)", "[]"]


class Payload:
    """Runs when the object is unpickled."""

    def __reduce__(self):
        return pytest.fail, ("unpickled",)


def test_pickled_content_is_refused_and_not_run(own):
    objects = np.array([Payload()], dtype=object)
    spoil_arrays(own, weights_1=objects)
    with pytest.raises(ValueError, match=r"policy\.npz cannot be read as plain arrays, and is not unpickled: Object"):
        load_shipped(own)
    (own / shipped.ARRAYS).write_bytes(pickle.dumps(Payload()))
    with pytest.raises(ValueError, match=r"policy\.npz cannot be read as plain arrays, and is not unpickled"):
        load_shipped(own)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"weights_2": np.zeros((64, 9), np.float32)}, r"layer 2: weights have shape \(64, 9\), but layer 1 has 11"),
        ({"biases_3": np.zeros(63, np.float32)}, r"layer 3: biases have shape \(63,\), but weights have .*\(64, 64\)"),
        ({"weights_1": np.zeros((11, 8))}, r"the layers map 8 inputs to 1 outputs; expected 9 inputs.*theta"),
        ({"weights_1": np.zeros((11, 9), np.float32)}, "layer 1: weights are of type float32; expected float64"),
        ({"biases_1": np.full(11, np.nan)}, "layer 1: biases hold nan"),
        ({"biases_4": np.zeros((1, 1), np.float32)}, r"layer 4: biases have shape \(1, 1\); expected 1 dimension"),
        ({"weights_9": np.zeros((1, 1), np.float32)}, r"policy\.npz holds \['biases_1', .*expected weights_1"),
    ],
)
def test_arrays_that_do_not_fit_are_named(own, changes, message):
    spoil_arrays(own, **changes)
    with pytest.raises(ValueError, match=f"{own}.*{message}"):
        load_shipped(own)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"format": 1}, r"policy\.json has format 1; this version reads format 4"),
        ({"colour": "red"}, r"policy\.json has the keys .*'colour'.*; expected"),
        ({"activation": "elu"}, "activation is 'elu'; choose from relu, tanh"),
        ({"feature_limit": "two"}, "feature_limit is 'two'; give a finite number"),
        ({"env_id": "stranger.module:Env-v0"}, "env_id is 'stranger.module:Env-v0'; give .* that names no module"),
        ({"observation_names": 3}, "observation_names is 3; give a list of names"),
        ({"env_kwargs": []}, r"env_kwargs is \[\]; give a mapping"),
        ({"deadline": -1.0}, "deadline is -1.0; give a positive number"),
        ({"mean_limit": -1.0}, "mean_limit is -1.0; give a positive"),
        ({"observation_names": ["time", "x */ int evil; /*"]}, "observation_names is .*letters, digits"),
    ],
)
def test_descriptions_that_do_not_fit_are_named(own, changes, message):
    spoil_description(own, **changes)
    with pytest.raises(ValueError, match=f"{own}.*{message}"):
        load_shipped(own)


def test_an_unknown_policy_is_answered_with_those_that_there_are(finished, monkeypatch):
    monkeypatch.setattr(shipped, "SHIPPED", finished["ppo"][1].parent)
    with pytest.raises(
        FileNotFoundError,
        match=r"no shipped policy 'nobody'.*available: cma-es, linear, linear-sac, linear-td3, ppo, sac, td3",
    ):
        load_shipped("nobody")
    assert load_shipped("td3").description.algorithm == "td3"


def test_observations_and_environments_of_another_kind_are_refused(finished):
    policy = load_shipped(finished["ppo"][1])
    with pytest.raises(ValueError, match=r"the observation has shape \(3, 8\); expected \(9,\) or \(n, 9\)"):
        policy.predict(np.zeros((3, 8)))
    for keywords, message in [
        ({"torque_limit": 0.3}, r"torque_limit is 0\.3; the policy was trained with 0\.5"),
        ({"control_period": 0.1}, r"control_period is 0\.1; the policy was trained with 0\.5"),
        ({"postlock_window": 5.0}, r"postlock_window is 5\.0; the policy was trained with 2\.0"),
        ({"observation": "history"}, r"names is .*theta_1_1_ago"),
    ]:
        with make_env(env_kwargs={**QUICK, **keywords}) as env, pytest.raises(ValueError, match=message):
            policy.check(env)


FEATURES = Layer(np.zeros((3, 2)), np.zeros(3))
OUTPUT = Layer(np.zeros((1, 3), np.float32), np.zeros(1, np.float32))


@pytest.mark.parametrize(
    ("layers", "limit", "message"),
    [
        ((), 2.0, "there are 0 layers; a policy network needs features and an output"),
        ((Layer(np.zeros((0, 2)), np.zeros(0)), OUTPUT), 2.0, r"layer 1: weights have shape \(0, 2\)"),
        ((FEATURES, OUTPUT), -2.0, "feature_limit is -2.0; give a positive finite number"),
        ((FEATURES, OUTPUT), np.nan, "feature_limit is nan; give a positive finite number"),
    ],
)
def test_empty_networks_and_limits_that_are_none_are_refused(layers, limit, message):
    with pytest.raises(ValueError, match=message):
        PolicyNetwork(layers, limit, "relu", "tanh")


@pytest.mark.parametrize("name", TRAINED)
def test_a_shipped_policy_acts_alone_as_among_others_to_the_last_bit(finished, name):
    policy = load_shipped(finished[name][1])
    observations = random_observations(100)
    together = policy.predict(observations)[0]
    np.testing.assert_array_equal(together, [policy.predict(observation)[0] for observation in observations])
    np.testing.assert_array_equal(together[7:9], policy.predict(observations[7:9])[0])
