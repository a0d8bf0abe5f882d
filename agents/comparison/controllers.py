"""Controllers by name: torque laws, shipped policies, run folders, and saved models."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import gymnasium

from agents.comparison.receding_horizon import RecedingHorizon
from agents.environments import INTERFACE, OF_LAWS, Keywords
from agents.laws.baselines import make_baseline
from agents.laws.table import LAWS
from agents.learning import runs
from agents.torque_laws import Controller

SEARCH_AROUND = "receding-horizon:"
"""Prefix that names a receding-horizon search; the controller at which the search starts follows."""


@dataclass(frozen=True)
class NamedController:
    """A controller as a command line names it.

    Attributes:
        name: Name in tables and figures.
        spec: Name in `agents.laws.table.LAWS`, shipped policy, run folder, or .zip file of Stable-Baselines3's
            `model.save`; or one of these after "receding-horizon:", for a search around this controller.

    Raises:
        FileNotFoundError: From the methods, if the run does not exist or has no policy.
        ValueError: From the methods, if a file is damaged or, in `load`, the controller does not fit the environment.
    """

    name: str
    spec: str

    @property
    def base(self) -> str:
        """Specification `spec` without the prefix "receding-horizon:", which means a search around a controller."""
        return self.spec.removeprefix(SEARCH_AROUND)

    @property
    def folder(self) -> Path:
        """Folder of a trained policy."""
        return runs.folder_of(self.base)

    @property
    def resolved(self) -> str:
        """Specification that names the same controller from any working directory."""
        named = self.base in LAWS or self.base in runs.shipped()
        return self.spec if named else self.spec.removesuffix(self.base) + str(self.folder.resolve())

    @property
    def _is_model(self) -> bool:
        return self.base.endswith(".zip")

    def load(self, env: gymnasium.Env) -> Controller:
        """Load the controller for `env`, after checking that a trained policy fits the environment."""
        controller: Controller
        if self.base in LAWS:
            controller = make_baseline(self.base, env)
        else:
            controller = runs.best_policy(self.base)
            if training := self.training():
                runs.check(training, env)
            controller.check(env)
        return RecedingHorizon(env, controller) if self.spec != self.base else controller

    def files(self) -> list[Path]:
        """List the files that determine a trained controller; a law has no files."""
        if self.base in LAWS:
            return []
        files = [Path(self.base)] if self._is_model else [self.folder / runs.CONFIG, self.folder / runs.BEST]
        return [path for path in files if path.is_file()]

    def training(self) -> runs.Configuration | None:
        """Read the configuration of the training; None for a law or a saved model, which have no configuration."""
        if self.base in LAWS or self._is_model:
            return None
        if not (self.folder / runs.CONFIG).is_file():
            if Path(f"{self.base}.zip").is_file():
                raise FileNotFoundError(f"no controller {self.base!r}; did you mean the saved model {self.base}.zip?")
            known = ", ".join((*LAWS, *runs.shipped()))
            raise FileNotFoundError(
                f"no controller {self.base!r}: it is no run folder of train.py, no model.zip, and none of {known}"
            )
        return runs.read_config(self.folder)

    def interface(self) -> Keywords:
        """Return the environment keywords of observation, action and control period that the controller needs."""
        if self.base in LAWS:
            return dict(OF_LAWS)
        training = self.training()
        trained = training.env_kwargs if training else {}
        return {name: trained[name] for name in INTERFACE if name in trained}


def parse_controller(text: str) -> NamedController:
    """Return the controller for `NAME=SPEC` or SPEC: a law, a shipped policy, a run folder, a model.zip or a search.

    A search, "receding-horizon:SPEC", improves the actions of controller SPEC; its default NAME is this whole text. The
    other default NAMEs are the law's or policy's name, or the path's last component. The path of an existing folder is
    always a SPEC alone, even if it contains "=".

    Raises:
        ValueError: SPEC is "receding-horizon" alone, or a search around another search.
    """
    name, separator, spec = text.partition("=")
    if not separator or Path(text).is_dir():
        name, spec = Path(text).name or Path(text).resolve().name, text
    search = spec.startswith(SEARCH_AROUND)
    base = spec.removeprefix(SEARCH_AROUND)
    if not Path(spec).is_dir() and f"{base}:".startswith(SEARCH_AROUND):
        raise ValueError(
            f"{spec!r} searches around another controller, and not around a search: name it, as in {SEARCH_AROUND}servo"
        )
    return NamedController(text if search and not separator else name, spec)


def parse_controllers(texts: Sequence[str]) -> list[NamedController]:
    """Return the controllers for texts `NAME=SPEC` or SPEC; SPEC is, for example, a torque law or a run folder.

    Trained policies that get the same NAME count as runs of one controller; `parse_controller` describes all texts.

    Raises:
        ValueError: A controller is given twice, or two share a name. Policies may share one that NAME= gives to each.
    """
    named = [parse_controller(text) for text in texts]
    pairs = [(controller.name, controller.resolved) for controller in named]
    for (name, spec), text in zip(pairs, texts, strict=True):
        if (times := pairs.count((name, spec))) > 1:
            raise ValueError(f"{name} is given {times} times; its episodes would count as many times")
        for (other, of), beside in zip(pairs, texts, strict=True):
            given = "=" in text and "=" in beside
            if other == name and of != spec and (not given or spec in LAWS):
                raise ValueError(f"{spec} and {of} are both called {name}; name them, as in first={spec}")
    return named
