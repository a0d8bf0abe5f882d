"""Controllers by name: rows of the table of laws, shipped policies, and run folders."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import gymnasium

from agents.comparison.receding_horizon import RecedingHorizon
from agents.environments import INTERFACE
from agents.laws.baselines import episodes_spent, make_baseline
from agents.laws.table import LAWS, TUNABLE
from agents.learning import runs
from agents.policies import shipped
from agents.policies.policy import ShippedPolicy
from agents.torque_laws import Controller

SEARCH_AROUND = "receding-horizon:"
"""What the spec of a search with foresight begins with, before the controller that it begins at."""


@dataclass(frozen=True)
class NamedController(ABC):
    """A controller as a command line names it.

    Attributes:
        name: Name in tables and figures.
        spec: Name in `agents.laws.table.LAWS`, shipped policy, or run folder; or one of these after `SEARCH_AROUND`.

    Raises:
        FileNotFoundError: By the methods, where there is no such run or it has no policy.
        ValueError: By `load` and `effort`, where the controller does not fit the environment.
    """

    name: str
    spec: str

    @abstractmethod
    def load(self, env: gymnasium.Env) -> Controller:
        """Make the controller for `env`."""

    def files(self) -> list[Path]:
        """List the files that determine a trained controller; none for a law."""
        return []

    def training(self) -> Mapping[str, Any]:
        """Return the record of the training, with `env_id` and `env_kwargs`; empty for a law.

        Raises:
            FileNotFoundError, ValueError: A file is missing or damaged; the message names it.
        """
        return {}

    @abstractmethod
    def effort(self, env_id: str, model: str) -> str | None:
        """Say how much was simulated to tune or train the controller for an environment; None for nothing."""

    @property
    def resolved(self) -> str:
        """Spec that names the same controller from any working directory."""
        return self.spec

    def interface(self) -> dict[str, Any]:
        """Return the environment keywords of the training that say what is observed and what an action is."""
        trained = self.training().get("env_kwargs", {})
        return {name: trained[name] for name in INTERFACE if name in trained}


class _Law(NamedController):
    """A controller without learning."""

    def load(self, env: gymnasium.Env) -> Controller:
        return make_baseline(self.spec, env)

    def effort(self, env_id: str, model: str) -> str | None:
        return f"{episodes_spent(self.spec, env_id, model):,} episodes" if self.spec in TUNABLE else None


class _Search(NamedController):
    """A search with foresight around another controller, `receding-horizon:OTHER`."""

    @property
    def base(self) -> NamedController:
        return parse_controller(self.spec.removeprefix(SEARCH_AROUND))

    def load(self, env: gymnasium.Env) -> Controller:
        return RecedingHorizon(env, self.base.load(env))

    def files(self) -> list[Path]:
        return self.base.files()

    def training(self) -> Mapping[str, Any]:
        return self.base.training()

    def effort(self, env_id: str, model: str) -> str | None:
        return self.base.effort(env_id, model)

    @property
    def resolved(self) -> str:
        return SEARCH_AROUND + self.base.resolved


class _Policy(NamedController):
    """A trained policy as arrays: one that comes with this package, the best one of a run, or an exported one."""

    @property
    def folder(self) -> Path:
        return shipped.SHIPPED / self.spec if self.spec in shipped.available() else Path(self.spec)

    def policy(self) -> ShippedPolicy:
        if not any((self.folder / name).is_file() for name in (shipped.DESCRIPTION, runs.CONFIG)):
            known = ", ".join((*LAWS, *shipped.available()))
            raise FileNotFoundError(
                f"no controller {self.spec!r}: it is no run folder of train.py, and none of {known}"
            )
        return runs.best_policy(self.folder)

    def load(self, env: gymnasium.Env) -> Controller:
        policy = self.policy()
        policy.check(env)
        return policy

    def files(self) -> list[Path]:
        self.policy()
        return [self.folder / name for name in runs.POLICY]

    def training(self) -> Mapping[str, Any]:
        return vars(self.policy().description)

    def effort(self, env_id: str, model: str) -> str:
        steps = self.training()["training_steps"]
        return f"{runs.steps_taken(self.folder) if (self.folder / runs.CONFIG).is_file() else steps:,} steps"

    @property
    def resolved(self) -> str:
        return self.spec if self.spec in shipped.available() else str(self.folder.resolve())


def parse_controller(text: str) -> NamedController:
    """Read `NAME=SPEC`, or SPEC alone: a law or policy then names itself, a run folder has its last component as name.

    A folder that exists is one, whatever characters are in its name.

    Raises:
        ValueError: A search is to begin at nothing, or at another search.
    """
    name, separator, spec = text.partition("=")
    if not separator or Path(text).is_dir():
        name, spec = Path(text).name or Path(text).resolve().name, text
    if f"{spec}:" == SEARCH_AROUND and not Path(spec).is_dir():
        raise ValueError(f"{spec!r} searches around another controller: name it, as in {SEARCH_AROUND}servo")
    if spec.startswith(SEARCH_AROUND):
        if isinstance(parse_controller(spec.removeprefix(SEARCH_AROUND)), _Search):
            raise ValueError(f"{spec!r} is a search around a search; name a law, a shipped policy or a run folder")
        return _Search(name if separator else text, spec)
    return (_Law if spec in LAWS else _Policy)(name, spec)


def parse_controllers(texts: Sequence[str]) -> list[NamedController]:
    """Read controllers that are to be compared, see `parse_controller`; several runs may share a name that is given.

    Raises:
        ValueError: One is given twice, or different controllers have a name in common that they have not been given.
    """
    named = [parse_controller(text) for text in texts]
    pairs = [(controller.name, controller.resolved) for controller in named]
    for name, spec in pairs:
        if (times := pairs.count((name, spec))) > 1:
            raise ValueError(f"{name} is given {times} times; its episodes would count as many times")
        if spec in LAWS and any(other == name and of != spec for other, of in pairs):
            raise ValueError(f"{spec} and another controller are both called {name}; give the other its own name")
    specs: dict[str, str] = {}
    for controller in (controller for text, controller in zip(texts, named, strict=True) if "=" not in text):
        if specs.setdefault(controller.name, controller.spec) != controller.spec:
            raise ValueError(
                f"{specs[controller.name]} and {controller.spec} are both called {controller.name}; name them, as in "
                f"first={controller.spec}"
            )
    return named
