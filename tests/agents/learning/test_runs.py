"""Training runs of a few hundred steps: the folder they leave, how they repeat themselves and how they resume."""

import io
import json
import pickle
import re
from dataclasses import asdict, replace

import numpy as np
import pytest
from training import SMALL, last_model, run

from agents.comparison.evaluation import common_environment, evaluate
from agents.learning import checkpoints, learn, runs

pytestmark = pytest.mark.usefixtures("few_validation_episodes")


@pytest.mark.filterwarnings("ignore:no parameters of .* have been tuned")
def test_a_run_keeps_its_model_and_is_resumed_and_evaluated_on_it(tmp_path):
    model = "flexible-clearance:1 element"
    quick = ["--env-kwargs", "deadline=0.5", "settling_window=0.2", "control_period=0.1"]
    quick += ["--n-envs", 1, "--algo", "ppo"]
    small = ["--timesteps", 20, "--hyperparams", "n_steps=10", "batch_size=10"]
    first = run("--model", model, *quick, *small, "--out", tmp_path / "first")
    config = runs.read_config(first)
    assert config.env_kwargs["model"] == model
    assert common_environment([str(first)])[1]["model"] == model
    second = run("--resume", first, "--timesteps", 10, "--out", tmp_path / "second")
    assert runs.read_config(second).env_kwargs == config.env_kwargs


SEARCH = ["--algo", "cma-es", "--env-kwargs", "control_period=0.5", "settling_window=2.0", "--timesteps", 100]
SEARCH += ["--n-envs", 2, "--hyperparams", "population=4"]


def test_a_training_that_is_refused_leaves_no_folder(tmp_path):
    with pytest.raises(ValueError, match="render_mode"):
        run("--model", "rigid-ideal", *SEARCH[:4], "render_mode=human", *SEARCH[5:], "--out", tmp_path / "run")
    assert list(tmp_path.iterdir()) == []


def policy_weights(folder):
    """Weights that a run has come to."""
    weights = checkpoints.read(folder)["parameters"]["policy"]
    return np.concatenate([values.numpy().ravel() for values in weights.values()])


def test_a_run_folder_holds_all_that_describes_the_run(ppo_run):
    expected = {*runs.POLICY, *runs.CHECKPOINTS, "config.json", "timing.json", "evaluations.npz", "monitor.csv"}
    expected |= {"tensorboard", "figure.png", "episodes.csv", "metrics.json", "comparison.md"}
    assert {path.name for path in ppo_run.iterdir()} == expected
    config = json.loads((ppo_run / "config.json").read_text())
    assert config["hyperparameters"]["n_steps"] == 300
    assert config["command"].startswith("solar-env train --quiet --eval-episodes 2 ")
    assert config["versions"]["torch"]
    metrics = json.loads((ppo_run / "metrics.json").read_text())
    assert list(metrics["controllers"]) == ["passive", "servo-untuned", "servo", "ppo"]


def test_the_same_seed_trains_the_same_policy_and_another_seed_another(ppo_run, tmp_path):
    config = runs.read_config(ppo_run)
    for name, changed in (("same", config), ("other", replace(config, seed=1))):
        (tmp_path / name).mkdir()
        learn.train(learn.Training(changed, tmp_path / name, progress=False, threads=1))
    np.testing.assert_array_equal(policy_weights(ppo_run), policy_weights(tmp_path / "same"))
    assert not np.array_equal(policy_weights(ppo_run), policy_weights(tmp_path / "other"))


def test_resuming_continues_step_count_normalisation_and_validation_history(ppo_run, tmp_path):
    resumed = run("--resume", ppo_run, "--timesteps", 600, "--out", tmp_path / "resumed")
    config = runs.read_config(resumed)
    assert config.resumed_from == str(ppo_run)
    assert config.timesteps_before == 600
    assert config.hyperparameters["n_steps"] == 300
    assert last_model(resumed).num_timesteps == 1200
    before, after = (checkpoints.read(of)["layers"][0]["statistics"]["count"] for of in (ppo_run, resumed))
    assert after == pytest.approx(before + 600, rel=1e-3)
    old, new = (runs.read_evaluations(folder) for folder in (ppo_run, resumed))
    assert old["timesteps"].tolist() == new["timesteps"].tolist()[:2] == [0, 600]
    assert old["results"].shape == (2, learn.VALIDATION_EPISODES)
    assert new["timesteps"][-1] > 600


