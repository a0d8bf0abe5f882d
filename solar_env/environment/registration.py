"""Gymnasium ids of the environments, with string entry points so that registering imports nothing."""

import gymnasium

# Id -> scenario.
ENVIRONMENTS = {"solar_env/Deploy-v0": "nominal", "solar_env/DeployRandomised-v0": "randomised"}


def register_environments() -> None:
    """Register every id once."""
    for name, scenario in ENVIRONMENTS.items():
        if name not in gymnasium.registry:
            gymnasium.register(
                id=name,
                entry_point="solar_env.environment.env:SolarArrayEnv",
                vector_entry_point="solar_env.environment.vector_env:SolarArrayVectorEnv",
                kwargs={"scenario": scenario},
            )
