"""Laws with their tuned parameters: which they get for an environment, and how they deploy the array."""

import json

import numpy as np
import pytest

from agents.environments import make_env
from agents.laws.baselines import load_parameters, make_baseline
from agents.laws.feedback import DamperParameters, Passive, ViscousDamper
from agents.laws.table import LAWS
from agents.rollout import run_episode
from agents.torque_laws import Signals
from solar_env.environment.registration import DEPLOY_V1


@pytest.fixture(scope="module")
def env():
    made = make_env(DEPLOY_V1)
    yield made
    made.close()


def test_unknown_baseline_is_refused(env):
    with pytest.raises(ValueError, match="no baseline 'break'"):
        make_baseline("break", env)


def test_environment_without_tuned_parameters_names_the_command():
    command = r"solar-env tune --controller servo --env-id other/Env-v0 --model flexible-ideal"
    with pytest.raises(ValueError, match=command):
        load_parameters("servo", "other/Env-v0", "flexible-ideal")


def test_a_baseline_has_the_parameters_tuned_for_the_environments_own_model(configs, env):
    assert make_baseline("damper", env).parameters.damping == 0.1


@pytest.mark.parametrize("panels", ["1 element", "3 elements"])
def test_tuned_parameters_hold_for_any_number_of_elements(configs, panels):
    with make_env(DEPLOY_V1, {"model": f"flexible-clearance:{panels}"}) as made:
        assert make_baseline("damper", made).parameters.damping == 0.2


def test_a_model_that_nothing_was_tuned_for_gets_the_rigid_parameters_and_says_so(configs):
    with (
        make_env(DEPLOY_V1, {"model": "flexible-ideal"}) as made,
        pytest.warns(UserWarning, match="tuned for flexible-ideal; it gets those for rigid-clearance"),
    ):
        assert make_baseline("damper", made).parameters.damping == 0.1


def test_without_rigid_parameters_to_fall_back_on_another_model_is_refused(configs):
    (configs / "damper.json").write_text(json.dumps({DEPLOY_V1: {"flexible-clearance": {}}}))
    with pytest.raises(ValueError, match=r"no parameters for .* with model 'flexible-ideal'"):
        load_parameters("damper", DEPLOY_V1, "flexible-ideal")


@pytest.mark.filterwarnings("ignore:no parameters of .* have been tuned")
@pytest.mark.parametrize("model", ["rigid-clearance", "flexible-clearance:1 element"])
@pytest.mark.parametrize("name", LAWS)
def test_every_baseline_deploys_the_nominal_array(model, name):
    env = make_env(DEPLOY_V1, {"model": model})
    figures = run_episode(env, make_baseline(name, env), seed=0)
    assert figures["latched"]
    assert figures["latch_times_s"] <= 20.0


@pytest.fixture(scope="module")
def passive(env):
    return run_episode(env, Passive(Signals.of(env)), seed=0)


def test_tuned_servo_latches_softer_than_the_springs_alone_which_do_no_motor_work(env, passive):
    servo = run_episode(env, make_baseline("servo", env), seed=0)
    assert passive["motor_work_J"] == 0.0
    assert servo["return"] > passive["return"]
    assert servo["peak_postlock_force_N"] < 0.5 * passive["peak_postlock_force_N"]


@pytest.mark.slow
def test_the_servo_tuned_for_flexible_panels_is_better_there_than_the_one_tuned_for_rigid_ones():
    with make_env(DEPLOY_V1, {"model": "flexible-clearance:2 elements"}) as flexible:
        rigid = load_parameters("servo", DEPLOY_V1, "rigid-clearance")
        own, other = (run_episode(flexible, make_baseline("servo", flexible, p), seed=0) for p in (None, rigid))
    assert own["return"] > 0.5 * other["return"]
    assert own["peak_postlock_force_N"] < 0.5 * other["peak_postlock_force_N"]


def test_a_damper_that_stalls_the_array_misses_the_deadline_and_has_no_postlock_figures(env, passive):
    stalled = run_episode(env, ViscousDamper(Signals.of(env), DamperParameters(damping=6.0)), seed=0)
    assert not stalled["latched"]
    assert np.isnan(stalled["peak_postlock_force_N"])
    assert stalled["return"] < passive["return"]
