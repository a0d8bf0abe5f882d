"""Fuzzing of everything that reads what users hand over: files, parameters, command lines.

`python tests/fuzzing.py TARGET --seconds 3600 --corpus FOLDER` searches with atheris, guided by coverage, from the
inputs that the target begins with and those of the folder, which keeps what it finds; `--list` names the targets. An
input that ends in anything but the documented exceptions ends the search and is kept. The suite tries a few thousand
changed inputs of every target.
"""

import argparse
import contextlib
import io
import json
import sys
import tempfile
import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import FunctionType

import numpy as np

from solar_env.environment.registration import DEPLOY

FOLDER = Path(tempfile.mkdtemp(prefix="fuzzing-"))
# Packages whose branches guide a search: all that read, and none with kernels, which must not be instrumented.
READERS = [
    "agents.learning.configurations",
    "agents.learning.runs",
    "agents.learning.storage",
    "agents.policies",
    "solar_env.array.ladder",
    "solar_env.array.parameters",
    "solar_env.commands.arguments",
    "solar_env.mechanics.running.trajectory",
    "solar_env.studies.common.tables",
    "solar_env.support",
]


@dataclass(frozen=True)
class Target:
    """A reader of bytes, the errors that may come of it, and the bytes that a search begins with."""

    read: Callable[[bytes], object]
    documented: tuple[type[BaseException], ...]
    beginnings: Callable[[], list[bytes]]


def written(name: str, content: bytes) -> Path:
    path = FOLDER / name
    path.write_bytes(content)
    return path


def trajectory(content: bytes) -> None:
    from solar_env.mechanics.running.trajectory import Trajectory

    loaded = Trajectory.load(written("run.npz", content), most_bytes=2**20)
    json.dumps(loaded.summary())


def a_trajectory() -> list[bytes]:
    from solar_env.array.deployment import simulate

    simulate(model="rigid-ideal", duration=0.02, output_step=0.01).save(FOLDER / "whole.npz")
    return [(FOLDER / "whole.npz").read_bytes()]


SPLIT = b"\n---\n"  # between the two files of a policy


def policy(content: bytes) -> None:
    from agents.policies import shipped

    description, _, arrays = content.partition(SPLIT)
    written(shipped.DESCRIPTION, description)
    written(shipped.ARRAYS, arrays)
    loaded = shipped.load_shipped(FOLDER)
    with np.errstate(all="ignore"):
        loaded.act(np.zeros(len(loaded.description.observation_names), np.float32))


def policies() -> list[bytes]:
    from agents.policies import shipped

    folders = [shipped.SHIPPED / name for name in shipped.available()]
    return [
        SPLIT.join((folder / name).read_bytes() for name in (shipped.DESCRIPTION, shipped.ARRAYS)) for folder in folders
    ]


def run_folder(content: bytes) -> None:
    from agents.learning import runs

    written(runs.CONFIG, content)
    runs.stored_configuration(FOLDER)
    runs.steps_taken(FOLDER)


def a_run() -> list[bytes]:
    record = {"algo": "ppo", "env_id": DEPLOY, "env_kwargs": {}, "seed": 0, "n_envs": 1}
    record |= {
        "timesteps": 9,
        "hyperparameters": {},
        "timesteps_before": 0,
        "resumed_from": None,
        "versions": {},
        "command": "",
    }
    return [json.dumps(record).encode()]


def checkpoint(content: bytes) -> None:
    from agents.learning.storage import unpacked

    unpacked(written("checkpoint.npz", content))


def a_checkpoint() -> list[bytes]:
    from agents.learning.storage import packed

    return [packed({"timesteps": 1, "lanes": [np.zeros(2), (None, "text")]}), packed({})]


def table(content: bytes) -> None:
    from solar_env.studies.common.tables import read_table

    found = read_table(written("table.csv", content))
    found.column("error")


def ladder(content: bytes) -> None:
    from solar_env.array.ladder import QUESTIONS, cheapest, read_answers

    cheapest(read_answers(written("ladder.csv", content)), next(iter(QUESTIONS)), 0.5)


def a_ladder() -> list[bytes]:
    from solar_env.array.ladder import PACKAGED_TABLE

    return [PACKAGED_TABLE.read_bytes()]


