"""The network of a policy in NumPy: what does not fit is named, and an action is the same alone and among others."""

import numpy as np
import pytest

from agents.policies.network import Layer, PolicyNetwork


def layer(outputs, inputs, kind=np.float32):
    generator = np.random.default_rng(outputs)
    return Layer(generator.normal(size=(outputs, inputs)).astype(kind), generator.normal(size=outputs).astype(kind))


SMALL = (layer(8, 3), layer(1, 8))


@pytest.mark.parametrize(
    ("layers", "message"),
    [
        ((), "there are no layers; a policy network needs an output"),
        ((layer(8, 3), layer(1, 9)), "layer 2 takes 9 inputs, but the one before has 8"),
        (
            (layer(8, 3)._replace(biases=np.zeros(7, np.float32)),),
            r"layer 1: biases \(7,\) do not fit weights \(8, 3\)",
        ),
        ((layer(0, 3), layer(1, 0)), "layer 1: biases .* do not fit"),
        ((layer(1, 3, np.float64),), "layer 1 is of type float64 and float64; expected float32"),
        ((layer(1, 3)._replace(biases=np.full(1, np.nan, np.float32)),), "layer 1 holds numbers that are not finite"),
    ],
)
def test_layers_that_do_not_fit_are_named(layers, message):
    with pytest.raises(ValueError, match=message):
        PolicyNetwork(layers, "relu", "tanh")


def test_functions_and_observations_that_do_not_fit_are_named():
    with pytest.raises(ValueError, match="activation is 'elu'; choose from relu, tanh"):
        PolicyNetwork(SMALL, "elu", "tanh")
    with pytest.raises(ValueError, match=r"the observation has shape \(3, 8\); expected \(3,\) or \(n, 3\)"):
        PolicyNetwork(SMALL, "relu", "tanh").predict(np.zeros((3, 8)))


def test_a_policy_acts_alone_as_among_others_to_the_last_bit():
    policy = PolicyNetwork(SMALL, "tanh", "clip")
    observations = np.random.default_rng(1).uniform(-4.0, 4.0, (100, 3))
    together = policy.predict(observations)[0]
    np.testing.assert_array_equal(together, [policy.predict(observation)[0] for observation in observations])
    np.testing.assert_array_equal(together[7:9], policy.predict(observations[7:9])[0])
