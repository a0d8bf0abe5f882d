"""Options that several commands have in common."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from agents.arguments import Assignments
from agents.environments import DEFAULT_ENV_ID, with_model
from solar_env.support.campaigns import Workers


@dataclass
class WorkerOptions:
    """Processes or machines that a command runs on, and its progress bars."""

    jobs: int | None = None
    """processes; None: one per processor"""
    cluster: str | None = None
    """ray: run on the Ray cluster that this machine belongs to"""
    quiet: bool = False
    """no progress bars"""

    @property
    def workers(self) -> Workers:
        """The processes or machines.

        Raises:
            ValueError: The number of processes is not positive, or there is no such cluster.
        """
        return Workers(self.jobs, self.cluster)


@dataclass
class ModelOptions:
    """Physics of the environments of a command."""

    model: str | None = None
    """rigid-ideal, rigid-clearance, flexible-ideal, flexible-clearance or auto; None: see above"""
    elements: int | None = None
    """beam elements of each panel of a flexible model; None: see above, or 6 for a model that is named"""
    env_kwargs: Assignments = field(default_factory=dict)
    """environment keywords, for example torque_limit=0.3 observation=privileged"""

    def keywords(self, env_id: str = DEFAULT_ENV_ID, default: Mapping[str, Any] | None = None) -> dict[str, Any]:
        """Return the environment keywords that the options ask for, see `with_model`."""
        return with_model(self.env_kwargs, self.model, self.elements, env_id, default)


@dataclass
class TrainingOptions(WorkerOptions):
    """Settings of trainings in place of those in agents/configs."""

    timesteps: int | None = None
    """environment steps of every training; None: the number in agents/configs"""
    landings: int | None = None
    """episodes of the law alone with whose landings training begins; None: the number in agents/configs"""
    hyperparams: Assignments = field(default_factory=dict)
    """hyperparameters in place of those in agents/configs, for example learning_rate=1e-3"""