@pytest.mark.parametrize(
    ("name", "value", "told"),
    [
        ("timesteps", "many", "timesteps is 'many'; give a whole number"),
        ("n_envs", 0, "n_envs is 0; give a positive number"),
        ("seed", -1, "seed is -1; give a whole number, not negative"),
        ("hyperparameters", [], r"hyperparameters is \[\]; give a mapping"),
        ("algo", "a2c", "no algorithm 'a2c'; available: ppo, sac"),
        ("env_id", "module_of_a_stranger:Env-v0", "env_id is .*; give an environment of solar_env"),
        ("resumed_from", 3, "resumed_from is 3; give a text or null"),
    ],
)
def test_a_value_of_another_kind_in_a_configuration_is_told(tmp_path, ppo_run, name, value, told):
    stored = asdict(runs.read_config(ppo_run))
    runs.write_json(tmp_path / runs.CONFIG, {**stored, name: value})
    with pytest.raises(ValueError, match=rf"config\.json: {told}.*, or train the run anew"):
        runs.read_config(tmp_path)
    del stored[name]
    runs.write_json(tmp_path / runs.CONFIG, stored)
    with pytest.raises(ValueError, match=r"config\.json describes no training run: .*; train the run anew"):
        runs.read_config(tmp_path)


def copied(run_folder, folder):
    """A copy of a run's files, in a folder of its own."""
    for name in (runs.CONFIG, runs.TIMING, runs.EVALUATIONS, *runs.POLICY, *runs.CHECKPOINTS):
        if (run_folder / name).is_file():
            (folder / name).write_bytes((run_folder / name).read_bytes())
    return folder


@pytest.mark.parametrize("changes", [{"algo": "sac"}, {"env_kwargs": {"model": "rigid-ideal"}}])
def test_a_configuration_that_does_not_fit_the_checkpoint_is_not_gone_on_with(tmp_path, ppo_run, changes):
    copied(ppo_run, tmp_path)
    runs.write_json(tmp_path / runs.CONFIG, {**asdict(runs.read_config(tmp_path)), **changes})
    with pytest.raises(ValueError, match=r"does not fit the config\.json beside it|refuses its hyperparameters"):
        run("--resume", tmp_path, "--timesteps", 600, "--out", tmp_path / "resumed")
    assert not (tmp_path / "resumed").exists()


class Trap:
    """Runs when the object is unpickled."""

    def __reduce__(self):
        return pytest.fail, ("a stranger's file was executed",)


@pytest.mark.parametrize("damage", ["emptied", "cut", "changed", "pickled", "array of objects"])
@pytest.mark.parametrize("name", [runs.CONFIG, *runs.POLICY, runs.EVALUATIONS, runs.CHECKPOINTS[0]])
def test_a_damaged_or_evil_file_of_a_run_is_named_in_one_sentence_and_executes_nothing(tmp_path, ppo_run, name, damage):
    path = copied(ppo_run, tmp_path) / name
    content = path.read_bytes()
    middle = len(content) // 2
    changed = content[: middle - 4] + b"\x00\xff\x00\xff" + content[middle:]
    objects = io.BytesIO()
    np.savez(objects, weights_1=np.array([Trap()], dtype=object), tree=np.array([Trap()], dtype=object))
    damaged = {"emptied": b"", "cut": content[:middle], "changed": changed}
    damaged |= {"pickled": pickle.dumps(Trap()), "array of objects": objects.getvalue()}
    path.write_bytes(damaged[damage])
    (tmp_path / runs.CHECKPOINTS[1]).unlink()
    readers = {runs.CONFIG: runs.read_config, runs.EVALUATIONS: runs.read_evaluations}
    readers |= {of: lambda folder: evaluate([str(folder)], 1, 0) for of in runs.POLICY}
    with pytest.raises(ValueError, match=re.escape(str(tmp_path))) as refused:
        readers.get(name, checkpoints.read)(tmp_path)
    message = str(refused.value)
    assert "\n" not in message
    assert re.search(r"; (train|resume|restore|start) ", message)


def test_a_folder_with_a_run_is_not_overwritten(ppo_run):
    with pytest.raises(FileExistsError, match="holds a run already"):
        run("--out", ppo_run, *SMALL["ppo"])
