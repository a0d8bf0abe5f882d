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
import math
import os
import random
import resource
import signal
import sys
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
LEAST_SECONDS = 20.0  # of processor time, for an attempt: its change may keep a loop from ending, which is noticed too
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
JOINT = (
    JOINTS + "test_joint.py",
    JOINTS + "test_torques.py",
    JOINTS + "test_cable_loop.py::test_the_forces_of_a_belt_are_the_slope_of_its_energy",
)
CONTACT_LAWS, FRICTION_LAWS = "solar_env/mechanics/joints/contact/", "solar_env/mechanics/joints/friction/"
# Reasons that recur.
CODE = "codes are compared with each other alone"
MORE_TURNS = "further turns come to the same root"
ONE = "there is but one"
BOUND = "both formulas are right at the bound between them"
INTEGRATORS = "tests/mechanics/integrators/"
STEPS = (
    INTEGRATORS + "test_step_control.py",
    INTEGRATORS + "test_impact_steps.py",
    "-k",
    "not peak_of_an_impact and not thousand_further",
)
METHODS = "solar_env/mechanics/integrators/methods/"
ALPHA_CONTROL = (INTEGRATORS + "test_alpha_control.py",)
FIXED_STEPS = INTEGRATORS + "test_generalized_alpha.py::test_fixed_steps_divide_a_call_evenly_and_end_on_its_end"
# Those that end soon without the compiler, and do not ask for an error that only it raises; of radii one.
ALPHA = (
    INTEGRATORS + "test_alpha_step.py",
    INTEGRATORS + "test_alpha_records.py",
    *ALPHA_CONTROL,
    INTEGRATORS + "test_generalized_alpha.py",
    "-k",
    "not agree and not tighter and not as_the_explicit and not infinite_force and not same_bits and not without_sense"
    " and not analytic_tangents and not (order_two and (0.5 or 1.0)) and not (second_order and 1.0)",
)
STIFF = (
    INTEGRATORS + "test_stiff_steps.py",
    INTEGRATORS + "test_stiff_forces.py",
    "-k",
    "stiff_steps or coefficients or linear_equations or without_pivoting",
)
LAWS = ("tests/agents/laws/test_baselines.py", "-k", "(batched or refused or shares or entries) and not follows")
# Untuned parameters, and how far tuning searches.
CHOSEN = {"= bounded(": "a choice: tests ask that it lies in its range, which is not negative where it is no torque"}


def _law(name: str, tests: str, explained: dict[str, str] | None = None) -> Row:
    """The row of a torque law, with tests by their names."""
    words = f"({tests}) and not the_tuned_soft_start"
    path = "tests/agents/laws/test_baselines.py"
    return Row(f"agents/laws/{name}.py", (path, "-k", words), {**CHOSEN, **(explained or {})})


