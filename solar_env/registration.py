"""Gymnasium ids of the environments, with string entry points so that registering imports nothing."""

from __future__ import annotations

import gymnasium

ENVIRONMENTS = {"solar_env/Deploy-v0": "solar_env.env:SolarArrayEnv"}


def register_environments() -> None:
    """Register every id once."""
    for name, entry_point in ENVIRONMENTS.items():
        if name not in gymnasium.registry:
            gymnasium.register(id=name, entry_point=entry_point)
