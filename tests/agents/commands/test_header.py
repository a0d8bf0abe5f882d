"""A policy as a C header, compiled and compared with the policy in NumPy."""

from __future__ import annotations

import ctypes
import shutil
import subprocess

import numpy as np
import pytest

from agents.policies.c_form import c_header
from agents.policies.network import Layer, PolicyNetwork
from agents.policies.shipped import available, load_shipped
from solar_env.__main__ import main


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
    assert main(["header", name, "--out", str(tmp_path / "own.h")]) == 0
    network = load_shipped(name).network
    act = compiled((tmp_path / "own.h").read_text(), f"{name.replace('-', '_')}_action", tmp_path)
    for observation in np.random.default_rng(0).uniform(-1.5, 1.5, (200, network.inputs)).astype(np.float32):
        assert act(observation) == pytest.approx(float(network.act(observation)[0]), abs=2e-6)


@pytest.mark.parametrize("activation", ["relu", "tanh"])
@pytest.mark.parametrize(("output", "mean_limit"), [("clip", None), ("tanh", 0.7)])
def test_every_kind_of_network_has_its_header(activation, output, mean_limit, tmp_path):
    rng = np.random.default_rng(1)

    def layer(outputs, inputs, precision):
        return Layer(*((0.4 * rng.normal(size=shape)).astype(precision) for shape in ((outputs, inputs), (outputs,))))

    layers = (layer(5, 3, np.float64), layer(7, 5, np.float32), layer(4, 7, np.float32), layer(1, 4, np.float32))
    network = PolicyNetwork(layers, layer(5, 3, np.float64), 1.5, activation, output, mean_limit)
    act = compiled(c_header(network, "x 1", ("a", "b", "c")), "x_1", tmp_path)
    actions = []
    for observation in rng.normal(size=(100, 3)).astype(np.float32):
        actions.append(act(observation))
        assert actions[-1] == pytest.approx(float(network.act(observation)[0]), abs=2e-6)
    assert len(set(actions)) > 3, "not all are clipped"
