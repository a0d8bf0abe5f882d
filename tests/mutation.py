"""Mutation testing of contact, friction, wear, joints, step control and torque laws: would a test notice an error?

`python tests/mutation.py` changes every module of the table in one place after the other, with the operators of
cosmic-ray, runs the tests of its row on each change, and prints a table and the changes that no test noticed.
`--only wear` takes the modules with this in their names, `--most 100` no more than so many changes of a module, drawn
by `--seed`. Kernels run as plain Python; every attempt is a process of its own, forked from one that has the libraries
loaded, which imports the changed module from memory: no file is touched.

An operator of arithmetic is replaced by its opposite, a comparison by its neighbour at the bound and by its opposite,
a number by the ones above and below; `and` and `or` are swapped; signs, `not`, the turns of a loop and what ends it
are taken out, conditions turned round. A change that no test can notice is explained in the row.
"""

import argparse
import ast
import difflib
import os
import random
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec, SourceFileLoader
from importlib.util import spec_from_file_location
from pathlib import Path
from types import CodeType, ModuleType
from typing import Any

os.environ["NUMBA_DISABLE_JIT"] = "1"  # read as Numba is imported
os.environ["PYTEST_DISABLE_PLUGIN_AUTOLOAD"] = "1"

# Loaded before processes are forked.
import gymnasium  # noqa: F401
import hypothesis  # noqa: F401
import matplotlib.pyplot  # noqa: F401
import numba  # noqa: F401
import pytest
import scipy.integrate  # noqa: F401
from cosmic_ray.mutating import mutate_code
from cosmic_ray.plugins import get_operator

ROOT = Path(__file__).parents[1]
OPERATORS = (
    *(f"ReplaceBinaryOperator_{swap}" for swap in ("Add_Sub", "Sub_Add", "Mul_Div", "Div_Mul", "Pow_Mul", "Mod_Div")),
    *(f"ReplaceComparisonOperator_{swap}" for swap in ("Lt_LtE", "Lt_GtE", "LtE_Lt", "LtE_Gt", "Gt_GtE", "Gt_LtE")),
    *(f"ReplaceComparisonOperator_{swap}" for swap in ("GtE_Gt", "GtE_Lt", "Eq_NotEq", "NotEq_Eq")),
    *(f"ReplaceComparisonOperator_{swap}" for swap in ("Is_IsNot", "IsNot_Is")),
    "ReplaceUnaryOperator_Delete_USub",
    "ReplaceUnaryOperator_Delete_Not",
    "ReplaceUnaryOperator_Delete_Invert",
    "AddNot",
    "ReplaceAndWithOr",
    "ReplaceOrWithAnd",
    "ReplaceTrueWithFalse",
    "ReplaceFalseWithTrue",
    "ReplaceBreakWithContinue",
    "ReplaceContinueWithBreak",
    "NumberReplacer",
    "ZeroIterationForLoop",
)
LEAST_SECONDS = 10.0
# Nothing that costs time: no one reads what a failing test says.
QUICK = ("-x", "-q", "--assert=plain", "-p", "no:cacheprovider", "-p", "no:unraisableexception")


@dataclass(frozen=True)
class Row:
    """A module, the tests that are to notice its changes, and why none notices some of them.

    Attributes:
        module: path below the root.
        tests: words for pytest.
        explained: part of a changed line, as it is after the change -> why it makes no difference.
    """

    module: str
    tests: tuple[str, ...]
    explained: dict[str, str] = field(default_factory=dict)


JOINTS = "tests/mechanics/joints/"
# Those that simulate for long.
LONG = ("block_leaves", "undamped_impact", "volume_worn", "turning_journal", "turning_bearing")
SHORT = ("-k", " and ".join(f"not {part}" for part in LONG))
CONTACT = (JOINTS + "test_contact_laws.py", *SHORT)
FRICTION = (JOINTS + "test_friction_laws.py",)
JOINT = (JOINTS + "test_joint.py",)
INTEGRATORS = "tests/mechanics/integrators/"
STEPS = (
    INTEGRATORS + "test_step_control.py",
    INTEGRATORS + "test_impact_steps.py",
    INTEGRATORS + "test_adaptive.py::test_a_latching_is_found_whatever_the_step",
    "-k",
    "not peak_of_an_impact and not thousand_further",
)
LAWS = ("tests/agents/laws/test_baselines.py", "-k", "not the_tuned_soft_start")
ROWS = (
    *(
        Row(f"solar_env/mechanics/joints/contact/{name}.py", CONTACT)
        for name in (
            "surfaces",
            "power_law",
            "hertz",
            "flores",
            "lankarani_nikravesh",
            "pereira",
            "restitution",
            "laws",
            "normal_force",
        )
    ),
    *(
        Row(f"solar_env/mechanics/joints/friction/{name}.py", FRICTION)
        for name in ("ramp", "brown_mcphee", "laws", "friction_share")
    ),
    Row("solar_env/mechanics/joints/wear.py", (JOINTS + "test_wear.py", *SHORT)),
    Row("solar_env/mechanics/joints/sliding.py", JOINT),
    Row("solar_env/mechanics/joints/joint.py", JOINT),
    Row("solar_env/mechanics/numerics/step_size.py", ("tests/mechanics/numerics/test_step_size.py",)),
    *(Row(f"solar_env/mechanics/integrators/{name}.py", STEPS) for name in ("events", "acceptance", "adaptive")),
    *(
        Row(f"agents/laws/{name}.py", LAWS)
        for name in (
            "brake",
            "damper",
            "open_loop",
            "pd",
            "servo",
            "shaped",
            "soft_start",
            "residual",
            "receding_horizon",
            "baselines",
            "table",
        )
    ),
    Row("agents/torque_laws.py", LAWS),
)


