"""A policy as a C header, compiled and compared with the policy in NumPy."""

from __future__ import annotations

import ctypes
import re
import shutil
import subprocess
from dataclasses import replace

import gymnasium
import numpy as np
import pytest

from agents.policies.c_form import c_header, interface_comment
from agents.policies.network import Layer, PolicyNetwork
from agents.policies.shipped import available, load_shipped
from solar_env.__main__ import main
from solar_env.environment.hardware import Hardware


def compiled(header, function, tmp_path):
    compiler = shutil.which("cc") or shutil.which("gcc")
    if compiler is None:
        pytest.skip("no C compiler is installed")
    (tmp_path / "policy.h").write_text(header)
    source = f'#include "policy.h"\nfloat act(const float *o) {{ return {function}(o); }}\n'
    (tmp_path / "policy.c").write_text(source)
    flags = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-O1", "-shared", "-fPIC"]
    subprocess.run([compiler, *flags, "policy.c", "-o", "policy.so", "-lm"], cwd=tmp_path, check=True)
    act = ctypes.CDLL(str(tmp_path / "policy.so")).act
    act.restype = ctypes.c_float
    return lambda o: act(np.ascontiguousarray(o, np.float32).ctypes.data_as(ctypes.POINTER(ctypes.c_float)))


@pytest.mark.parametrize("name", available())
def test_a_shipped_policys_header_acts_as_its_network_does(name, tmp_path):
    assert main(["export", name, "--out", str(tmp_path / f"{name}.h")]) == 0
    network = load_shipped(name).network
    act = compiled((tmp_path / f"{name}.h").read_text(), f"{name.replace('-', '_')}_action", tmp_path)
    for observation in np.random.default_rng(0).uniform(-1.5, 1.5, (200, network.inputs)).astype(np.float32):
        assert act(observation) == pytest.approx(float(network.act(observation)[0]), abs=2e-6)


@pytest.mark.parametrize("activation", ["relu", "tanh"])
@pytest.mark.parametrize(("output", "mean_limit"), [("clip", None), ("tanh", 0.7), ("tanh", 1)])
def test_every_kind_of_network_has_its_header(activation, output, mean_limit, tmp_path):
    rng = np.random.default_rng(1)

    def layer(outputs, inputs):
        return Layer(*((0.4 * rng.normal(size=shape)).astype(np.float32) for shape in ((outputs, inputs), (outputs,))))

    layers = (layer(5, 3), layer(7, 5), layer(4, 7), layer(1, 4))
    network = PolicyNetwork(layers, 1.5, activation, output, mean_limit)
    act = compiled(c_header(network, "x 1", ["not the end */ of the comment"]), "x_1", tmp_path)
    actions = []
    for observation in rng.normal(size=(100, 3)).astype(np.float32):
        actions.append(act(observation))
        assert actions[-1] == pytest.approx(float(network.act(observation)[0]), abs=2e-6)
    assert len(set(actions)) > 3, "not all are clipped"


@pytest.mark.parametrize("line", ["*/ int evil;", "*\\\n/ int evil;", "*\\", "*??/", "*\u2028/"])
def test_what_a_policy_says_of_itself_cannot_end_the_comment(line):
    last = Layer(np.ones((1, 1), np.float32), np.zeros(1, np.float32))
    network = PolicyNetwork((last,), 1.0, "tanh", "clip", None)
    header = c_header(network, "own", [line, "/ int evil;"])
    # As C reads it: trigraphs, then lines that are joined, then comments.
    read = re.sub(r"\\\s*\n", "", header.replace("??/", "\\"))
    assert "evil" not in read[read.index("*/") :]
    assert header[header.index("*/") :].startswith("*/\n#ifndef OWN_H")


def comment_of(name, tmp_path):
    assert main(["export", name, "--out", str(tmp_path / f"{name}.h")]) == 0
    text = (tmp_path / f"{name}.h").read_text()
    return text[: text.index("*/")]


@pytest.mark.parametrize("name", available())
def test_a_header_says_what_goes_in_and_how_often(name, tmp_path):
    comment, description = comment_of(name, tmp_path), load_shipped(name).description
    rows = re.findall(r"^ +(\d+)  (\w+) +\[(\S+), (\S+)\]", comment, re.MULTILINE)
    assert [row[1] for row in rows] == list(description.observation_names)
    assert [int(row[0]) for row in rows] == list(range(len(rows)))
    space = gymnasium.make(description.env_id, **description.env_kwargs).observation_space
    bounds = [[float(low), float(high)] for *_, low, high in rows]
    np.testing.assert_allclose(bounds, np.stack([space.low, space.high], axis=1), rtol=1e-5)
    assert f"every {description.control_period:g} s" in comment


def test_a_header_says_what_comes_out(tmp_path):
    comment = " ".join(comment_of("cma-es-randomised", tmp_path).split())
    assert "clipped to [-1, 1] by the function; positive opens: the setpoint 0.0005 sinh(7 action) rad/s" in comment
    assert "12 N m s/rad times (setpoint - rate), at most 0.5 N m either way, 100 times a second" in comment
    description = load_shipped("cma-es-nominal").description
    other = replace(description, env_kwargs={}, observation_names=("theta_2_1_ago", "own"))
    lines = interface_comment(other, Hardware())
    past = "joint angle: 0 folded, 1 locked (joint 2), as it was 1 periods ago; unit: lock angle"
    assert any(past in line for line in lines)
    assert "  1  own" in lines, "what is in no table has its name alone"
    assert lines[-1] == "the torque of the motor on hinge 1, in units of 0.5 N m."
