"""The search tries futures without touching the present, keeps its promises, and is never worse than its base law."""

import pickle

import numpy as np
import pytest
from training import write_run

from agents.comparison.controllers import parse_controller
from agents.comparison.receding_horizon import RecedingHorizon, SearchSettings
from agents.environments import make_env
from agents.laws.feedback import DamperParameters, ViscousDamper
from agents.rollout import run_episode
from agents.torque_laws import DeterministicController, Signals
from solar_env.environment.registration import DEPLOY, DEPLOY_RANDOMISED_V1, DEPLOY_V1

# Strong springs deploy the array within three seconds.
SHORT = {
    "parameters": {"spring_stiffness": 2.0},
    "randomize": {"clearance": (1e-4, 3e-4)},
    "deadline": 4.0,
    "settling_window": 0.3,
}
QUICK = SearchSettings(knots=4, candidates=5, elites=2, replan_after=1.2, initial_deviation=0.2, least_deviation=0.02)


def make(env_id=DEPLOY_V1, **keywords):
    return make_env(env_id, {**SHORT, **keywords})


def damper(env):
    """A law that latches the strong springs' array in time."""
    return ViscousDamper(Signals.of(env), DamperParameters(0.5, 0.5))


class SteadyRate(DeterministicController):
    """0.25 rad/s, with which the array latches after seven seconds."""

    def act(self, observation):
        return np.zeros((*np.shape(observation)[:-1], 1), dtype=np.float32)


def search(env, seed=0):
    return RecedingHorizon(env, damper(env), QUICK, seed)


def played(env, controller, seed=0):
    """Return, actions and predicted returns of an episode."""
    actions, act = [], controller.act
    controller.act = lambda observation: actions.append(act(observation)) or actions[-1]
    figures = run_episode(env, controller, seed)
    controller.act = act
    return figures["return"], np.array(actions), controller.predicted_returns


def brought_into_contact(env):
    """Step on until a joint has latched and a journal touches its bearing."""
    env.reset(seed=3)
    for _ in range(60):
        observation, *_ = env.step([0.1])
        joints = env.unwrapped.simulation.state.joints
        if joints["latched"].any() and joints["in_contact"].any():
            return observation
    raise AssertionError("no contact to begin with")


def everything(env):
    """All that goes into the rest of an episode, as bytes."""
    unwrapped = env.unwrapped
    episodes = unwrapped._episodes
    kept = [
        unwrapped.simulation.snapshot(),
        unwrapped.simulation.model,
        episodes.parameters,
        episodes.observations,
        episodes._periods,
        vars(episodes._sensors),
        unwrapped.np_random.bit_generator.state,
    ]
    return pickle.dumps(kept)


@pytest.mark.parametrize(
    ("env_id", "action", "observation"),
    [
        (DEPLOY_V1, "torque", "history"),
        (DEPLOY_V1, "log_rate", "scaled"),
        (DEPLOY_RANDOMISED_V1, "torque", ["theta_1_ago"]),
        (DEPLOY_RANDOMISED_V1, "log_rate", "scaled"),
    ],
)
def test_futures_go_on_to_the_bits_of_the_environment_from_the_middle_of_a_contact(env_id, action, observation):
    env = make(env_id, action=action, observation=observation)
    observed = brought_into_contact(env)
    futures = env.unwrapped.futures(3)
    assert futures.parameters == [env.unwrapped.episode_parameters] * 3
    assert futures.settings.observation_names == env.unwrapped.observation_names
    np.testing.assert_array_equal(futures.observations, [observed] * 3)
    for held in (0.3, -0.8, 0.1, 0.0):
        futures.step(np.arange(3), np.array([[held], [-1.0], [held]]))
        observed, *_, info = env.step([held])
        for lane in (0, 2):
            for mine, theirs in zip(futures.batch.simulations[lane].state, env.unwrapped.simulation.state, strict=True):
                assert mine.tobytes() == theirs.tobytes()
            assert futures.terms[lane].tolist() == list(info["reward_terms"].values())
            np.testing.assert_array_equal(futures.observations[lane], observed)
    assert futures.batch.simulations[0].state.v.tobytes() != futures.batch.simulations[1].state.v.tobytes()


