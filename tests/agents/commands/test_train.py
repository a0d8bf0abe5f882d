"""The training command and its configurations: defaults, and arguments that are refused."""

import pytest
from training import run

from agents.commands import train
from agents.comparison.evaluation import SUITES
from agents.environments import environment_settings
from agents.learning import runs
from solar_env.commands.arguments import parse_arguments

pytestmark = pytest.mark.usefixtures("few_validation_episodes")


@pytest.mark.parametrize(
    ("arguments", "model", "timesteps"),
    [
        ([], "flexible-clearance", 130_000),
        (["--algo", "cma-es", "--model", "rigid-clearance"], "rigid-clearance", 1_000_000),
        (["--algo", "ppo"], "rigid-clearance", 200_000),
        (["--model", "flexible-ideal:4 elements", "--timesteps", "500"], "flexible-ideal:4 elements", 500),
        (["--algo", "sac"], "rigid-clearance", 100_000),
        (["--algo", "ppo", "--model", "flexible-clearance"], "flexible-clearance", 200_000),
        (["--env-kwargs", "model=rigid-clearance"], "rigid-clearance", 1_000_000),
    ],
)
def test_a_short_training_on_flexible_panels_unless_a_model_is_named_or_single_steps_teach(arguments, model, timesteps):
    config = train.configuration(parse_arguments(train.Args, arguments))
    assert config.env_kwargs["model"] == model
    assert config.timesteps == timesteps


def test_one_of_the_keywords_of_a_policy_leaves_the_others_as_they_are():
    def policy_kwargs(hyperparameters):
        given = runs.complete(
            "ppo", SUITES["paper"], {"model": "rigid-clearance"}, seed=0, hyperparameters=hyperparameters
        )
        return given.hyperparameters["policy_kwargs"]

    usual = policy_kwargs({})
    assert policy_kwargs({"policy_kwargs": {"log_std_init": -1.0}}) == {**usual, "log_std_init": -1.0}
    assert usual["log_std_init"] != -1.0


@pytest.mark.parametrize("env_id", SUITES.values(), ids=SUITES)
@pytest.mark.parametrize("algo", ["ppo", "sac", "td3"])
def test_the_discount_reaches_over_a_whole_episode(algo, env_id):
    config = runs.complete(algo, env_id, {"model": "rigid-clearance"}, seed=0)
    period = environment_settings(env_id, config.env_kwargs).task.control_period
    assert period / (1.0 - config.hyperparameters["gamma"]) >= 30.0 - 1e-9


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--algo", "a2c"], "no algorithm 'a2c'; available: ppo, sac, td3"),
        (["--hyperparams", "n_step=3"], r"ppo refuses .*'n_step'\); change them by --hyperparams or in .*ppo\.json"),
        (["--timesteps", "0"], "timesteps is 0; give a positive number"),
        (["--env-id", "solar_env/Fold-v0"], "no hyperparameters for 'solar_env/Fold-v0'"),
        (["--env-kwargs", "torque_limits=0.3"], "torque_limits"),
        (["--model", "flexible"], "model 'flexible' is unknown; did you mean"),
        (["--model", "flexible-clearance:0 elements"], "elements = 0"),
        (["--seed", "-1"], "seed is -1; give a whole number, not negative"),
        (["--hyperparams", "learning_rate=fast"], "ppo refuses its hyperparameters .*'fast'"),
        (["--hyperparams", "n_steps=0"], "ppo refuses its hyperparameters .*division by zero"),
        (["--hyperparams", "policy_kwargs=3"], "ppo refuses its hyperparameters .*'policy_kwargs': 3"),
        (["--algo", "cma-es", "--hyperparams", "first_weights=much"], "cma-es refuses its hyperparameters .*'much'"),
        (["--hyperparams", f"first_weights={[0.5] * 17}"], "ppo refuses its hyperparameters"),
        (["--model", "rigid-clearance:4 elements"], "has rigid panels, which take no count"),
        (["--env-kwargs", "scenario=randomised"], "leave the keyword out and choose --env-id"),
        (["--env-kwargs", "max_episode_steps=20"], "max_episode_steps cuts off have no landing to judge"),
        (["--eval-episodes", "0"], "the number of episodes is 0; choose one from 1"),
        (["--jobs", "0"], "jobs = 0"),
    ],
)
def test_wrong_arguments_are_named_before_training(tmp_path, arguments, message):
    algorithm = () if "--algo" in arguments else ("--algo", "ppo")
    with pytest.raises(ValueError, match=message):
        run("--out", tmp_path / "run", *algorithm, *arguments)
    assert not (tmp_path / "run").exists()


def test_a_run_folder_with_a_name_that_is_too_long_is_refused(tmp_path):
    with pytest.raises(OSError, match="File name too long"):
        run("--out", tmp_path / ("a" * 256))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--algo", "sac"], "--algo sac: --resume goes on with the run's; leave it out"),
        (["--model", "rigid-ideal"], "--model rigid-ideal: --resume goes on"),
        (["--n-envs", "3"], "--n-envs 3: --resume goes on"),
        (["--hyperparams", "n_steps=200"], "--hyperparams .*: --resume goes on"),
    ],
)
def test_resuming_refuses_what_the_run_has_fixed(tmp_path, arguments, message):
    with pytest.raises(ValueError, match=message):
        run("--resume", tmp_path / "before", *arguments, "--out", tmp_path / "run")
    assert not (tmp_path / "run").exists()


def test_resuming_from_something_else_than_a_run_is_refused(tmp_path):
    with pytest.raises(FileNotFoundError, match="is not a run folder"):
        run("--resume", tmp_path)
