"""Exporting trained policies: that all forms act as the run's own, what the card says, and what is not written."""

import re
from dataclasses import replace

import numpy as np
import onnxruntime
import pytest
from trained import COMMAND, random_observations

from agents.commands import export
from agents.policies import onnx_form, shipped
from agents.policies.shipped import load_shipped
from solar_env.__main__ import execute
from solar_env.support.files import new_folder


def test_the_card_tells_how_the_policy_came_about_and_its_snippets_run(finished, monkeypatch, capsys):
    folder = finished["scored"][1]
    monkeypatch.setattr(shipped, "SHIPPED", folder.parent)
    card = (folder / shipped.CARD).read_text()
    assert COMMAND in card
    assert '"seed": 7' in card
    assert '"n_steps": 64' in card
    assert "9 - 64 - 64 - 1, tanh between its layers" in " ".join(card.split())
    assert "on the model rigid-ideal" in card
    assert "| passive | " in card
    assert "None were measured." in (finished["ppo"][1] / shipped.CARD).read_text()
    snippets = re.findall(r"```python\n(.*?)```", card, re.DOTALL)
    assert len(snippets) == 2
    for snippet in snippets:
        exec(snippet, {})
    assert "'return'" in capsys.readouterr().out


def test_the_command_writes_a_shipped_policy_and_overwrites_nothing(finished, tmp_path, monkeypatch):
    monkeypatch.setattr(shipped, "SHIPPED", tmp_path)
    run = str(finished["sac"][0])
    execute("export", [run, "--out", str(tmp_path / "soft")])
    names = {path.name for path in (tmp_path / "soft").iterdir()}
    assert names == {"policy.npz", "policy.json", "policy.onnx", "card.md"}
    assert shipped.available() == ["soft"]
    with pytest.raises(FileExistsError, match="soft exists; choose another --out"):
        execute("export", [run, "--out", str(tmp_path / "soft")])
    for name in ("servo", "soft=er"):
        with pytest.raises(ValueError, match=rf"the folder's name is '{name}', and the policy's"):
            execute("export", [run, "--out", str(tmp_path / name)])


def test_the_suffix_says_the_form_of_a_run_or_a_shipped_policy(finished, tmp_path):
    run, folder = finished["ppo"]
    for source, name in ((run, "run"), (folder, "shipped")):
        made = tmp_path / name
        made.mkdir()
        for suffix in (".npz", ".onnx", ".h", ""):
            execute("export", [str(source), "--out", str(made / f"policy{suffix}")])
        observations = random_observations(20)
        actions, _ = load_shipped(made / "policy").predict(observations)
        np.testing.assert_array_equal(actions, load_shipped(folder).predict(observations)[0])
        assert (made / "policy" / shipped.CARD).exists() == (source == run)
        assert (made / "policy.h").is_file()
        session = onnxruntime.InferenceSession(made / "policy.onnx")
        np.testing.assert_allclose(session.run(None, {"observation": observations})[0], actions, rtol=0.0, atol=1e-6)
    with pytest.raises(ValueError, match=r"the suffix '.zip' .* choose from .npz, .onnx, .h"):
        execute("export", [str(run), "--out", str(tmp_path / "policy.zip")])


@pytest.mark.parametrize("fault", [KeyboardInterrupt, OSError("No space left on device")])
def test_a_policy_that_could_not_be_written_whole_does_not_take_its_name(finished, tmp_path, monkeypatch, fault):
    def broken(*_):
        raise fault

    monkeypatch.setattr(shipped, "SHIPPED", tmp_path / "policies")
    run = finished["ppo"][0]
    with monkeypatch.context() as patch:
        patch.setattr(export, "write_bytes", broken)
        with pytest.raises(type(fault) if isinstance(fault, OSError) else fault):
            export.export(run, tmp_path / "policies" / "soft")
    assert list((tmp_path / "policies").iterdir()) == []
    export.export(run, tmp_path / "policies" / "soft")
    assert shipped.available() == ["soft"]


def test_what_a_kill_has_left_unfinished_is_no_shipped_policy(finished, tmp_path, monkeypatch):
    monkeypatch.setattr(shipped, "SHIPPED", tmp_path)
    with new_folder(tmp_path / "soft") as made:
        (made / shipped.DESCRIPTION).write_bytes((finished["ppo"][1] / shipped.DESCRIPTION).read_bytes())
        assert shipped.available() == []
    assert shipped.available() == ["soft"]


def test_without_onnx_the_command_says_what_to_install_before_anything_is_read(run_python, tmp_path):
    program = """
import contextlib, io, sys
sys.modules["onnxruntime"] = None
from solar_env.__main__ import main
with contextlib.redirect_stderr(io.StringIO()) as said:
    print(main(["export", sys.argv[1], "--out", "policy"]))
print(said.getvalue())
"""
    told = run_python(program, str(tmp_path / "no-run")).split("\n", 1)
    assert told[0] == "2"
    assert told[1].strip() == "error: exporting needs ONNX and its runtime: pip install 'solar-env[onnx]'"


def test_an_onnx_form_that_acts_otherwise_than_the_run_is_not_written(finished, tmp_path, monkeypatch):
    right = onnx_form.onnx_model
    monkeypatch.setattr(onnx_form, "onnx_model", lambda network: right(replace(network, activation="relu")))
    with pytest.raises(ValueError, match=r"differs from the run's policy by .*; it is not written"):
        export.export(finished["ppo"][0], tmp_path / "policy")
    assert not (tmp_path / "policy").exists()
