"""Suites: the comparisons that the README shows, by scenario, and the models that are trained and judged on."""

from typing import Any

from agents.laws.baselines import is_tuned
from agents.laws.table import TUNABLE
from agents.policies import shipped
from agents.policies.policy import Description
from solar_env.environment.registration import DEPLOY, DEPLOY_RANDOMISED

# Both suites are judged on this model, whose peak forces have converged, and searches train on it. It is also the
# cheapest with flexible panels: under the servo 579 environment steps a second of a core with 24 modes, 453 with 8, and
# 380, 270 and 172 with 2, 4 and 6 beam elements.
MODEL: dict[str, Any] = {"model": "flexible-clearance"}
# What learns from single steps needs more episodes than there is time for with flexible panels.
RIGID: dict[str, Any] = {"model": "rigid-clearance"}
# Name -> environment id of the scenario.
SUITES = {"paper": DEPLOY, "robust": DEPLOY_RANDOMISED}


def suite_controllers(env_id: str) -> list[str]:
    """List the passive deployment, and the laws and shipped policies that are for a scenario and the suites' model."""
    tuned = [name for name in TUNABLE if is_tuned(name, env_id, MODEL["model"])]
    trained = {name: shipped.load_shipped(name).description for name in shipped.available()}
    return ["passive", *tuned, *(name for name, of in trained.items() if _is_for(of, env_id))]


def _is_for(description: Description, env_id: str) -> bool:
    return description.env_id == env_id and description.env_kwargs["model"] == MODEL["model"]
