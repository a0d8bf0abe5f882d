"""Options that several commands of the agents have in common."""

import dataclasses
from collections.abc import Mapping
from typing import Any

from agents.environments import DEFAULT_ENV_ID, with_model
from solar_env.commands.arguments import Assignments


@dataclasses.dataclass
class ModelOptions:
    """Physics of the environments of a command."""

    model: str | None = None
    """rigid-ideal, rigid-clearance, flexible-ideal, flexible-clearance or auto; by default see above"""
    panels: str | None = None
    """modal or ancf: model of flexible panels; by default what elements or modes ask for, else modal"""
    elements: int | None = None
    """beam elements of each panel; by default 6 where panels are ancf"""
    modes: int | None = None
    """bending modes of each modal panel; by default see above, or 32 for a model that is named"""
    env_kwargs: Assignments = dataclasses.field(default_factory=dict)
    """environment keywords, for example torque_limit=0.3 observation=privileged"""

    def keywords(self, env_id: str = DEFAULT_ENV_ID, default: Mapping[str, Any] | None = None) -> dict[str, Any]:
        """Return the environment keywords that the options ask for, see `with_model`."""
        return with_model(
            self.env_kwargs, self.model, self.elements, env_id, default, panels=self.panels, modes=self.modes
        )
