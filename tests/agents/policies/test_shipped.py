"""Policies as plain arrays: that they act as the run did, that nothing is unpickled, and what is refused."""

import json
import pickle

import numpy as np
import onnxruntime
import pytest
from trained import QUICK, TRAINED, random_observations

from agents.environments import make_env
from agents.policies import onnx_form, shipped
from agents.policies.shipped import Layer, PolicyNetwork, load_shipped
from solar_env.environment.registration import DEPLOY_V1


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


def test_observations_are_clipped_and_not_activated():
    output = Layer(np.array([[0.5, 0.0]], np.float32), np.zeros(1, np.float32))
    network = PolicyNetwork((output,), observation_limit=1.5, activation="relu", output="clip")
    observations = np.array([[-2.0, 1.0], [-0.6, 1.0], [0.6, 1.0], [2.0, 0.0]], dtype=np.float32)
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
        ({"weights_2": np.zeros((64, 9), np.float32)}, "layer 2 takes 9 inputs, but the one before has 64"),
        ({"biases_2": np.zeros(63, np.float32)}, r"layer 2: biases \(63,\) do not fit weights \(64, 64\)"),
        (
            {"weights_1": np.zeros((64, 8), np.float32)},
            r"the layers map 8 inputs to 1 outputs; expected 9 inputs.*theta",
        ),
        ({"weights_1": np.zeros((64, 9))}, "layer 1 is of type float64 and float32; expected float32"),
        ({"biases_1": np.full(64, np.nan, np.float32)}, "layer 1 holds numbers that are not finite"),
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
        ({"format": 1}, r"policy\.json has format 1; this version reads format 5"),
        ({"colour": "red"}, r"policy\.json has the keys .*'colour'.*; expected"),
        ({"activation": "elu"}, "activation is 'elu'; choose from relu, tanh"),
        ({"observation_limit": "two"}, "observation_limit is 'two'; give a finite number"),
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


def test_descriptions_written_before_the_settling_window_had_its_name_are_read(own):
    path = own / shipped.DESCRIPTION
    path.write_text(path.read_text().replace("settling_window", "postlock_window"))
    assert load_shipped(own).description.settling_window == 2.0


def test_an_unknown_policy_is_answered_with_those_that_there_are(finished, monkeypatch):
    monkeypatch.setattr(shipped, "SHIPPED", finished["ppo"][1].parent)
    with pytest.raises(
        FileNotFoundError,
        match=r"no shipped policy 'nobody'.*available: cma-es, ppo, sac, scored",
    ):
        load_shipped("nobody")
    assert load_shipped("sac").description.algorithm == "sac"


def test_observations_and_environments_of_another_kind_are_refused(finished):
    policy = load_shipped(finished["ppo"][1])
    with pytest.raises(ValueError, match=r"the observation has shape \(3, 8\); expected \(9,\) or \(n, 9\)"):
        policy.predict(np.zeros((3, 8)))
    for keywords, message in [
        ({"torque_limit": 0.3}, r"torque_limit is 0\.3; the policy was trained with 0\.5"),
        ({"control_period": 0.1}, r"control_period is 0\.1; the policy was trained with 0\.5"),
        ({"settling_window": 5.0}, r"settling_window is 5\.0; the policy was trained with 2\.0"),
        ({"observation": "history"}, r"names is .*theta_1_1_ago"),
    ]:
        with make_env(DEPLOY_V1, {**QUICK, **keywords}) as env, pytest.raises(ValueError, match=message):
            policy.check(env)


OUTPUT = Layer(np.zeros((1, 3), np.float32), np.zeros(1, np.float32))


@pytest.mark.parametrize(
    ("layers", "limit", "message"),
    [
        ((), 2.0, "there are no layers; a policy network needs an output"),
        ((Layer(np.zeros((0, 2), np.float32), np.zeros(0, np.float32)), OUTPUT), 2.0, "layer 1: biases .* do not fit"),
        ((OUTPUT,), -2.0, "observation_limit is -2.0; give a positive finite number"),
        ((OUTPUT,), np.nan, "observation_limit is nan; give a positive finite number"),
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
