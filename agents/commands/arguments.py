"""Options that several commands of the agents have in common."""

import dataclasses
from collections.abc import Mapping
from typing import Any

from agents.environments import with_model
from solar_env.commands.arguments import Assignments


@dataclasses.dataclass
class ModelOptions:
    """Physics of the environments of a command."""

    model: str | None = None
    """its level, such as rigid-clearance or "flexible-clearance:8 modes"; by default see above"""
    env_kwargs: Assignments = dataclasses.field(default_factory=dict)
    """environment keywords, for example torque_limit=0.3 observation=privileged"""

    def keywords(self, default: Mapping[str, Any] | None = None) -> dict[str, Any]:
        """Return the environment keywords that the options ask for, see `with_model`."""
        return with_model(self.env_kwargs, self.model, default)
