"""Run folders of strangers execute nothing, and damaged ones are told in a sentence before any work."""

import json
import os
import pickle
import re
import shutil

import pytest
from training import run

from agents.commands import export
from agents.comparison.evaluation import evaluate as evaluated
from agents.environments import make_env
from agents.learning import checkpoints, configurations, runs, trust
from agents.learning.trust import DamagedFileError, UntrustedFileError
from solar_env.__main__ import execute
from solar_env.environment.registration import DEPLOY

pytestmark = pytest.mark.usefixtures("few_validation_episodes")


@pytest.fixture
def folder(ppo_run, tmp_path):
    """A copy of a finished run."""
    return shutil.copytree(ppo_run, tmp_path / "run")


class Trap:
    """Runs when the object is unpickled."""

    def __reduce__(self):
        return pytest.fail, ("a stranger's file was executed",)


@pytest.fixture
def stranger(folder, monkeypatch):
    """A run of somebody else, whose files would execute code."""
    record = json.loads((folder / runs.CONFIG).read_text())
    with monkeypatch.context() as patch:
        patch.setattr(trust, "key", lambda: b"of somebody else")
        runs.write_config(folder, {**record, "env_id": "module_of_a_stranger:Env-v0"})
        for name in (runs.POLICY, *runs.CHECKPOINTS):
            (folder / name).write_bytes(trust.sealed(pickle.dumps(Trap())))
    return folder


COMMANDS = {
    "train": lambda folder, out: run("--resume", folder, "--out", out),
    "evaluate": lambda folder, out: execute("evaluate", ["--controllers", str(folder), "--out", str(out), "--quiet"]),
    "replay": lambda folder, out: execute("replay", ["--controllers", str(folder), "--out", f"{out}.html", "--quiet"]),
    "export": lambda folder, out: export.export(folder, out),
}


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_refuses_the_run_of_a_stranger_and_executes_nothing(command, stranger, tmp_path):
    with pytest.raises(UntrustedFileError, match=r"config\.json was not made on this account, and loading it executes"):
        COMMANDS[command](stranger, tmp_path / "out")
    assert not list((tmp_path / "out").rglob("*"))


def test_neither_a_policy_nor_a_checkpoint_of_a_stranger_is_loaded_into_ones_own_run(folder, monkeypatch):
    with monkeypatch.context() as patch:
        patch.setattr(trust, "key", lambda: b"of somebody else")
        for name in (runs.POLICY, *runs.CHECKPOINTS):
            (folder / name).write_bytes(trust.sealed(pickle.dumps(Trap())))
    with pytest.raises(UntrustedFileError, match=r"policy\.zip was not made on this account"):
        runs.load_policy(folder, make_env())
    with pytest.raises(UntrustedFileError, match=r"checkpoint\.pkl was not made on this account"):
        checkpoints.read(folder)


def test_a_configuration_that_was_changed_by_hand_is_no_longer_ones_own(folder):
    record = json.loads((folder / runs.CONFIG).read_text())
    (folder / runs.CONFIG).write_text(json.dumps({**record, "env_id": "module_of_a_stranger:Env-v0"}))
    with pytest.raises(UntrustedFileError):
        runs.read_config(folder)
    (folder / runs.CONFIG).write_text(json.dumps({**record, "seal": "é"}))
    with pytest.raises(UntrustedFileError):
        runs.read_config(folder)


def test_the_key_is_made_once_and_is_the_users_alone(tmp_path, monkeypatch):
    monkeypatch.setattr(trust, "user_data_path", lambda *_, **__: tmp_path / "data")
    assert trust.key() == trust.key()
    assert len(trust.key()) == 32
    if os.name == "posix":
        assert (tmp_path / "data" / "key").stat().st_mode & 0o777 == 0o600
        assert (tmp_path / "data").stat().st_mode & 0o777 == 0o700
    (tmp_path / "file").touch()
    monkeypatch.setattr(trust, "user_data_path", lambda *_, **__: tmp_path / "file")
    with pytest.raises(OSError, match="set XDG_DATA_HOME to a folder that can be written"):
        trust.key()


@pytest.mark.skipif(os.name != "posix", reason="permissions of POSIX")
def test_a_key_that_is_not_whole_or_not_ones_own_alone_seals_nothing(tmp_path, monkeypatch):
    monkeypatch.setattr(trust, "user_data_path", lambda *_, **__: tmp_path)
    trust.key()
    key = tmp_path / "key"
    key.chmod(0o644)
    with pytest.raises(OSError, match=r"others can read or write the key .*; delete it, and pass --trust once"):
        trust.key()
    key.chmod(0o600)
    trust.key()
    key.write_bytes(b"")
    with pytest.raises(OSError, match=r"key, has 0 bytes, not 32; delete it, and pass --trust once"):
        trust.key()
    key.write_bytes(bytes(32))
    monkeypatch.setattr(os, "getuid", lambda: key.stat().st_uid + 1)
    with pytest.raises(OSError, match=r"key, is another user's; set XDG_DATA_HOME"):
        trust.key()


@pytest.mark.parametrize("damage", ["emptied", "cut", "changed"])
@pytest.mark.parametrize("name", [runs.CONFIG, runs.POLICY, runs.EVALUATIONS])
def test_a_damaged_file_of_a_run_is_named_in_one_sentence_before_any_work(folder, name, damage, monkeypatch):
    monkeypatch.setattr("agents.comparison.evaluation.run_cells", lambda *_: pytest.fail("it went to work"))
    path = folder / name
    content = path.read_bytes()
    middle = len(content) // 2
    changed = content[: middle - 4] + b"\x00\xff\x00\xff" + content[middle:]
    path.write_bytes({"emptied": b"", "cut": content[:middle], "changed": changed}[damage])
    with pytest.raises(DamagedFileError) as refused:
        runs.read_evaluations(folder) if name == runs.EVALUATIONS else evaluated([str(folder)], 1, 0)
    message = str(refused.value)
    assert str(path) in message
    assert "\n" not in message
    assert re.search(r"; (train|resume|restore) ", message)


def test_json_that_is_no_configuration_is_refused(folder):
    (folder / runs.CONFIG).write_text("[1, 2]")
    with pytest.raises(DamagedFileError, match=r"config\.json describes no training run; name a folder that train\.py"):
        configurations.stored_configuration(folder)


def test_a_damaged_file_of_tuned_parameters_is_named(configs):
    from agents.laws.baselines import load_parameters

    (configs / "brake.json").write_text("{DEPLOY {}")
    with pytest.raises(ValueError, match=r"brake\.json is damaged: it is no JSON: Expecting.*; restore it"):
        load_parameters("brake", DEPLOY, "rigid-clearance")
