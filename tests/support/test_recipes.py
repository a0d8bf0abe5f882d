"""The recipes of the contributing page, applied to a copy of the code: what they add works, and tests take it in."""

import os
import re
import shutil
import subprocess
import sys

import pytest

from solar_env.support.readme import PACKAGE

ROOT = PACKAGE.parent
PAGE = ROOT / ".github" / "CONTRIBUTING.md"
# What the page says of the things that it adds, beyond what the tests of their tables find.
CLAIMS = """
import solar_env
from agents.environments import make_env
from agents.laws.baselines import make_baseline
from solar_env.__main__ import main
from solar_env.verification.suite import run
bearing = solar_env.ArrayParameters(contact_law="hu-guo", restitution=0.7).bearing(0)
assert bearing.contact.damping == 1.5 * (1.0 - 0.7) / 0.7
env = make_env("solar_env/DeployLate-v1", {
    "model": "rigid-ideal",
    "observation": ["theta", "postlatch_force_1_ago"],
    "reward": {"impact_count": {"weight": 1.0, "scale": 200.0, "bound": 0.5}},
    "driven_joint": 1,
    "control_period": 1e-3,
})
assert env.unwrapped.hardware.sensor_delay == 2
assert env.unwrapped.observation_names[-2:] == ("postlatch_force_1_1_ago", "postlatch_force_2_1_ago")
assert "impact_count" in env.unwrapped.reward.names
env.reset(seed=0)
env.step([1.0])
assert env.unwrapped.simulation.state.joints["motor_torque"].tolist() == [0.0, 0.5]
env = make_env("solar_env/Deploy-v1", {"model": "rigid-ideal"})
assert abs(make_baseline("push", env).predict(env.reset(seed=0)[0])[0][0] - 0.1) < 1e-7
assert [check.passed for check in run("first-fall")] == [True]
assert main(["study", "stability", "--only", "fall", "--quick", "--out", "maps"]) == 0
assert main(["presets"]) == 0
"""
# What picks the new rows from the tests that run over the tables, and the least number of tests that they bring.
ROWS = {
    "mechanics/joints/test_contact_laws.py": ("hu-guo and not block and not deep", 10),
    "mechanics/bodies/test_kinds.py": ("Lever and (energy or matrix or starts or rates)", 5),
    "environment/task/test_observations.py": ("postlatch_force and not checker", 5),
    "environment/task/test_reward_terms.py": ("impact_count", 6),
    "agents/laws/test_baselines.py": ("push and not deploys", 3),
}


def change(root, block):
    """Apply the hunks of a block, each of which must fit in one place of its file."""
    for name, lines in re.findall(r"^# ([\w/]+\.(?:py|toml))\n((?:(?!# ).*\n)*)", block, re.MULTILINE):
        text = (root / name).read_text(encoding="utf-8")
        for hunk in lines.split("@@\n"):
            old, new = ("".join(re.findall(rf"^[ {sign}](.*\n)", hunk, re.MULTILINE)) for sign in ("-", "+"))
            assert text.count(old) == 1, f"{name}: the lines\n{old}are there {text.count(old)} times"
            text = text.replace(old, new)
        (root / name).write_text(text, encoding="utf-8")


def add_body_kind(bodies):
    """Do what the page says in words: copy a kind, and add a branch for it wherever kinds differ."""
    source = (bodies / "natural_coordinates.py").read_text(encoding="utf-8")
    source = re.sub(r"\bBody\b", "LeverBody", source).replace("class NaturalCoordinates(", "class Lever(")
    (bodies / "lever.py").write_text(source, encoding="utf-8")
    text = (bodies / "dispatch.py").read_text(encoding="utf-8")
    # Natural coordinates come last, without a condition of their own.
    for last, word, returned in ((r"else:\n *", "elif", ""), ("return ", "if", "return ")):
        before = rf"\1{word} body.kind == LEVER:\n\1    {returned}lever.\2\n\g<0>"
        text, count = re.subn(rf"^( *){last}natural_coordinates\.(.*)\n", before, text, flags=re.MULTILINE)
        assert count
    text = text.replace("natural_coordinates\n", "lever, natural_coordinates\n", 1)
    (bodies / "dispatch.py").write_text(text.replace("CABLE_ELEMENTS\n", "CABLE_ELEMENTS, LEVER\n", 1), "utf-8")


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """Run Python, without compiling kernels, in a copy of the code to which every recipe has been applied."""
    root = tmp_path_factory.mktemp("recipes") / "copy"
    for folder in ("solar_env", "agents", "tests"):
        shutil.copytree(ROOT / folder, root / folder, ignore=shutil.ignore_patterns("__pycache__", "figures", "*.npz"))
    shutil.copy(ROOT / "pyproject.toml", root)
    page = PAGE.read_text(encoding="utf-8")
    for path, example in re.findall(r"`([\w/]+\.py)`\s\(\[example\]\(([^)]+)\)\)", page):
        shutil.copy(PAGE.parent / example, root / path)
    for block in re.findall(r"```diff\n(.*?)```", page, re.DOTALL):
        change(root, block)
    add_body_kind(root / "solar_env" / "mechanics" / "bodies")
    places = os.environ | {"PYTHONPATH": os.pathsep.join(map(str, (root, root / "tests"))), "NUMBA_DISABLE_JIT": "1"}

    def python(*arguments):
        done = subprocess.run([sys.executable, *arguments], cwd=root, env=places, capture_output=True, text=True)
        return done.returncode, done.stdout + done.stderr

    return python


def test_what_the_recipes_add_works_as_the_page_says(run):
    status, printed = run("-c", CLAIMS)
    assert status == 0, printed


@pytest.mark.slow
def test_the_tests_of_every_table_take_in_the_new_rows(run):
    # The configuration of the tests would load all kernels.
    options = ["--noconftest", "-v", "-k", " or ".join(f"({words})" for words, _ in ROWS.values())]
    _, printed = run("-m", "pytest", *options, *(f"tests/{name}" for name in ROWS))
    assert re.findall("^(?:FAILED|ERROR) .*", printed, re.MULTILINE) == [], printed
    for name, (_, least) in ROWS.items():
        assert len(re.findall(rf"^tests/{name}::.* PASSED", printed, re.MULTILINE)) >= least, printed
