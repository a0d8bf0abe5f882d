"""The comparisons that the README shows: which controllers, on which scenario."""

from typing import Any

from agents import shipped
from agents.laws.baselines import TUNABLE

# Both are judged on the finest model that is in everyday use.
MODEL: dict[str, Any] = {"model": "flexible-clearance", "elements": 6}
# Agents are compared and shipped from the cheapest model that is as good to train on as that one: from fewer elements
# the worst episodes come out worse, see `agents.transfer`.
TRAINING_MODEL: dict[str, Any] = {"model": "flexible-clearance", "elements": 4}
# Agents without a law need more episodes than there is time for with flexible panels.
WHOLE_TORQUE_MODEL: dict[str, Any] = {"model": "rigid-clearance"}
# Name -> environment id of the scenario.
SUITES = {"paper": "solar_env/Deploy-v0", "robust": "solar_env/DeployRandomised-v0"}


def suite_controllers(env_id: str) -> list[str]:
    """The passive deployment, all tuned baselines, and the shipped policies that were trained on the scenario."""
    names = shipped.available()
    trained = [name for name in names if shipped.load_shipped(name).description.env_id == env_id]
    return ["passive", *TUNABLE, *trained]
