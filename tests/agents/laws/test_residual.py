"""A residual adds a share of the torque limit to a law, and its description is refused where it is none."""

from types import SimpleNamespace

import numpy as np
import pytest

from agents.environments import DEFAULT_ENV_ID
from agents.laws.baselines import episodes_spent, load_parameters
from agents.laws.brake import ConstantBrake
from agents.laws.residual import ResidualController, added, base_law, residual_on
from agents.torque_laws import Signals

SIGNALS = Signals(("theta_1", "latched_1"), torque_limit=0.5)
MODEL = "rigid-clearance"
BRAKE = {"law": "brake", "parameters": {"torque": 0.1, "onset": 0.5}, "tuning_episodes": 0, "scale": 0.25}
# Short of the onset, beyond it, and latched.
OBSERVATIONS = np.array([[0.4, 0.0], [0.6, 0.0], [1.0, 1.0]], dtype=np.float32)


@pytest.mark.parametrize(
    ("base", "action", "sum_of_both"),
    [
        (0.3, 0.0, 0.3),
        (0.3, 1.0, 0.55),
        (0.3, -0.4, 0.2),
        (0.3, -9.0, 0.05),
        (0.3, 9.0, 0.55),
        (0.9, 1.0, 1.0),
        (-0.9, -1.0, -1.0),
    ],
)
def test_a_share_of_the_action_is_added_within_the_bounds_of_both(base, action, sum_of_both):
    assert added(np.full(2, base), np.full(2, action), 0.25) == pytest.approx(sum_of_both, rel=1e-14)


def test_a_residual_controller_is_its_law_and_a_share_of_its_policy():
    def predict(observation, deterministic):
        assert deterministic, "chance has no place in what is compared"
        return np.full((len(observation), 1), -0.8), None

    policy = SimpleNamespace(predict=predict)
    actions, _ = ResidualController(policy, BRAKE, SIGNALS).predict(OBSERVATIONS)
    # The brake pulls with 0.1 of 0.5 N m, beyond its onset alone.
    assert actions[:, 0] == pytest.approx([-0.2, -0.4, -0.2], rel=1e-6)


def test_the_law_of_a_description_has_its_parameters():
    law = base_law(BRAKE, SIGNALS)
    assert isinstance(law, ConstantBrake)
    assert vars(law.parameters) == BRAKE["parameters"]


def test_a_description_names_the_tuned_parameters_and_all_episodes_that_they_cost():
    found = residual_on(1.0, "brake", DEFAULT_ENV_ID, MODEL, recorded=7)
    assert found["parameters"] == vars(load_parameters("brake", DEFAULT_ENV_ID, MODEL))
    assert found["tuning_episodes"] == episodes_spent("brake", DEFAULT_ENV_ID, MODEL) + 7
    assert (found["law"], found["scale"]) == ("brake", 1.0)
    base_law(found, SIGNALS)


@pytest.mark.parametrize("scale", [0.0, -0.1, 1.001, float("nan"), True, "1"])
def test_a_share_of_nothing_or_of_more_than_the_limit_is_refused(scale):
    for refuse in (
        lambda: residual_on(scale, "brake", DEFAULT_ENV_ID, MODEL, 0),
        lambda: base_law({**BRAKE, "scale": scale}, SIGNALS),
    ):
        with pytest.raises(ValueError, match="give a share of the torque limit above 0 and up to 1"):
            refuse()


@pytest.mark.parametrize("law", ["passive", "nothing", None, ["brake"]])
def test_a_law_that_is_not_tuned_is_refused(law):
    for refuse in (
        lambda: residual_on(0.5, law, DEFAULT_ENV_ID, MODEL, 0),
        lambda: base_law({**BRAKE, "law": law}, SIGNALS),
    ):
        with pytest.raises(ValueError, match=r"residual law is .*; available: brake"):
            refuse()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"tuning_episodes": -1}, "tuning_episodes is -1; expected a whole number"),
        ({"tuning_episodes": 0.5}, "tuning_episodes is 0.5"),
        ({"seed": 1}, "residual has the keys .*'seed'"),
        ({"parameters": {"torque": 0.1}}, "the keys are"),
    ],
)
def test_a_description_of_something_else_is_refused(changes, message):
    with pytest.raises(ValueError, match=message):
        base_law({**BRAKE, **changes}, SIGNALS)
