"""Mutation testing: would a test notice an error in a module?

`python tests/mutation.py solar_env/mechanics/joints/wear.py tests/mechanics/joints/test_wear.py` changes the module in
one place after the other, with the operators of cosmic-ray, runs the tests on each change, and prints the changes that
no test noticed. Words after the module go to pytest, `-k NAMES` too; `--most 100`, before it, tries so many changes at
most, drawn by `--seed`. Kernels run as plain Python; every attempt is a process of its own, forked from one that has
the libraries loaded, which imports the changed module from memory: no file is touched.
"""

import argparse
import ast
import difflib
import math
import os
import random
import resource
import signal
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
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
LEAST_SECONDS = 20.0  # of processor time, for an attempt: its change may keep a loop from ending, which is noticed too
# Nothing that costs time: no one reads what a failing test says.
QUICK = ("-x", "-q", "--assert=plain", "-p", "no:cacheprovider", "-p", "no:unraisableexception")


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
                yield Change(code, _joined(old[i:j]), _joined(new[k:m]), i + 1)


def _joined(lines: list[str]) -> str:
    """Lines of code as one, without the blank that cosmic-ray sets before numbers."""
    return " ".join(line.strip() for line in lines).replace("( ", "(").replace("[ ", "[").replace("  ", " ")


def passes(module: str, tests: Sequence[str], change: Change | None, limit: float) -> tuple[bool, float]:
    """Whether the tests pass where a module is changed, and the processor time [s] that they took.

    They fail where they take more of it than `limit`, on a busy machine as on an idle one, or wait for ever.
    """
    process = os.fork()
    if process == 0:
        resource.setrlimit(resource.RLIMIT_CPU, (math.ceil(limit), math.ceil(limit) + 1))
        signal.alarm(math.ceil(20.0 * limit))
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, 1)
        os.dup2(nowhere, 2)
        if change is not None:
            name = module.removesuffix(".py").replace("/", ".")
            sys.meta_path.insert(0, Changed(name, ROOT / module, change))
        os._exit(int(pytest.main([*QUICK, *tests])))
    _, status, used = os.wait4(process, 0)
    return os.waitstatus_to_exitcode(status) == 0, used.ru_utime + used.ru_stime


def main() -> None:
    """Print the changes that nothing noticed; see the top of the file."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--most", type=int)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("module")
    parser.add_argument("tests", nargs=argparse.REMAINDER)
    args = parser.parse_args()
    os.chdir(ROOT)
    found = list(changes((ROOT / args.module).read_text()))
    tried = random.Random(args.seed).sample(found, min(args.most or len(found), len(found)))
    passed, taken = passes(args.module, args.tests, None, 600.0)
    if not passed:
        sys.exit(f"{args.module}: its tests fail without a change")
    left = 0
    for change in tried:
        if passes(args.module, args.tests, change, max(LEAST_SECONDS, 5.0 * taken))[0]:
            left += 1
            print(f"{args.module}:{change.line}\n  - {change.before}\n  + {change.after}", flush=True)
    print(f"{len(found)} changes, {len(tried)} tried, {len(tried) - left} noticed, {left} left")


if __name__ == "__main__":
    main()