ROWS = (
    Row(CONTACT_LAWS + "surfaces.py", CONTACT),
    Row(
        CONTACT_LAWS + "power_law.py",
        CONTACT,
        {
            "code: ClassVar[int]": CODE,
            "for _ in range(": "bisection has come to rest in the last bit before",
            "function(middle) >= 0.0": "a root that is met is as good at either end",
            "impact_defect(d, e), -1.0": "the root lies in the wider interval too, and no other",
            "min(2.0, 1.0 / d)": "the root lies in the wider interval too, and no other",
            "min(1.0, 2.0 / d)": "the defect is infinite from one over the damping on",
            "if d <= 3e-4": BOUND,
            "if exponent == 0.5": "a power is what the square root is, but slower",
            "if exponent == 2.5": "a power is what the square root is, but slower",
        },
    ),
    Row(CONTACT_LAWS + "hertz.py", CONTACT),
    Row(CONTACT_LAWS + "flores.py", CONTACT),
    Row(CONTACT_LAWS + "lankarani_nikravesh.py", CONTACT),
    Row(CONTACT_LAWS + "pereira.py", CONTACT, {"if c <= 0.34954": BOUND}),
    Row(
        CONTACT_LAWS + "restitution.py",
        CONTACT,
        {
            "if e >= 1.0 - 2e-4": BOUND,
            "lankarani_nikravesh.damping(e), 2.0 / e": "the defect is infinite from one over the restitution on",
        },
    ),
    Row(CONTACT_LAWS + "laws.py", CONTACT),
    Row(CONTACT_LAWS + "normal_force.py", CONTACT, {"if depth < 0.0": "no depth stores no energy by the formula too"}),
    Row(
        FRICTION_LAWS + "ramp.py",
        FRICTION,
        {"code: ClassVar[int]": CODE, "if sliding_speed >= 0.0": "what does not slide has left before"},
    ),
    Row(FRICTION_LAWS + "brown_mcphee.py", FRICTION, {"code: ClassVar[int]": CODE}),
    Row(FRICTION_LAWS + "laws.py", FRICTION),
    Row(FRICTION_LAWS + "friction_share.py", FRICTION),
    Row("solar_env/mechanics/joints/wear.py", (JOINTS + "test_wear.py", *SHORT)),
    Row(
        "solar_env/mechanics/joints/sliding.py",
        JOINT,
        {"radius > 0.0 else 2.0": "a line of no length is nought over whatever size"},
    ),
    Row(
        "solar_env/mechanics/joints/torques.py",
        JOINT,
        {
            "if depth > below_stow": "of two stops that are as deep either pushes alike",
            "if beyond >= 0.0": "in the middle of its play a latch does not push",
            "if depth < 0.0 or not own.stop_engaged": "no depth stores no energy by the formula too",
        },
    ),
    Row(
        "solar_env/mechanics/joints/joint.py",
        JOINT,
        {
            "power[first - m.NORMAL_DISSIPATION]": "it is the first of a joint's integrals",
            "if motion.depth >= 0.0": "no depth bears nothing by the formula too",
        },
    ),
    Row(
        "solar_env/mechanics/numerics/step_size.py",
        ("tests/mechanics/numerics/test_step_size.py",),
        {"if not error <= math.inf": "no power of an infinite error is more than the least share"},
    ),
    Row(
        "solar_env/mechanics/integrators/events.py",
        STEPS,
        {
            "1.0, np.int64(- ": "without an event no joint is asked for",
            "and f_high == 0.0": MORE_TURNS,
            "continue": MORE_TURNS,
            "if not low <= middle < high": MORE_TURNS,
            "if root <= share or what == NO_EVENT": "of two events at one instant either may be the first",
            "stop_engaged = 2": "it is asked whether this is nought",
        },
    ),
    Row(
        "solar_env/mechanics/integrators/acceptance.py",
        STEPS,
        {
            "clock[-1]": ONE,
            "trial[-1]": ONE,
            "peak, before, here = 0.0, 0.0, ": "samples come in its place before it is asked for",
            "copy_into(state.a, stages.acceleration[-1]": "the first and the last are the same there",
            "(implicit or share < 2.0)": "what is prepared anew is the same at the end of a step",
            "_PEAK_SAMPLES = 7": "any number of samples finds the same peak",
            "_PEAK_SAMPLES + 2": "any number of samples finds the same peak",
            "here >= after": "between two samples of one height either is the top of the same parabola",
        },
    ),
    Row(
        "solar_env/mechanics/integrators/adaptive.py",
        STEPS,
        {
            "trial[-1]": ONE,
            "acceleration_current != m.": "a method evaluates anew what does not belong to the state",
            "recorder.times.size > -1": "where no samples are asked for none is due",
            "recorder, 1.0, clock.time)": "nothing lies between the start and the start",
            "array[s, i] = -1.0": "any number that is finite has the weight zero",
        },
    ),
    Row(
        METHODS + "alpha_control.py",
        (*ALPHA_CONTROL, FIXED_STEPS),
        {
            "clock = state.clock[-1]": ONE,
            "convergence < 1.0": BOUND,
            "convergence <= 2.0": "Newton's corrections fall by orders of magnitude: none is between one and two",
            "error < 1.0": BOUND,
            "2.0 * wanted >= remaining": BOUND,
            "grow >= 1.5": BOUND,
            "worst = -1.0": "errors are not negative",
            "growth(_CONTROL, error, 2.0)": "the controller has no integral part",
            "growth(_CONTROL, error, 0.0)": "the controller has no integral part",
            "return -1.0": "whatever is not positive accepts",
        },
    ),
    Row(
        METHODS + "alpha_step.py",
        ALPHA,
        {
            "state.clock[-1]": ONE,
            "_PATIENCE = 1": "a choice",
            "correction < tolerance": BOUND,
            "rhs[n + m + b] = -1.0": "the multiplier of a body without constraints acts on nothing",
            "rhs[n + m + b] = 1.0": "the multiplier of a body without constraints acts on nothing",
            "rhs[n - m + b] = 0.0": "an entry of the ground, which nothing moves",
            "rhs[n + m - b] = 0.0": "rows of joints are linear in natural coordinates: every prediction meets them",
            "correction < (1.0 - 0.5 * relaxation)": BOUND,
            "correction = -1.0": "magnitudes are not negative",
            "abs(rhs[i]) < correction": "of two that are equal either is the greatest",
            "2.0 / relaxation": MORE_TURNS,
            "correction, 1, min": MORE_TURNS,
            "0.5 * relaxation, 1": "halved a turn sooner",
            "0.5 * relaxation, -1": "halved a turn later",
        },
    ),
    Row(
        METHODS + "generalized_alpha.py",
        ALPHA,
        {
            "state.clock[-1]": ONE,
            "stop_engaged = 2": "engaged is whatever is not zero",
            "recorder.times.size >= 0": "no sample is due where there is none",
            "recorder.times.size > 0 or sample_due": "no sample is due where there is none",
            "not convergence < 1.0": BOUND,
            "it.depth[j] <= 0.0 else 0.0": BOUND,
            "last = wanted": "start + (end - start) rounds to the end all the same",
            "retry = 2.0": "any positive number begins",
        },
    ),
    Row(
        METHODS + "stiff_forces.py",
        STIFF,
        {
            "state.clock[-1]": ONE,
            "stiff.active[-1]": ONE,
            "own.contact_start > IMPACT_DURATIONS": BOUND,
            "<= _STIFF": BOUND,
            "_STIFF_DAMPING = ": "a choice",
            "_STIFF_CONTACT = ": "a choice",
            "_PROBE = ": "a choice",
            "prepared = False": "what is prepared again is the same",
        },
    ),
    _law("brake", "brake"),
    _law("damper", "damper"),
    _law("open_loop", "open_loop or open-loop"),
    _law("pd", "pd"),
    _law("servo", "servo and not follows_its_profile"),
    _law("shaped", "shaped and not at_rest"),
    _law("soft_start", "soft"),
    _law("table", "refused or ranges"),
    Row(
        "agents/comparison/receding_horizon.py",
        ("tests/agents/comparison/test_receding_search.py",),
        {
            "knots: int =": "a choice",
            "seed: int =": "a choice",
            "nothing = np.zeros(1": "of a plan that is yet to be made no action is played",
        },
    ),
    Row(
        "agents/laws/baselines.py",
        (
            "tests/agents/laws/test_tuned_laws.py",
            "-k",
            "episodes or refused or has_the_parameters or any_number or says_so",
        ),
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
                yield Change(code, _joined(old[i:j]), _joined(new[k:m]), i + 1)


def _joined(lines: list[str]) -> str:
    """Lines of code as one, without the blank that cosmic-ray sets before numbers."""
    return " ".join(line.strip() for line in lines).replace("( ", "(").replace("[ ", "[").replace("  ", " ")


def passes(row: Row, change: Change | None, limit: float) -> tuple[bool, float]:
    """Whether the tests of a row pass where its module is changed, and the processor time [s] that they took.

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
            name = row.module.removesuffix(".py").replace("/", ".")
            sys.meta_path.insert(0, Changed(name, ROOT / row.module, change))
        os._exit(int(pytest.main([*QUICK, *row.tests])))
    _, status, used = os.wait4(process, 0)
    return os.waitstatus_to_exitcode(status) == 0, used.ru_utime + used.ru_stime


def measure(row: Row, most: int | None, chance: random.Random) -> tuple[int, int, int, list[Change]]:
    """Numbers of changes of a module, of those tried and of those explained, and those that nothing noticed."""
    found = list(changes((ROOT / row.module).read_text()))
    tried = found if most is None or most >= len(found) else chance.sample(found, most)
    passed, taken = passes(row, None, 600.0)
    if not passed:
        sys.exit(f"{row.module}: its tests fail without a change")
    limit = max(LEAST_SECONDS, 5.0 * taken)
    survivors = [change for change in tried if passes(row, change, limit)[0]]
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
