"""A training loses no more than an interval, whatever ends it, and goes on as if nothing had."""

import errno
import os
import re
import signal
from dataclasses import replace
from unittest.mock import Mock

import pytest

from agents.environments import DEFAULT_ENV_ID
from agents.learning import checkpoints, learn, runs
from agents.learning.storage import packed
from solar_env.support import files

pytestmark = pytest.mark.usefixtures("few_validation_episodes")
QUICK = {"model": "rigid-ideal", "control_period": 0.5, "settling_window": 2.0, "observation": "drive"}
ON_POLICY = {"n_steps": 20, "batch_size": 20}
OFF_POLICY = {"learning_starts": 30, "buffer_size": 500, "batch_size": 16, "train_freq": 10, "gradient_steps": 2}
# Name -> algorithm, hyperparameters.
AGENTS = {
    "noisy": ("ppo", ON_POLICY),  # with sensors whose noise is drawn by what draws the next episodes
    "sac": ("sac", OFF_POLICY),
    "td3": ("td3", {**OFF_POLICY, "exploration_noise": 0.2}),
    "cma-es": ("cma-es", {"population": 4, "generations_between": 2, "finalists": 1}),
    "ars": ("ars", {"n_delta": 2, "n_top": 2}),
}


SEARCHES = ("cma-es", "ars")  # whose rollouts are whole episodes of several candidates


def configuration(name="noisy", timesteps=200):
    algo, hyperparameters = AGENTS[name]
    env_kwargs = {**QUICK, "observation": "landing"} if name in SEARCHES else QUICK
    env_id = "solar_env/DeployRandomised-v1" if name == "noisy" else DEFAULT_ENV_ID
    return runs.complete(algo, env_id, env_kwargs, 5, 2, timesteps, hyperparameters)


def train(folder, config, resume=None):
    folder.mkdir(exist_ok=True)
    learn.train(learn.Training(config, folder, resume, progress=False, threads=1, checkpoint_interval=40))
    return folder


def train_until(step, folder, config):
    """Train, and let Ctrl-C come at a step; returns what it left to be read."""
    with pytest.MonkeyPatch.context() as patch:
        interrupt_at(patch, step)
        with pytest.raises(KeyboardInterrupt) as stop:
            train(folder, config)
    return stop.value.__notes__


def interrupt_at(monkeypatch, step):
    validated = learn.Validation._on_step

    def interrupted(self):
        if self.num_timesteps >= step:
            raise KeyboardInterrupt
        return validated(self)

    monkeypatch.setattr(learn.Validation, "_on_step", interrupted)


def content(folder):
    """State of a training, to the last bit: the files of the checkpoint hold nothing of the process."""
    return (folder / runs.CHECKPOINTS[0]).read_bytes()


@pytest.mark.parametrize("name", [*sorted(set(AGENTS) - {"td3"}), pytest.param("td3", marks=pytest.mark.slow)])
def test_an_interrupted_training_goes_on_bit_for_bit(name, tmp_path):
    config = configuration(name, 500 if name in SEARCHES else 200)
    whole = train(tmp_path / "whole", config)
    (note,) = train_until(400 if name in SEARCHES else 135, tmp_path / "cut", config)
    kept = re.match(r"kept the checkpoint of step (\d+); solar-env train --resume ", note)
    assert int(kept[1]) == 120 if name not in SEARCHES else 0 < int(kept[1]) < 400
    assert not runs.is_complete(tmp_path / "cut")
    folder = tmp_path / ("other" if name == "sac" else "cut")  # into another folder, or into its own
    train(folder, runs.read_config(tmp_path / "cut"), tmp_path / "cut")
    assert runs.is_complete(folder)
    assert content(folder) == content(whole)
    assert replace(runs.read_config(folder), resumed_from=None) == runs.read_config(whole)
    assert [(folder / of).read_bytes() for of in runs.POLICY] == [(whole / of).read_bytes() for of in runs.POLICY]


def test_a_training_that_is_complete_goes_on_for_as_many_steps_again(tmp_path):
    first = train(tmp_path / "first", configuration(timesteps=80))
    second = train(tmp_path / "second", runs.read_config(first), first)
    assert checkpoints.read(second)["timesteps"] == 160
    assert runs.read_config(second).timesteps_before == 80
    steps = checkpoints.read(second)["history"]["evaluations_timesteps"].tolist()
    assert steps[0] == 0
    assert steps == sorted(set(steps))


def test_a_training_interrupted_before_its_first_checkpoint_begins_again(tmp_path, monkeypatch):
    before = train(tmp_path / "before", configuration(timesteps=40))
    config = configuration(timesteps=80)
    whole, cut = train(tmp_path / "whole", config, before), tmp_path / "cut"

    with monkeypatch.context() as patch:
        patch.setattr(checkpoints.Checkpoints, "_on_rollout_start", Mock(side_effect=KeyboardInterrupt))
        with pytest.raises(KeyboardInterrupt) as stop:
            train(cut, config, before)
    (note,) = stop.value.__notes__
    assert note == f"no checkpoint was due yet; solar-env train --resume {cut} begins where this one began"
    assert not learn.has_checkpoint(cut)
    train(cut, runs.read_config(cut), cut)
    assert content(cut) == content(whole)
    assert runs.read_config(cut) == runs.read_config(whole)


