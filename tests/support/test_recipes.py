"""The recipes of the contributing page, applied to a copy of the code: what they add works, and tests take it in."""

import json
import os
import re
import shutil
import subprocess
import sys

import pytest

from solar_env.support.readme import PACKAGE

ROOT = PACKAGE.parent
PAGE = PACKAGE / "contributing.md"
# What each recipe promises, as programs that run one after the other.
CLAIMS = {
    "Normal contact law": """
from solar_env.array import ArrayParameters
from solar_env.mechanics.mechanism.description import Bearing
from solar_env.mechanics.mechanism.textbook import bouncing_block
from solar_env.mechanics.running.simulation import simulate
array = ArrayParameters(contact_law="hu-guo", restitution=0.7)
contact = array.bearing(0).contact
assert contact.damping == 1.5 * (1.0 - 0.7) / 0.7
run = simulate(bouncing_block(Bearing(2e-4, 0.01, contact), 6.0, 0.05), 0.01)
assert run.contact_starts[0] == 1
# The law is known to come close to what it is asked for.
assert abs(-run.velocities[-1, 0] / 0.05 - contact.exit_speed_ratio()) < 3e-4
assert abs(contact.exit_speed_ratio() - 0.7) < 0.03
""",
    "Integrator": """
import solar_env
from solar_env.array.methods import make_integrator
from solar_env.mechanics.mechanism.textbook import pendulum
heun = make_integrator("heun", "rigid-ideal", rtol=1e-6)
fine = solar_env.Simulation(pendulum(), solar_env.RungeKutta(rtol=1e-10))
simulation = solar_env.Simulation(pendulum(), heun)
for each in (fine, simulation):
    each.advance(0.1)
assert 1e-12 < abs(simulation.state.q - fine.state.q).max() < 1e-5
""",
    "Body kind": """
import math
from solar_env.mechanics.bodies.description import LeverBody
from solar_env.mechanics.mechanism.description import Body, Mechanism
ends = []
for kind in (LeverBody, Body):
    body = kind("falling", 1.5, 0.3, 0.9, (0.4, 0.1), velocity=(0.5, 0.2), spin=-0.9)
    simulation = solar_env.Simulation(Mechanism((body,), gravity=(0.0, -9.81)))
    simulation.advance(0.1)
    ends.append(simulation.state.q.tolist())
assert ends[0] == ends[1]
turned = math.atan2(ends[0][3] - ends[0][1], ends[0][2] - ends[0][0])
assert abs(turned + 0.09) < 1e-9
""",
    "Observation": """
import gymnasium
keywords = {"model": "rigid-ideal", "observation": ["theta", "postlatch_force", "postlatch_force_1_ago"]}
env = gymnasium.make("solar_env/Deploy-v1", **keywords)
envs = gymnasium.make_vec("solar_env/Deploy-v1", num_envs=2, **keywords)
assert env.unwrapped.observation_names[2:] == (
    "postlatch_force_1", "postlatch_force_2", "postlatch_force_1_1_ago", "postlatch_force_2_1_ago"
)
assert env.observation_space.contains(env.reset(seed=0)[0])
assert envs.reset(seed=0)[0].shape == (2, 6)
assert "`postlatch_force_i`" in solar_env.SolarArrayEnv.__doc__
""",
    "Reward term": """
price = {"impact_count": {"weight": 1.0, "scale": 200.0, "bound": 0.5}}
env = gymnasium.make("solar_env/Deploy-v1", reward=price)
assert env.unwrapped.reward.prices["impact_count"].scale == 200.0
env.reset(seed=0)
assert "impact_count" in env.unwrapped.reward.names
assert "impact_count" not in gymnasium.make("solar_env/Deploy-v1").unwrapped.reward.names
""",
    "Driven joint": """
env = gymnasium.make("solar_env/Deploy-v1", model="rigid-ideal", driven_joint=1, control_period=1e-3)
assert env.unwrapped.task.driven_joint == 1
env.reset(seed=0)
env.step([1.0])
assert env.unwrapped.simulation.state.joints["motor_torque"].tolist() == [0.0, 0.5]
""",
    "Scenario, controller, study, verification case, command": """
from agents.environments import make_env
from agents.laws.baselines import make_baseline
from solar_env.__main__ import main
from solar_env.verification.suite import run
env = gymnasium.make("solar_env/DeployLate-v1", model="rigid-ideal")
assert env.unwrapped.hardware.sensor_delay == 2
law = make_baseline("push", env)
assert abs(law.predict(env.reset(seed=0)[0])[0][0] - 0.1) < 1e-7
assert [row.passed for row in run("first-fall")] == [True]
assert main(["study", "stability", "--only", "fall", "--quick", "--out", "maps"]) == 0
assert main(["presets"]) == 0
""",
}
# What picks the new rows from the tests that run over the tables, and the least number of tests that they bring.
ROWS = {
    "mechanics/joints/test_contact_laws.py": ("hu-guo and not block and not deep", 10),
    "mechanics/integrators/test_method_table.py": ("heun and order", 1),
    "mechanics/bodies/test_kinds.py": ("Lever and (energy or matrix or starts or rates)", 5),
    "environment/task/test_observations.py": ("postlatch_force and not checker", 5),
    "environment/task/test_reward_terms.py": ("impact_count", 6),
    "agents/laws/test_baselines.py": ("push and not deploys", 3),
}


