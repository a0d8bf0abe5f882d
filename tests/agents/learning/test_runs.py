"""Training runs of a few hundred steps: the folder they leave, how they repeat themselves, go on and are read."""

import json
import pickle
import re
from dataclasses import asdict

import numpy as np
import pytest
from training import QUICK_RUN, SMALL, run

from agents.comparison.evaluation import common_environment, evaluate
from agents.learning import runs
from agents.learning.training import ALGORITHMS
from solar_env.environment.registration import DEPLOY

pytestmark = pytest.mark.filterwarnings("ignore:no parameters of .* have been tuned")


def weights(folder, name=runs.LAST):
    """Weights of a model that a run has left."""
    return np.concatenate([of.ravel() for layer in runs.read_model(folder / name).layers for of in layer])


def test_a_run_folder_holds_all_that_describes_the_run(ppo_run):
    expected = {runs.CONFIG, runs.BEST, runs.LAST, runs.EVALUATIONS, "PPO_1"}
    expected |= {"figure.png", "episodes.csv", "metrics.json", "comparison.md"}
    assert {path.name for path in ppo_run.iterdir()} == expected
    config = json.loads((ppo_run / runs.CONFIG).read_text())
    assert config["hyperparameters"]["n_steps"] == 64
    assert config["command"].startswith("solar-env train --quiet --eval-episodes 2 ")
    assert config["versions"]["torch"]
    metrics = json.loads((ppo_run / "metrics.json").read_text())
    assert list(metrics["controllers"]) == ["passive", "pd", "servo", "ppo"]
    assert common_environment([str(ppo_run)])[1]["model"] == "rigid-ideal"


@pytest.mark.parametrize("algo", ALGORITHMS)
def test_every_algorithm_trains_from_a_seed_and_is_evaluated(algo, tmp_path):
    for name, seed in (("one", 0), ("same", 0), ("other", 1)):
        run("--algo", algo, *SMALL.get(algo, QUICK_RUN), "--seed", seed, "--out", tmp_path / name, compare=False)
    one, same, other = (weights(tmp_path / name) for name in ("one", "same", "other"))
    assert np.array_equal(one, same)
    assert not np.array_equal(one, other)
    (row,) = evaluate([str(tmp_path / "one")], 1, 0, DEPLOY, {"model": "rigid-ideal"}, progress=False)
    assert np.isfinite(row["return"])


def test_a_training_goes_on_from_its_last_validation(ppo_run, tmp_path):
    for name in (runs.CONFIG, runs.BEST, runs.LAST, runs.EVALUATIONS):
        (tmp_path / name).write_bytes((ppo_run / name).read_bytes())
    before = runs.read_evaluations(tmp_path)
    run("--resume", tmp_path, "--timesteps", 384, compare=False)
    after = runs.read_evaluations(tmp_path)
    assert after["timesteps"][: len(before["timesteps"])].tolist() == before["timesteps"].tolist()
    assert before["timesteps"][-1] < 384 - 64 <= after["timesteps"][-1] <= 384
    assert not np.array_equal(weights(ppo_run), weights(tmp_path))


@pytest.mark.parametrize(
    ("name", "value", "told"),
    [
        ("timesteps", "many", "timesteps is 'many'; give a whole number"),
        ("n_envs", 0, "n_envs is 0; give a positive number"),
        ("seed", -1, "seed is -1; give a whole number, not negative"),
        ("hyperparameters", [], r"hyperparameters is \[\]; give a mapping"),
        ("env_id", "module_of_a_stranger:Env-v0", "env_id is .*; give an environment of solar_env"),
    ],
)
def test_a_value_of_another_kind_in_a_configuration_is_told(tmp_path, ppo_run, name, value, told):
    stored = asdict(runs.read_config(ppo_run))
    runs.write_json(tmp_path / runs.CONFIG, {**stored, name: value})
    with pytest.raises(ValueError, match=rf"config\.json: {told}.*, or train the run anew"):
        runs.read_config(tmp_path)
    del stored[name]
    runs.write_json(tmp_path / runs.CONFIG, stored)
    with pytest.raises(ValueError, match=r"config\.json describes no training run: .*; train anew"):
        runs.read_config(tmp_path)


class Trap:
    """Runs when the object is unpickled."""

    def __reduce__(self):
        return pytest.fail, ("a stranger's file was executed",)


@pytest.mark.parametrize("damage", ["emptied", "cut", "changed", "pickled"])
@pytest.mark.parametrize("name", [runs.CONFIG, runs.BEST, runs.EVALUATIONS])
def test_a_damaged_or_evil_file_of_a_run_is_named_in_one_sentence_and_executes_nothing(tmp_path, ppo_run, name, damage):
    for each in (runs.CONFIG, runs.BEST, runs.EVALUATIONS):
        (tmp_path / each).write_bytes((ppo_run / each).read_bytes())
    path = tmp_path / name
    content = path.read_bytes()
    # Most of a model's file is of the optimiser, which nobody reads.
    middle = content.find(b"policy.pth") + 500 if name == runs.BEST else len(content) // 2
    changed = content[: middle - 4] + b"\x00\xff\x00\xff" + content[middle:]
    damaged = {"emptied": b"", "cut": content[:middle], "changed": changed, "pickled": pickle.dumps(Trap())}
    path.write_bytes(damaged[damage])
    readers = {runs.CONFIG: runs.read_config, runs.EVALUATIONS: runs.read_evaluations, runs.BEST: runs.best_policy}
    with pytest.raises(ValueError, match=re.escape(str(tmp_path))) as refused:
        readers[name](tmp_path)
    assert "\n" not in str(refused.value)


def test_a_folder_with_a_run_is_not_overwritten(ppo_run):
    with pytest.raises(FileExistsError, match="holds a run already"):
        run("--out", ppo_run, *SMALL["ppo"])