def test_fewer_steps_than_an_interrupted_training_has_done_are_refused(tmp_path):
    train_until(135, tmp_path / "cut", configuration())
    with pytest.raises(ValueError, match=r"timesteps is 50: .* has trained for 120 steps; give more"):
        train(tmp_path / "other", replace(runs.read_config(tmp_path / "cut"), timesteps=50), tmp_path / "cut")


def test_a_training_that_ended_before_it_could_say_so_only_says_so(tmp_path):
    folder = train(tmp_path / "run", configuration(timesteps=70))  # in whole rollouts, more than were asked for
    before = content(folder)
    assert checkpoints.read(folder)["timesteps"] == 80
    (folder / runs.TIMING).unlink()
    train(folder, runs.read_config(folder), folder)
    assert runs.is_complete(folder)
    assert content(folder) == before


def test_where_the_newest_checkpoint_is_damaged_the_one_before_is_taken(tmp_path):
    folder = train(tmp_path / "run", configuration(timesteps=120))
    newest = folder / runs.CHECKPOINTS[0]
    whole = newest.read_bytes()
    newest.write_bytes(whole[: len(whole) // 2])
    with pytest.warns(UserWarning, match="checkpoint.npz is damaged; the checkpoint before it is taken"):
        assert checkpoints.read(folder)["timesteps"] == 80
    (folder / runs.CHECKPOINTS[1]).write_bytes(b"half")
    with (
        pytest.warns(UserWarning, match="is damaged"),
        pytest.raises(ValueError, match=r"no checkpoint in .* can be read"),
    ):
        checkpoints.read(folder)


@pytest.fixture(scope="module")
def taken(tmp_path_factory):
    """A checkpoint of a small training."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(learn, "VALIDATION_EPISODES", 2)
        return checkpoints.read(train(tmp_path_factory.mktemp("taken") / "run", configuration(timesteps=40)))


@pytest.mark.skipif(not hasattr(os, "fork"), reason="kills a child process")
@pytest.mark.parametrize(("share", "older"), [(0.0, 1), (0.999, 2), (1.0, 2)])
def test_a_kill_while_a_checkpoint_is_written_leaves_a_whole_one(tmp_path, taken, share, older):
    size = len(packed(taken))
    for number in range(older):
        checkpoints.write(tmp_path, {**taken, "timesteps": number})
    child = os.fork()
    if child == 0:
        with pytest.MonkeyPatch.context() as patch:
            after_bytes(patch, share * size, lambda: os.kill(os.getpid(), signal.SIGKILL))
            checkpoints.write(tmp_path, {**taken, "timesteps": older})
        os._exit(0)
    _, status = os.waitpid(child, 0)
    assert os.WIFSIGNALED(status)
    assert checkpoints.read(tmp_path)["timesteps"] == older - 1


@pytest.mark.parametrize("moment", [1, 2])
def test_a_kill_between_the_two_generations_leaves_a_whole_one(tmp_path, taken, moment, monkeypatch):
    for number in range(2):
        checkpoints.write(tmp_path, {**taken, "timesteps": number})
    moves = []
    move = checkpoints.Path.replace

    def stopped(self, target):
        moves.append(target)
        if self.suffix != files.PART and len(moves) > moment:
            raise KeyboardInterrupt
        return move(self, target)

    monkeypatch.setattr(checkpoints.Path, "replace", stopped)
    with pytest.raises(KeyboardInterrupt):
        checkpoints.write(tmp_path, {**taken, "timesteps": 2})
    assert checkpoints.read(tmp_path)["timesteps"] == 1


@pytest.mark.parametrize("share", [0.0, 0.999])
def test_a_full_disk_ends_a_training_and_leaves_the_checkpoint_before(tmp_path, taken, share, monkeypatch):
    for number in range(2):
        checkpoints.write(tmp_path, {**taken, "timesteps": number})

    def full():
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    after_bytes(monkeypatch, share * len(packed(taken)), full)
    with pytest.raises(OSError, match="No space left"):
        checkpoints.write(tmp_path, {**taken, "timesteps": 2})
    assert checkpoints.read(tmp_path)["timesteps"] == 1
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(runs.CHECKPOINTS)


def after_bytes(patch, count, act):
    """Write in small pieces, and act when `count` bytes are on the way to the disk."""

    def write_bytes(path, content):
        with files.writing(path) as file:
            for start in range(0, len(content), 997):
                if start >= count:
                    act()
                file.write(content[start : start + 997])
                file.flush()
            act()

    patch.setattr(checkpoints, "write_bytes", write_bytes)
