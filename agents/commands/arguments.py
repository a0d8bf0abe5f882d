"""Options that several commands of `agents` have in common."""

import dataclasses
from collections.abc import Mapping

from agents.environments import Keywords
from solar_env.commands.arguments import Assignments


@dataclasses.dataclass
class ModelOptions:
    """Options that choose the physics of a command's environments."""

    model: str | None = None
    """level of the model, such as rigid-clearance or "flexible-clearance:8 modes"; see above for the default"""
    env_kwargs: Assignments = dataclasses.field(default_factory=dict)
    """environment keywords, for example torque_limit=0.3 observation=privileged"""

    def keywords(self, default: Mapping[str, object] | None = None) -> Keywords:
        """Return the environment keywords that the options `model` and `env_kwargs` give; they override `default`.

        Raises:
            ValueError: Both options name a model, and the two models differ.
        """
        model, given = self.model, self.env_kwargs
        if model is not None and given.get("model", model) != model:
            raise ValueError(f"--model {model} contradicts --env-kwargs model={given['model']}; give one of them")
        return {**(default or {}), **given, **({} if model is None else {"model": model})}
