"""Gymnasium ids of the environments, with string entry points so that registering imports nothing."""

import gymnasium

# Id -> scenario, and version of the reward's prices.
ENVIRONMENTS = {
    "solar_env/Deploy-v1": ("nominal", "v1"),
    "solar_env/DeployRandomised-v1": ("randomised", "v1"),
    "solar_env/Deploy-v0": ("nominal", "v0"),
    "solar_env/DeployRandomised-v0": ("randomised", "v0"),
}

# Ids of the present version; Gymnasium warns whoever makes one of the others.
CURRENT = tuple(name for name in ENVIRONMENTS if name.endswith("-v1"))


def register_environments() -> None:
    """Register every id once."""
    for name, (scenario, prices) in ENVIRONMENTS.items():
        if name not in gymnasium.registry:
            gymnasium.register(
                id=name,
                entry_point="solar_env.environment.env:SolarArrayEnv",
                vector_entry_point="solar_env.environment.vector_env:SolarArrayVectorEnv",
                kwargs={"scenario": scenario, "prices": prices},
            )
