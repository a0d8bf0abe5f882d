"""Whatever reads what users hand over: changed inputs are read, or end in the documented exceptions."""

import contextlib
import io
import json
import random
import warnings

import gymnasium
import pytest
from stable_baselines3 import PPO

from agents.learning import runs
from agents.policies.saved_models import read_model
from solar_env.array import ArrayParameters, read_parameters
from solar_env.array.deployment import simulate
from solar_env.array.ladder import PACKAGED_TABLE, QUESTIONS, cheapest, read_answers
from solar_env.commands.arguments import parse_arguments
from solar_env.commands.simulate import Args
from solar_env.environment.registration import DEPLOY_V1
from solar_env.mechanics.running.trajectory import Trajectory
from solar_env.studies.common.tables import read_table
from solar_env.support.campaigns import Campaign
from solar_env.support.plain_arrays import parse_json

RUN = {"algo": "ppo", "env_id": DEPLOY_V1, "env_kwargs": {}, "seed": 0, "n_envs": 1, "timesteps": 9}
RUN |= {"hyperparameters": {}, "versions": {}, "command": ""}


def read_run(path):
    path.rename(path.parent / runs.CONFIG)
    runs.read_config(path.parent)


def read_changes(path):
    changes = parse_json(path.read_bytes())
    ArrayParameters().with_changes(changes if isinstance(changes, dict) else {"clearance": changes})


def read_command_line(path):
    with contextlib.redirect_stderr(io.StringIO()), contextlib.redirect_stdout(io.StringIO()):
        parse_arguments(Args, path.read_bytes().decode(errors="replace").split("\n"))


def a_trajectory(folder):
    simulate(model="rigid-ideal", duration=0.02, output_step=0.01).save(folder / "whole.npz")
    return [(folder / "whole.npz").read_bytes()]


def a_model(folder):
    env = gymnasium.make("solar_env/Deploy-v2", model="rigid-ideal")
    PPO("MlpPolicy", env, device="cpu", policy_kwargs={"net_arch": [2]}).save(folder / "model.zip")
    return [(folder / "model.zip").read_bytes()]


# Name -> how the file is read, and what is changed.
READERS = {
    "trajectory": (lambda path: Trajectory.load(path, most_bytes=2**20).summary(), a_trajectory),
    "run folder": (read_run, lambda _: [json.dumps(RUN).encode()]),
    "model": (read_model, a_model),
    "table": (
        lambda path: read_table(path).column("error"),
        lambda _: [b"# command: x\nmethod,error,wall_s\nours,0.1,2\nother,1e-3,5\n"],
    ),
    "ladder": (
        lambda path: cheapest(read_answers(path), next(iter(QUESTIONS)), 0.5),
        lambda _: [PACKAGED_TABLE.read_bytes()],
    ),
    "results": (
        lambda path: Campaign(json.dumps, [{"a": 1}], path),
        lambda _: [b'{"code": "0"}\n{"cell": {"a": 1}, "result": 2}\n'],
    ),
    "parameters": (read_changes, lambda _: [b'{"clearance": [1e-4, 2e-4], "contact_law": "flores"}', b"1e-4"]),
    "array file": (
        read_parameters,
        lambda _: [b"clearance = [1e-4, 2e-4]\n[tolerance]\nspring_stiffness = 0.01\n"],
    ),
    "command line": (read_command_line, lambda _: [b"--set\nclearance=1e-4,2e-4\n--duration\n3\n--json\n-"]),
}


def changed(content, chance):
    """An input with some bytes left out, doubled, or replaced."""
    content = bytearray(content)
    for _ in range(chance.randint(1, 4)):
        start = chance.randint(0, len(content))
        piece = slice(start, start + chance.randint(1, 20))
        tokens = (b"-1", b"1e999", b"nan", b"null", b"[", b'"', b"\x00", b"\xff", chance.randbytes(1))
        content[piece] = chance.choice((b"", content[piece] * 2, chance.choice(tokens)))
    return bytes(content[: chance.choice((None, None, len(content) // 2))])


@pytest.mark.parametrize("name", READERS)
def test_changed_inputs_are_refused_as_documented_or_read(name, tmp_path):
    (read, beginnings), chance, refused = READERS[name], random.Random(0), 0
    tries = 30 if name == "command line" else 150
    path = tmp_path / ("array.toml" if name == "array file" else "file")
    contents = beginnings(tmp_path)
    for k in range(tries):
        content = contents[k % len(contents)]
        path.write_bytes(content if k < len(contents) else changed(content, chance))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            try:
                read(path)
            except (ValueError, SystemExit):
                refused += 1
    assert 0.1 * tries < refused < tries
