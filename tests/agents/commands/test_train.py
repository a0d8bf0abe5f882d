"""The training command: its defaults, and arguments that are refused before anything is trained."""

import pytest
from training import run

from agents.commands import train
from solar_env.commands.arguments import parse_arguments


def test_the_defaults_are_those_of_stable_baselines3_on_the_default_environment():
    config = train.configuration(parse_arguments(train.Args, []))
    assert (config.algo, config.env_id, config.n_envs) == ("ppo", "solar_env/Deploy-v2", 1)
    assert config.hyperparameters == {"n_steps": 2048}
    eight = train.configuration(parse_arguments(train.Args, ["--n-envs", "8"]))
    assert eight.hyperparameters == {"n_steps": 256}
    given = train.configuration(parse_arguments(train.Args, ["--algo", "sac", "--hyperparams", "tau=0.01"]))
    assert given.hyperparameters == {"tau": 0.01}


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--algo", "a2c"], "no algorithm 'a2c'; available: ppo, sac, tqc"),
        (["--timesteps", "0"], "timesteps is 0; give a positive number"),
        (["--env-id", "solar_env/Fold-v0"], "no environment 'solar_env/Fold-v0' is registered"),
        (["--env-id", "CartPole-v1"], "env_id is 'CartPole-v1'; give an environment of solar_env"),
        (["--env-kwargs", "torque_limits=0.3"], "torque_limits"),
        (["--model", "flexible"], "model 'flexible' is unknown; did you mean"),
        (["--model", "flexible-clearance:0 elements"], "elements = 0"),
        (["--seed", "-1"], "seed is -1; give a whole number, not negative"),
        (["--hyperparams", "n_step=3"], r"ppo refuses \{.*'n_step'"),
        (["--hyperparams", "learning_rate=fast"], "ppo refuses .*'fast'"),
        (["--hyperparams", "n_steps=0"], "ppo refuses .*"),
        (["--hyperparams", "policy_kwargs=3"], "ppo refuses .*"),
        (["--env-kwargs", "scenario=randomised"], "leave the keyword out and choose --env-id"),
        (["--env-kwargs", "max_episode_steps=20"], "max_episode_steps cuts off have no landing to judge"),
        (["--eval-episodes", "0"], "the number of episodes is 0; choose one from 1"),
        (["--jobs", "0"], "jobs = 0"),
    ],
)
def test_wrong_arguments_are_named_before_training(tmp_path, arguments, message):
    with pytest.raises(ValueError, match=message):
        run("--out", tmp_path / "run", *arguments)
    assert not (tmp_path / "run").exists()


def test_going_on_from_something_else_than_a_run_is_refused(tmp_path):
    with pytest.raises(FileNotFoundError, match="is not a run folder"):
        run("--resume", tmp_path)
    with pytest.raises(ValueError, match="--n-envs beside --resume: a run keeps its own; leave it out"):
        run("--resume", tmp_path, "--n-envs", 4)
    with pytest.raises(ValueError, match="--algo beside --resume"):
        run("--resume", tmp_path, "--algo", "ppo")
