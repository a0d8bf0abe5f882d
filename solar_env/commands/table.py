"""Lookup of commands and studies among the `[project.entry-points]` of this package and of other packages."""

import importlib
import tomllib
from importlib.metadata import entry_points
from typing import Any

from solar_env.support.docstrings import docstring
from solar_env.support.readme import PACKAGE
from solar_env.support.values import unknown_name

COMMANDS = "solar_env.commands"
STUDIES = "solar_env.studies"


def rows(group: str) -> dict[str, str]:
    """Map the names of a group's entry points to their modules; in a source tree, pyproject.toml adds entry points."""
    found = {point.name: point.value for point in entry_points(group=group)}
    source = PACKAGE.parent / "pyproject.toml"
    if source.is_file():
        found |= tomllib.loads(source.read_text(encoding="utf-8"))["project"]["entry-points"][group]
    return dict(sorted(found.items()))


def load(group: str, name: str) -> Any:
    """Import and return the module of the command or study `name`; an unknown name raises a ValueError.

    The group of entry points in which the name is looked up, `group`, is COMMANDS or STUDIES.
    """
    found = rows(group)
    if name not in found:
        kind, listed = ("command", "solar-env") if group == COMMANDS else ("study", "solar-env study")
        raise ValueError(f"{unknown_name(kind, name, found)} ({listed} --help lists them)")
    return importlib.import_module(found[name])


def summaries(group: str, what: str) -> dict[str, str]:
    """Map the names of a group's entry points to the first docstring paragraph of the object `what` in each module."""
    sentences = {name: docstring(module, what).partition("\n\n")[0] for name, module in rows(group).items()}
    return {name: sentence.replace("\n", " ").rstrip(".") for name, sentence in sentences.items()}