@dataclass(frozen=True)
class Change:
    """A change of a module: its code, and the lines that differ."""

    code: str
    before: str
    after: str
    line: int


class Changed(MetaPathFinder, SourceFileLoader):
    """Importer of one module from changed code."""

    def __init__(self, name: str, path: Path, change: Change) -> None:
        super().__init__(name, str(path))
        self.change = change

    def find_spec(self, name: str, path: Any, target: ModuleType | None = None) -> ModuleSpec | None:
        return spec_from_file_location(name, self.path, loader=self) if name == self.name else None

    def get_code(self, fullname: str) -> CodeType:
        return compile(self.change.code, self.path, "exec")


def program(source: str) -> str:
    """What a source does, without what changes nothing in plain Python: decorators, annotations, wishes of kernels."""
    tree = ast.parse(source)
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            node.decorator_list = []
        if isinstance(node, ast.FunctionDef):
            node.returns = None
        elif isinstance(node, ast.arg | ast.AnnAssign):
            node.annotation = ast.Constant(None)
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "kernel":
            node.keywords = []
    return ast.dump(tree)


def changes(source: str) -> Iterator[Change]:
    """All changes of a source; those that leave the program as it is are left out."""
    seen = {program(source)}
    for name in OPERATORS:
        operator = get_operator(f"core/{name}")()
        occurrence = 0
        while (code := mutate_code(source, operator, occurrence)) is not None:
            occurrence += 1
            try:
                done = program(code)
            except SyntaxError:
                continue
            if done not in seen:
                seen.add(done)
                old, new = source.splitlines(), code.splitlines()
                matcher = difflib.SequenceMatcher(None, old, new, autojunk=False)
                _, i, j, k, m = next(step for step in matcher.get_opcodes() if step[0] != "equal")
                yield Change(code, "\n".join(old[i:j]).strip(), "\n".join(new[k:m]).strip(), i + 1)


def passes(row: Row, change: Change | None, limit: float) -> bool:
    """Whether the tests of a row pass, within a time [s], where its module is changed."""
    process = os.fork()
    if process == 0:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, 1)
        os.dup2(nowhere, 2)
        if change is not None:
            name = row.module.removesuffix(".py").replace("/", ".")
            sys.meta_path.insert(0, Changed(name, ROOT / row.module, change))
        os._exit(int(pytest.main([*QUICK, *row.tests])))
    end = time.monotonic() + limit
    while time.monotonic() < end:
        done, status = os.waitpid(process, os.WNOHANG)
        if done:
            return os.waitstatus_to_exitcode(status) == 0
        time.sleep(0.01)
    os.kill(process, 9)
    os.waitpid(process, 0)
    return False


def measure(row: Row, most: int | None, chance: random.Random) -> tuple[int, int, int, list[Change]]:
    """Numbers of changes of a module, of those tried and of those explained, and those that nothing noticed."""
    found = list(changes((ROOT / row.module).read_text()))
    tried = found if most is None or most >= len(found) else chance.sample(found, most)
    begun = time.monotonic()
    if not passes(row, None, 600.0):
        sys.exit(f"{row.module}: its tests fail without a change")
    limit = max(LEAST_SECONDS, 5.0 * (time.monotonic() - begun))
    survivors = [change for change in tried if passes(row, change, limit)]
    left = [change for change in survivors if not any(part in change.after for part in row.explained)]
    return len(found), len(tried), len(survivors) - len(left), left


def main() -> None:
    """Print the table; see the top of the file."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="")
    parser.add_argument("--most", type=int)
    parser.add_argument("--seed", type=int, default=0)
    args = parser.parse_args()
    os.chdir(ROOT)
    print("| module | changes | tried | noticed | explained | left |\n|---|---|---|---|---|---|", flush=True)
    for row in ROWS:
        if args.only in row.module:
            number, tried, explained, left = measure(row, args.most, random.Random(args.seed))
            noticed = tried - explained - len(left)
            print(f"| {row.module} | {number} | {tried} | {noticed} | {explained} | {len(left)} |", flush=True)
            for change in left:
                print(f"{row.module}:{change.line}\n  - {change.before}\n  + {change.after}", flush=True)


if __name__ == "__main__":
    main()