def sections():
    """Heading -> text of the recipes."""
    parts = re.split(r"^## (.*)\n", PAGE.read_text(encoding="utf-8"), flags=re.MULTILINE)[1:]
    return {heading: text for heading, text in zip(parts[::2], parts[1::2], strict=True) if heading in CLAIMS}


def files(lines):
    """(path, lines) of the files that a block is about."""
    found = []
    for line in lines:
        if re.fullmatch(r"# [\w/]+\.(py|toml)", line):
            found.append((line[2:], []))
        else:
            found[-1][1].append(line)
    return found


def change(path, lines):
    """Apply the hunks of a block, each of which must fit in one place."""
    text = path.read_text(encoding="utf-8")
    for hunk in "\n".join(lines).split("\n@@\n"):
        old, new = (
            "".join(f"{line[1:]}\n" for line in hunk.splitlines() if line[:1] not in left_out) for left_out in "+-"
        )
        assert text.count(old) == 1, f"{path}: the lines\n{old}are there {text.count(old)} times"
        text = text.replace(old, new)
    path.write_text(text, encoding="utf-8")


def add_body_kind(root):
    """Do what the page says in words: copy a kind, and add a branch for it wherever kinds differ."""
    bodies = root / "solar_env" / "mechanics" / "bodies"
    source = (bodies / "natural_coordinates.py").read_text(encoding="utf-8")
    source = re.sub(r"\bBody\b", "LeverBody", source).replace("class NaturalCoordinates(", "class Lever(")
    (bodies / "lever.py").write_text(source, encoding="utf-8")
    # Natural coordinates come last, without a condition of their own.
    last = re.compile(r"^( *)(?:else:\n *(natural_coordinates\..*)|(return natural_coordinates\..*))\n", re.MULTILINE)

    def both(found):
        indent, after, returned = found.groups()
        word = "elif" if after else "if"
        own = (after or returned).replace("natural_coordinates.", "lever.")
        return f"{indent}{word} body.kind == LEVER:\n{indent}    {own}\n{found.group(0)}"

    text, count = last.subn(both, (bodies / "dispatch.py").read_text(encoding="utf-8"))
    assert count == 5
    text = text.replace("natural_coordinates\n", "lever, natural_coordinates\n", 1)
    text = text.replace("CABLE_ELEMENTS\n", "CABLE_ELEMENTS, LEVER\n", 1)
    (bodies / "dispatch.py").write_text(text, encoding="utf-8")


def run(root, arguments):
    """Run Python in the copy, without compiling kernels; its output."""
    environment = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join(map(str, (root, root / "tests"))),
        "NUMBA_DISABLE_JIT": "1",
        "PYTHONDONTWRITEBYTECODE": "1",
    }
    done = subprocess.run(
        [sys.executable, *arguments], cwd=root, env=environment, capture_output=True, text=True, check=False
    )
    return done.stdout + done.stderr


@pytest.fixture(scope="module")
def copy(tmp_path_factory):
    """The root of a copy of the code to which every recipe has been applied."""
    root = tmp_path_factory.mktemp("recipes") / "copy"
    for folder in ("solar_env", "agents", "tests"):
        shutil.copytree(ROOT / folder, root / folder, ignore=shutil.ignore_patterns("__pycache__", "figures", "*.npz"))
    for name in ("pyproject.toml", "train.py"):
        shutil.copy(ROOT / name, root)
    for text in sections().values():
        for path, example in re.findall(r"`([\w/]+\.py)` \(\[example\]\(([^)]+)\)\)", text):
            shutil.copy(PAGE.parent / example, root / path)
        for block in re.findall(r"```diff\n(.*?)```", text, re.DOTALL):
            for path, lines in files(block.splitlines()):
                change(root / path, lines)
    add_body_kind(root)
    return root


@pytest.fixture(scope="module")
def kept(copy):
    """Section -> what went wrong in its claims; empty if nothing did."""
    (copy / "programs.json").write_text(json.dumps(CLAIMS), encoding="utf-8")
    runner = """
import json, traceback
namespace, wrong = {}, {}
for heading, program in json.load(open("programs.json")).items():
    try:
        exec(program, namespace)
        wrong[heading] = ""
    except Exception:
        wrong[heading] = traceback.format_exc(limit=-3)
json.dump(wrong, open("wrong.json", "w"))
"""
    printed = run(copy, ["-c", runner])
    assert (copy / "wrong.json").exists(), printed
    return json.loads((copy / "wrong.json").read_text(encoding="utf-8"))


@pytest.mark.parametrize("heading", CLAIMS)
def test_what_a_recipe_adds_works_as_the_page_says(kept, heading):
    assert kept[heading] == ""


def test_the_tests_of_every_table_take_in_the_new_rows(copy):
    """With kernels uncompiled: those of a row that are quick."""
    picked = " or ".join(f"({words})" for words, _ in ROWS.values())
    options = ["--noconftest", "-v", "-p", "no:cacheprovider", "-k", picked]  # that of the tests loads all kernels
    printed = run(copy, ["-m", "pytest", *options, *(f"tests/{name}" for name in ROWS)])
    assert re.findall("^(?:FAILED|ERROR) .*", printed, re.MULTILINE) == [], printed
    for name, (_, least) in ROWS.items():
        assert len(re.findall(rf"^tests/{name}::.* PASSED", printed, re.MULTILINE)) >= least, printed
