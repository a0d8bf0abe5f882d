"""Options that several commands of the agents have in common."""

import dataclasses
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import gymnasium

from agents.environments import DEFAULT_ENV_ID, episode_seeds, make_env, with_model, with_sampling
from solar_env.commands.arguments import Assignments as Assignments
from solar_env.commands.arguments import CommandRecord as CommandRecord
from solar_env.commands.arguments import WorkerOptions as WorkerOptions

if TYPE_CHECKING:
    from agents.comparison.controllers import NamedController


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


@dataclasses.dataclass
class EpisodeOptions(ModelOptions):
    """The evaluation episode that controllers are shown in."""

    seed: int = 0
    """chooses the evaluation episode"""
    env_id: str = DEFAULT_ENV_ID
    """environment id"""
    quiet: bool = False
    """no progress bar"""

    @property
    def episode_seed(self) -> int:
        """Seed of the episode."""
        return episode_seeds("evaluation", self.seed, 1)[0]

    def prepare(self, controllers: Sequence[str], **keywords: Any) -> "list[tuple[NamedController, gymnasium.Env]]":
        """Return controllers by their names in words, and the environment of each, with some keywords more.

        Raises:
            ValueError, OSError: There is none of a name, or its files cannot be loaded.
        """
        from agents.comparison.controllers import parse_controllers
        from agents.comparison.suites import MODEL

        asked = {**self.keywords(self.env_id, MODEL), **keywords}
        named = parse_controllers(controllers)
        for controller in named:
            controller.check()
        return [(one, make_env(self.env_id, with_sampling({**asked, **one.interface()}, self.env_id))) for one in named]


@dataclasses.dataclass
class ShowingOptions(EpisodeOptions):
    """Controllers that are shown in one episode, the same for all."""

    controllers: list[str] = dataclasses.field(default_factory=lambda: ["passive", "servo"])
    """laws, shipped policies and run folders, see solar-env evaluate --help; each once"""


@dataclasses.dataclass
class TrainingOptions(WorkerOptions, CommandRecord):
    """Settings of trainings in place of those in agents/configs."""

    timesteps: int | None = None
    """environment steps of every training; by default the number in agents/configs"""
    hyperparams: Assignments = dataclasses.field(default_factory=dict)
    """hyperparameters in place of those in agents/configs, for example learning_rate=1e-3"""
