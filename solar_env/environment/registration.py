"""Gymnasium ids of the environments; their entry points are strings, so that registration imports no Numba."""

import itertools

import gymnasium

from solar_env.environment.scenarios import SCENARIOS
from solar_env.environment.task.task import CURRENT_VERSION, VERSIONS


def environment_id(scenario: str, version: str = CURRENT_VERSION) -> str:
    """Return the Gymnasium id of the environment for a scenario and a version of the task."""
    return f"solar_env/{SCENARIOS[scenario].title}-{version}"


# Environment id -> (scenario, version of the task).
ENVIRONMENTS = {environment_id(*pair): pair for pair in itertools.product(SCENARIOS, VERSIONS)}

# Environment ids of the current task version; Gymnasium warns if an environment of an older version is made.
CURRENT = tuple(environment_id(scenario) for scenario in SCENARIOS)
DEPLOY, DEPLOY_RANDOMISED = environment_id("nominal"), environment_id("randomised")
DEPLOY_V1, DEPLOY_RANDOMISED_V1 = (environment_id(scenario, "v1") for scenario in ("nominal", "randomised"))


def register_environments() -> None:
    """Register every environment id with Gymnasium, unless the id is registered already."""
    for name, (scenario, version) in ENVIRONMENTS.items():
        if name not in gymnasium.registry:
            gymnasium.register(
                id=name,
                entry_point="solar_env.environment.env:SolarArrayEnv",
                vector_entry_point="solar_env.environment.vector_env:SolarArrayVectorEnv",
                kwargs={"scenario": scenario, "version": version},
            )
