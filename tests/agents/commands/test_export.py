"""A policy that is written as ONNX acts as it does here."""

import re

import numpy as np
import onnxruntime
import pytest
from training import write_run

from agents.learning import runs
from agents.policies.network import Layer, PolicyNetwork
from agents.policies.onnx_form import onnx_model
from solar_env.__main__ import execute, main

OBSERVATIONS = np.random.default_rng(1).uniform(-4.0, 4.0, (50, 11)).astype(np.float32)


def actions(path):
    return onnxruntime.InferenceSession(path).run(["action"], {"observation": OBSERVATIONS})[0]


def test_a_run_a_saved_model_and_a_policy_of_the_package_are_written_as_onnx_that_acts_alike(tmp_path, monkeypatch):
    monkeypatch.setattr(runs, "SHIPPED", tmp_path)
    write_run(tmp_path / "line", (np.linspace(-0.2, 0.3, 11).tolist(),), bias=-0.1)
    expected = runs.best_policy("line").act(OBSERVATIONS)
    assert np.ptp(expected) > 1.0
    for policy in (tmp_path / "line", tmp_path / "line" / runs.BEST, "line"):
        execute("export", [str(policy), "--out", str(tmp_path / "policy.onnx")])
        np.testing.assert_allclose(actions(tmp_path / "policy.onnx"), expected, rtol=0.0, atol=1e-6)


@pytest.mark.parametrize("activation", ["relu", "tanh"])
@pytest.mark.parametrize(("output", "mean_limit"), [("clip", None), ("tanh", None), ("tanh", 0.5)])
def test_every_kind_of_network_acts_alike_as_onnx(activation, output, mean_limit):
    generator = np.random.default_rng(2)
    sizes = [(8, 11), (8, 8), (1, 8)]
    layers = [
        Layer(*((0.3 * generator.normal(size=of)).astype(np.float32) for of in (size, size[:1]))) for size in sizes
    ]
    network = PolicyNetwork(tuple(layers), activation, output, mean_limit)
    written = onnx_model(network).SerializeToString()
    np.testing.assert_allclose(actions(written), network.act(OBSERVATIONS), rtol=0.0, atol=1e-6)


def test_another_suffix_and_no_policy_are_refused(tmp_path, capsys):
    for words, told in (
        (["rigid", "--out", str(tmp_path / "policy.h")], "the suffix '.h' .* choose from .onnx"),
        ([str(tmp_path), "--out", str(tmp_path / "policy.onnx")], "is not a run folder"),
    ):
        assert main(["export", *words]) == 2
        assert re.search(told, capsys.readouterr().err)


def test_without_onnx_the_command_says_what_to_install_before_anything_is_read(run_python, tmp_path):
    program = """
import contextlib, io, sys
sys.modules["onnx"] = None
from solar_env.__main__ import main
with contextlib.redirect_stderr(io.StringIO()) as said:
    print(main(["export", sys.argv[1], "--out", "policy.onnx"]))
print(said.getvalue())
"""
    told = run_python(program, str(tmp_path / "no-run")).split("\n", 1)
    assert told[0] == "2"
    assert told[1].strip() == "error: exporting needs ONNX: pip install -e '.[onnx]'"
