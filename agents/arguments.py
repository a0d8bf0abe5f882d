"""Command lines from documented dataclasses, by tyro, and the options that several commands have in common."""

import ast
import contextlib
import dataclasses
import io
import re
import shlex
import sys
from collections.abc import Callable, Mapping, Sequence
from typing import Annotated, Any, TypeVar

import tyro

from agents.environments import DEFAULT_ENV_ID, with_model
from solar_env import SimulationError
from solar_env.support.campaigns import Workers

Arguments = TypeVar("Arguments")


def parse_assignments(pairs: Sequence[str]) -> dict[str, Any]:
    """Turn `key=value` or `key:value` strings into a dictionary.

    Values are Python literals (`ast.literal_eval`); a bare word such as `rigid-ideal` is a string.

    Raises:
        ValueError: A pair has no key or no value, repeats a key, or has a value that is neither.
    """
    result: dict[str, Any] = {}
    for pair in pairs:
        match = re.fullmatch(r"\s*(\w+)\s*[=:]\s*(.+?)\s*", pair, re.DOTALL)
        if match is None:
            raise ValueError(f"cannot read {pair!r}; write key=value, for example torque_limit=0.3")
        key, text = match.groups()
        if key in result:
            raise ValueError(f"{key!r} is given twice; give it once")
        try:
            result[key] = ast.literal_eval(text)
        except (ValueError, SyntaxError):
            if not re.fullmatch(r"[A-Za-z][\w./-]*", text):
                raise ValueError(
                    f"the value of {key!r}, {text!r}, is neither a Python literal nor a plain word; "
                    "quote the pair for the shell, for example \"randomize={'clearance': (1e-4, 2e-4)}\""
                ) from None
            result[key] = text
    return result


_PAIRS: tyro.constructors.PrimitiveConstructorSpec[dict[str, Any]] = tyro.constructors.PrimitiveConstructorSpec(
    nargs="*",
    metavar="[KEY=VALUE ...]",
    instance_from_str=parse_assignments,
    is_instance=lambda value: isinstance(value, dict),
    str_from_instance=lambda value: [f"{key}={item}" for key, item in value.items()],
)
Assignments = Annotated[dict[str, Any], _PAIRS]
"""Type of a field that takes `key=value` pairs, also when its option is repeated."""


@dataclasses.dataclass
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


@dataclasses.dataclass
class ModelOptions:
    """Physics of the environments of a command."""

    model: str | None = None
    """rigid-ideal, rigid-clearance, flexible-ideal, flexible-clearance or auto; None: see above"""
    panels: str | None = None
    """modal or ancf: model of flexible panels; None: what elements or modes ask for, else modal"""
    elements: int | None = None
    """beam elements of each panel; None: 6 where panels are ancf"""
    modes: int | None = None
    """bending modes of each modal panel; None: see above, or 24 for a model that is named"""
    env_kwargs: Assignments = dataclasses.field(default_factory=dict)
    """environment keywords, for example torque_limit=0.3 observation=privileged"""

    def keywords(self, env_id: str = DEFAULT_ENV_ID, default: Mapping[str, Any] | None = None) -> dict[str, Any]:
        """Return the environment keywords that the options ask for, see `with_model`."""
        return with_model(
            self.env_kwargs, self.model, self.elements, env_id, default, panels=self.panels, modes=self.modes
        )


@dataclasses.dataclass
class TrainingOptions(WorkerOptions):
    """Settings of trainings in place of those in agents/configs."""

    timesteps: int | None = None
    """environment steps of every training; None: the number in agents/configs"""
    landings: int | None = None
    """episodes of the law alone with whose landings training begins; None: the number in agents/configs"""
    hyperparams: Assignments = dataclasses.field(default_factory=dict)
    """hyperparameters in place of those in agents/configs, for example learning_rate=1e-3"""


def parse_arguments(cls: type[Arguments], argv: Sequence[str] | None = None, prog: str | None = None) -> Arguments:
    """Fill the dataclass `cls` from `argv` (default: the process's arguments).

    Field `env_id` becomes `--env-id`, its help is the string literal below it; a bool becomes a flag with its `--no-`
    form, a list takes any number of values, `Assignments` take `key=value` pairs. Wrong input ends the process with
    one sentence and status 2.
    """
    fields = dataclasses.fields(cls)  # type: ignore[arg-type]
    repeatable = {f"--{field.name.replace('_', '-')}" for field in fields if field.type is Assignments}
    words = _gathered(sys.argv[1:] if argv is None else argv, repeatable)
    report = io.StringIO()
    try:
        with contextlib.redirect_stderr(report):
            return tyro.cli(cls, args=words, prog=prog, config=(tyro.conf.DisallowNone,))
    except SystemExit as end:
        if end.code:
            print(f"error: {_first_sentence(report.getvalue())}; see --help", file=sys.stderr)
        raise


def _gathered(argv: Sequence[str], repeatable: set[str]) -> list[str]:
    """`argv` with all pairs of a `repeatable` option behind one mention of it: tyro keeps those of the last alone."""
    others: list[str] = []
    pairs: dict[str, list[str]] = {}
    place = others
    for word in argv:
        option, equals, value = word.partition("=")
        if option in repeatable:
            place = pairs.setdefault(option, [option])
            place += [value] if equals else []
        else:
            place = others if word.startswith("--") else place
            place.append(word)
    return [*others, *(word for of_option in pairs.values() for word in of_option)]


def _first_sentence(report: str) -> str:
    """Return the first paragraph of tyro's report, without title and box, which is of ASCII for some terminals."""
    lines = [line.strip("│╭╮╰╯ ") for line in report.splitlines()[1:]]
    text = "\n".join("" if set(line) <= set("─-") else line for line in lines)
    return " ".join(text.strip().split("\n\n")[0].split()).rstrip(".")


def command_line(prog: str, argv: Sequence[str] | None) -> str:
    """Return the command as it was typed, for the record; `argv` None: the process's arguments."""
    return shlex.join([*prog.split(), *(sys.argv[1:] if argv is None else argv)])


def run_command(main: Callable[[], object]) -> None:
    """Run `main`; input that it refuses, and runs that fail, end the process with their message and status 2."""
    try:
        main()
    except (ValueError, OSError, SimulationError) as error:
        print(f"error: {error}", file=sys.stderr)
        sys.exit(2)