def results(content: bytes) -> None:
    from solar_env.support.campaigns import Campaign

    Campaign(json.dumps, [{"a": 1}], written("results.jsonl", content))


def parameters(content: bytes) -> None:
    from solar_env.array import ArrayParameters
    from solar_env.support.plain_arrays import parse_json

    changes = parse_json(content)
    ArrayParameters().with_changes(changes if isinstance(changes, dict) else {"clearance": changes})


def command_line(content: bytes) -> None:
    from solar_env.commands.arguments import parse_arguments
    from solar_env.commands.simulate import Args

    with contextlib.redirect_stderr(io.StringIO()), contextlib.redirect_stdout(io.StringIO()):
        parse_arguments(Args, content.decode(errors="replace").split("\n"))


def array_file(content: bytes) -> None:
    from solar_env.array import read_parameters

    read_parameters(written("array.toml", content))


TARGETS = {
    "trajectory": Target(trajectory, (ValueError,), a_trajectory),
    "policy": Target(policy, (ValueError, FileNotFoundError), policies),
    "run-folder": Target(run_folder, (ValueError,), a_run),
    "checkpoint": Target(checkpoint, (ValueError,), a_checkpoint),
    "table": Target(table, (ValueError,), lambda: [b"# command: x\nmethod,error,wall_s\nours,0.1,2\nother,1e-3,5\n"]),
    "ladder": Target(ladder, (ValueError,), a_ladder),
    "results": Target(results, (ValueError,), lambda: [b'{"code": "0"}\n{"cell": {"a": 1}, "result": 2}\n']),
    "parameters": Target(
        parameters, (ValueError,), lambda: [b'{"clearance": [1e-4, 2e-4], "contact_law": "flores"}', b"1e-4"]
    ),
    "array-file": Target(
        array_file, (ValueError,), lambda: [b"clearance = [1e-4, 2e-4]\n[randomize]\nspring_stiffness = [0.09, 0.1]\n"]
    ),
    "command-line": Target(
        command_line,
        (SystemExit,),
        lambda: [b"--set\nclearance=1e-4,2e-4\n--duration\n3\n--json\n-", b"--model\nrigid-ideal\nrandomize={'a': 1}"],
    ),
}


def try_input(target: Target, content: bytes) -> bool:
    """Read an input; whether it was refused as documented. Anything else is raised."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            target.read(content)
        except target.documented:
            return True
    return False


def functions_of(packages: Sequence[str]) -> Iterator[FunctionType]:
    """All functions of the modules in packages that have been imported, with those of their classes."""
    for name, module in list(sys.modules.items()):
        if any(f"{name}.".startswith(f"{package}.") for package in packages):
            spaces = [vars(module), *(vars(kind) for kind in vars(module).values() if isinstance(kind, type))]
            for value in (value for space in spaces for value in list(space.values())):
                function = getattr(value, "fget", None) or getattr(value, "__func__", value)  # of what decorates it
                if isinstance(function, FunctionType) and function.__module__ == name:
                    yield function


def main() -> None:
    """Search; see the top of the file."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("target", nargs="?", choices=TARGETS)
    parser.add_argument("--seconds", type=int, default=60)
    parser.add_argument("--corpus", type=Path, default=Path(tempfile.gettempdir()) / "corpus")
    parser.add_argument("--list", action="store_true")
    args = parser.parse_args()
    if args.list or args.target is None:
        print("\n".join(TARGETS))
        return
    import atheris

    target, corpus = TARGETS[args.target], args.corpus / args.target
    corpus.mkdir(parents=True, exist_ok=True)
    for number, content in enumerate(target.beginnings()):
        (corpus / f"beginning-{number}").write_bytes(content)
        try_input(target, content)
    for function in functions_of(READERS):
        atheris.instrument_func(function)
    options = [f"-max_total_time={args.seconds}", f"-artifact_prefix={corpus}/failed-", "-print_final_stats=1"]
    atheris.Setup([sys.argv[0], *options, str(corpus)], lambda content: (try_input(target, content), None)[1])
    atheris.Fuzz()


if __name__ == "__main__":
    main()
