"""Gymnasium ids of the environments, with string entry points so that registering imports nothing."""

from __future__ import annotations

import gymnasium

# Id -> entry points of the single and of the vector environment.
ENVIRONMENTS = {"solar_env/Deploy-v0": ("solar_env.env:SolarArrayEnv", "solar_env.vector_env:SolarArrayVectorEnv")}


def register_environments() -> None:
    """Register every id once."""
    for name, (single, vector) in ENVIRONMENTS.items():
        if name not in gymnasium.registry:
            gymnasium.register(id=name, entry_point=single, vector_entry_point=vector)
