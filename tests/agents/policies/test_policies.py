"""The policies that come with the package: that they are whole, land softly, and are better than the tuned servo."""

from functools import cache

import numpy as np
import pytest

from agents.comparison.controllers import parse_controller
from agents.comparison.evaluation import evaluate
from agents.learning import runs
from solar_env import ModalRadau
from solar_env.environment import settings

POLICIES = runs.shipped()
ON_FLEXIBLE_PANELS = [name for name in POLICIES if name.startswith("flexible")]
EACH = [pytest.param(name, marks=[pytest.mark.slow] * (name in ON_FLEXIBLE_PANELS)) for name in POLICIES]
flexible = pytest.mark.parametrize("name", ON_FLEXIBLE_PANELS)


@cache
def figures(name, controller, episodes=1):
    """Figures of held-out episodes of a policy's scenario under a controller."""
    training = parse_controller(name).training()
    return evaluate([controller], episodes, 2, training.env_id, training.env_kwargs, progress=False)


def mean_return(name, controller, episodes):
    return np.mean([row["return"] for row in figures(name, controller, episodes)])


def test_there_is_a_policy_for_each_scenario_on_rigid_and_on_flexible_panels():
    trained = [runs.read_config(runs.folder_of(name)) for name in POLICIES]
    assert len({(of.env_id, of.env_kwargs["model"]) for of in trained}) == len(POLICIES) == 4


@pytest.mark.parametrize("name", EACH)
def test_a_policy_latches_in_time_with_a_tenth_of_the_passive_deployments_force_and_wear(name):
    (soft,), (passive,) = figures(name, name), figures(name, "passive")
    assert soft["latched"]
    assert soft["latch_times_s"] < 20.0
    for figure in ("peak_postlock_force_N", "postlock_sliding_work_J", "sliding_work_J"):
        assert soft[figure] < 0.1 * passive[figure]


@pytest.mark.slow
@pytest.mark.parametrize("name", ["rigid", "flexible"])
def test_a_policy_returns_more_than_the_servo_in_the_mean(name):
    """Where its card says so; what a single landing costs is decided by impacts that no two machines solve alike."""
    assert mean_return(name, name, 32) > mean_return(name, "servo", 32)


@pytest.mark.slow
@flexible
def test_the_energy_book_of_a_soft_landing_closes_to_a_share_of_what_slides(name):
    """And not only to one of the energy put in, of which sliding takes a fiftieth."""
    (soft,) = figures(name, name)
    assert abs(soft["energy_residual_J"]) < 5e-3 * soft["sliding_work_J"]


@pytest.mark.slow
def test_what_a_soft_landing_costs_does_not_depend_on_the_tolerance(monkeypatch):
    usual = mean_return("flexible", "flexible", 12)
    monkeypatch.setattr(settings, "default_integrator", lambda *level: ModalRadau(rtol=1e-5))
    figures.cache_clear()
    assert mean_return("flexible", "flexible", 12) == pytest.approx(usual, abs=0.06)


@pytest.mark.parametrize("name", POLICIES)
def test_a_card_says_what_a_policy_was_trained_on_how_it_scored_and_where_it_ends(name):
    card = (runs.SHIPPED / name / "card.md").read_text(encoding="utf-8")
    assert card.startswith(f"# {name}\n")
    assert runs.read_config(runs.folder_of(name)).env_id in card
    for heading in ("## Training", "## Scores", "## Limits"):
        assert heading in card
