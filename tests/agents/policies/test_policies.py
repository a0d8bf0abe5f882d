"""The policies that come with the package: that they are whole, act alike in all their forms, and land softly."""

from functools import cache
from typing import NamedTuple

import numpy as np
import onnxruntime
import pytest

from agents.comparison.controllers import parse_controller
from agents.comparison.evaluation import SUITES
from agents.environments import INTERFACE, MODEL, episode_seeds, make_env, with_sampling
from agents.policies import shipped
from agents.policies.shipped import load_shipped
from agents.rollout import run_episode
from solar_env import ModalRadau
from solar_env.environment import settings

POLICIES = shipped.available()
ON_FLEXIBLE_PANELS = [name for name in POLICIES if load_shipped(name).description.env_kwargs["model"] == MODEL["model"]]


EACH = [pytest.param(name, marks=[pytest.mark.slow] * (name in ON_FLEXIBLE_PANELS)) for name in POLICIES]
EPISODES = 32


class Deployment(NamedTuple):
    """One, where panels are flexible on modal ones: what was observed (periods, entries), figures, all wear [m]."""

    observed: np.ndarray
    figures: dict[str, float]
    wear: float


def deploy(name, controller, episode=0, model=None):
    """The deployment of a policy's scenario, on its model or another, on an evaluation seed, under a controller."""
    description = load_shipped(name).description
    keywords = {**description.env_kwargs, **(model or {})}
    keywords.pop("randomize", None)
    if controller != name:  # a law has its own interface
        keywords = {key: value for key, value in keywords.items() if key not in INTERFACE}
    env = make_env(description.env_id, with_sampling(keywords, description.env_id))
    seen = []
    seed = episode_seeds("evaluation", 2, EPISODES)[episode]
    figures = run_episode(env, parse_controller(controller).load(env), seed, lambda step: seen.append(step.observation))
    state = env.unwrapped.simulation.state
    return Deployment(np.array(seen, np.float32), figures, state.wear_journal.sum() + state.wear_bearing.sum())


@pytest.fixture(scope="module")
def deployments():
    """Make the deployment under a policy, and the passive one."""
    return cache(lambda name: (deploy(name, name), deploy(name, "passive")))


def test_every_suite_has_a_policy_that_was_trained_on_its_scenario():
    assert {load_shipped(name).description.env_id for name in POLICIES} == set(SUITES.values())


@pytest.mark.parametrize("name", EACH)
def test_onnx_acts_as_the_network_in_a_deployment(name, deployments):
    observed = deployments(name)[0].observed
    session = onnxruntime.InferenceSession(shipped.SHIPPED / name / shipped.ONNX)
    actions = session.run(["action"], {"observation": observed})[0]
    expected = load_shipped(name).network.predict(observed)[0]
    assert np.abs(expected).max() > 0.1
    np.testing.assert_allclose(actions, expected, rtol=0.0, atol=1e-6)


@pytest.mark.parametrize("name", EACH)
def test_a_policy_latches_in_time_with_a_tenth_of_the_passive_deployments_force_and_wear(name, deployments):
    soft, passive = deployments(name)
    assert soft.figures["latched"]
    assert soft.figures["latch_times_s"] < load_shipped(name).description.deadline
    assert soft.figures["peak_postlock_force_N"] < 0.1 * passive.figures["peak_postlock_force_N"]
    assert soft.figures["postlock_sliding_work_J"] < 0.1 * passive.figures["postlock_sliding_work_J"]
    assert soft.wear < 0.1 * passive.wear  # over the whole deployment, most of it before the latches


@pytest.mark.slow
@pytest.mark.parametrize("name", ON_FLEXIBLE_PANELS)
def test_the_energy_book_of_a_soft_landing_closes_to_a_share_of_what_slides(name, deployments):
    """And not only to one of the energy put in, of which sliding takes a fiftieth."""
    figures = deployments(name)[0].figures
    assert abs(figures["energy_residual_J"]) < 5e-3 * figures["sliding_work_J"]


@pytest.mark.slow
@pytest.mark.parametrize("name", ON_FLEXIBLE_PANELS)
def test_a_policy_that_was_trained_on_flexible_panels_costs_less_than_the_servo_there(name):
    """In the mean: what a single landing costs is decided by impacts that no two machines solve alike."""
    policys, servos = (
        np.mean([deploy(name, controller, episode, MODEL).figures["return"] for episode in range(EPISODES)])
        for controller in (name, "servo")
    )
    assert 0.0 < -policys < -servos


@pytest.mark.parametrize("name", POLICIES)
def test_a_card_says_what_a_policy_was_trained_on_how_it_scored_and_where_it_ends(name):
    card = (shipped.SHIPPED / name / shipped.CARD).read_text()
    assert card.startswith(f"# {name}\n")
    assert load_shipped(name).description.env_id in card
    for heading in ("## Training", "## Scores", "## Limits", "## Use"):
        assert heading in card
    assert "None were measured." not in card


def mean_cost(controller):
    """Of 12 deployments with converged panels in the scenario of the nominal policy."""
    return -np.mean([deploy("cma-es-nominal", controller, episode, MODEL).figures["return"] for episode in range(12)])


@pytest.mark.slow
def test_the_nominal_policy_costs_less_than_the_servo_at_a_hundredth_of_the_tolerance_too(monkeypatch):
    monkeypatch.setattr(settings, "default_integrator", lambda *level: ModalRadau(rtol=1e-5))
    assert mean_cost("cma-es-nominal") < 0.8 * mean_cost("servo")


@pytest.mark.slow
def test_what_a_soft_landing_costs_does_not_depend_on_the_tolerance(monkeypatch):
    usual = mean_cost("cma-es-nominal")
    monkeypatch.setattr(settings, "default_integrator", lambda *level: ModalRadau(rtol=1e-5))
    assert mean_cost("cma-es-nominal") == pytest.approx(usual, rel=0.06)