@pytest.mark.parametrize("env_id", [DEPLOY_V1, DEPLOY_RANDOMISED_V1])
def test_planning_leaves_the_environment_as_it_was_to_the_last_bit(env_id):
    env = make(env_id)
    observation = brought_into_contact(env)
    before = everything(env)
    search(env).predict(observation)
    assert everything(env) == before


@pytest.mark.parametrize("env_id", [DEPLOY_V1, DEPLOY_RANDOMISED_V1])
def test_what_was_predicted_comes_to_pass_and_predictions_only_improve(env_id):
    env = make(env_id)
    realised, actions, predicted = played(env, search(env))
    assert realised == pytest.approx(predicted[-1], rel=1e-12)
    assert len(predicted) == -(-len(actions) // 12)
    assert np.all(np.diff(predicted) >= 0.0)
    assert predicted[-1] > predicted[0] >= run_episode(env, damper(env), 0)["return"]


def test_what_was_predicted_comes_to_pass_though_the_loop_of_the_drive_measures_rates_with_noise():
    env = make(DEPLOY_RANDOMISED_V1, action="log_rate", deadline=8.0)
    settings = SearchSettings(knots=4, candidates=3, elites=2, iterations=1, initial_deviation=0.005)
    realised, _, predicted = played(env, RecedingHorizon(env, SteadyRate(), settings))
    assert realised == pytest.approx(predicted[-1], rel=1e-12)
    assert realised >= run_episode(env, SteadyRate(), 0)["return"] > -25.0


def test_it_repeats_itself_to_the_last_bit_and_depends_on_its_seed():
    env = make(DEPLOY_RANDOMISED_V1, model="rigid-ideal")
    controller = search(env)
    first, again = played(env, controller), played(env, controller)
    fresh, other = played(env, search(env)), played(env, search(env, seed=1))
    for repeated in (again, fresh):
        assert repeated[0] == first[0]
        assert repeated[1].tobytes() == first[1].tobytes()
        assert repeated[2] == first[2]
    assert other[2] != first[2]


def test_around_a_trained_policy_it_acts_as_that_was_trained_to_and_is_no_worse(tmp_path):
    write_run(tmp_path / "steady", env_kwargs={"model": "rigid-ideal", "observation": "scaled"})
    around = parse_controller(f"receding-horizon:{tmp_path / 'steady'}")
    env = make_env(DEPLOY, {"model": "rigid-ideal", **around.interface()})
    policy = parse_controller(str(tmp_path / "steady")).load(env)
    settings = SearchSettings(candidates=4, elites=2, iterations=1, replan_after=10.0)
    realised, _, predicted = played(env, RecedingHorizon(env, policy, settings))
    assert realised == pytest.approx(predicted[-1], rel=1e-12)
    assert realised >= run_episode(env, policy, 0)["return"]


def test_around_another_controller_it_has_a_name_of_its_own_and_the_files():
    policy, around = parse_controller("runs/a"), parse_controller("bound=receding-horizon:runs/a")
    assert around.name == "bound"
    assert around.files() == policy.files()
    assert parse_controller("receding-horizon:runs/seed-0").name == "receding-horizon:runs/seed-0"


def test_a_search_around_nothing_or_around_a_search_is_refused():
    for text in ("receding-horizon", "bound=receding-horizon", "receding-horizon:receding-horizon:servo"):
        with pytest.raises(ValueError, match="searches around another controller, and not around"):
            parse_controller(text)
    runs = ("receding-horizon:runs/receding-horizon", "runs/receding-horizon")
    assert [parse_controller(run).resolved.endswith("runs/receding-horizon") for run in runs] == [True, True]
