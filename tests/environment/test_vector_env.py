"""The vector environment is many single ones, bit for bit, and keeps Gymnasium's conventions for vectors."""

from __future__ import annotations

from functools import partial

import gymnasium
import numpy as np
import pytest
from deployments import LEVELS
from episodes import LANES, RANGES, STRONG, assert_same, make_vector, random_actions
from gymnasium.vector import AutoresetMode, SyncVectorEnv

from solar_env.environment.registration import DEPLOY_V1
from solar_env.environment.task.observations import OBSERVABLES
from solar_env.environment.task.reward import REWARD_TERMS


def make_sync(mode=AutoresetMode.NEXT_STEP, lanes=LANES, **keywords):
    return SyncVectorEnv([partial(gymnasium.make, DEPLOY_V1, **keywords)] * lanes, autoreset_mode=mode)


@pytest.mark.parametrize("longest", [None, 23], ids=["whole episodes", "truncated"])
@pytest.mark.parametrize("mode", AutoresetMode)
def test_it_gives_what_sync_vector_env_gives_bit_for_bit(mode, longest):
    keywords = {"randomize": RANGES, "parameters": STRONG, "max_episode_steps": longest, "settling_window": 2.0}
    # All that there is to observe and to charge.
    keywords["observation"] = [row.name for row in OBSERVABLES]
    keywords["reward"] = {**{term.name: 1.0 for term in REWARD_TERMS}, "missed_deadline": 100.0}
    native, sync = make_vector(autoreset_mode=mode, **keywords), make_sync(mode, **keywords)
    assert_same(native.reset(seed=7), sync.reset(seed=7))
    ended = 0
    for actions in random_actions(75):
        one, other = native.step(actions), sync.step(actions)
        assert_same(one, other)
        over = one[2] | one[3]
        ended += over.sum()
        if mode is AutoresetMode.DISABLED and over.any():
            options = {"reset_mask": over}
            assert_same(native.reset(options=dict(options)), sync.reset(options=dict(options)))
    assert ended >= LANES


@pytest.mark.parametrize("level", LEVELS)
def test_a_lane_equals_the_single_environment_with_its_seed(level):
    ranges = {**RANGES, "panel_young": (2.5e8, 3.1e8)}
    keywords = {"model": level, "randomize": ranges, "parameters": STRONG, "observation": "privileged"}
    native = make_vector(**keywords)
    first, _ = native.reset(seed=11)
    steps = [native.step(actions) for actions in random_actions(6)]
    for lane in range(LANES):
        single = gymnasium.make(DEPLOY_V1, **keywords)
        assert_same(single.reset(seed=11 + lane)[0], first[lane])
        for actions, (observations, rewards, *_) in zip(random_actions(6), steps, strict=True):
            observation, reward, *_ = single.step(actions[lane])
            assert_same(observation, observations[lane])
            assert reward == rewards[lane]


@pytest.mark.parametrize("lanes", [1, 7])
def test_results_depend_neither_on_the_number_of_threads_nor_on_that_of_lanes(lanes):
    runs = []
    for threads in (1, 2, 5):
        env = make_vector(lanes, num_threads=threads, randomize=RANGES, parameters=STRONG)
        env.reset(seed=5)
        runs.append([env.step(actions[:lanes]) for actions in random_actions(25, 7)])
    assert_same(runs[0], runs[1])
    assert_same(runs[0], runs[2])
    few = make_vector(1, randomize=RANGES, parameters=STRONG)
    few.reset(seed=5)
    for actions, step in zip(random_actions(25, 7), runs[0], strict=True):
        assert_same(few.step(actions[:1])[0][0], step[0][0])


def test_lanes_may_have_parameters_of_their_own():
    designs = [{"spring_stiffness": 2.0}, {"spring_stiffness": 1.0, "clearance": 4e-4}]
    env = make_vector(2, parameters=designs)
    env.reset(seed=0)
    for lane, design in enumerate(designs):
        single = gymnasium.make(DEPLOY_V1, parameters=design)
        single.reset(seed=0)
        for actions in random_actions(5, 2):
            single.step(actions[lane])
        lone = single.unwrapped.simulation.state
        assert env.unwrapped.episodes.parameters[lane].spring_stiffness == design["spring_stiffness"]
        if lane == 0:
            for actions in random_actions(5, 2):
                env.step(actions)
        assert env.unwrapped.episodes.batch.simulations[lane].state.q.tobytes() == lone.q.tobytes()
    with pytest.raises(ValueError, match="parameters has 2 entries for num_envs = 3"):
        make_vector(3, parameters=designs)


# Against the clearances that are drawn, of which some are larger.
DRAWN = [{}, {"journal_radius": 2.5e-4}]


@pytest.mark.parametrize("parameters", [[{}, {"wear_bins": 90}], [{}, {"clearance": -1.0}], [{}, 3], [{}], DRAWN])
def test_a_reset_that_is_refused_begins_nothing_and_draws_nothing(parameters):
    env, other = (make_vector(2, randomize=RANGES) for _ in range(2))
    for each in (env, other):
        each.reset(seed=0)
        each.step(random_actions(1, 2)[0])
    refusals = r"wear_bins = 90 changes|clearance = (-1|.0.0003, )|must be a mapping|1 entries for num_envs = 2"
    with pytest.raises(ValueError, match=refusals):
        env.reset(options={"parameters": parameters})
    assert_same(env.step(random_actions(1, 2)[0]), other.step(random_actions(1, 2)[0]))
    assert_same(env.reset(), other.reset())


def test_a_first_reset_of_some_lanes_is_refused_before_it_seeds_any():
    env = make_vector(2, autoreset_mode=AutoresetMode.DISABLED).unwrapped
    seeds = env.np_random_seed
    with pytest.raises(gymnasium.error.ResetNeeded, match="must be one of all lanes"):
        env.reset(seed=5, options={"reset_mask": np.array([True, False])})
    assert env.np_random_seed == seeds


def test_parameters_by_lane_go_to_their_lanes_under_a_mask_too():
    env = make_vector(3, autoreset_mode=AutoresetMode.DISABLED)
    env.reset(seed=0)
    options = {"parameters": [{"clearance": 1e-4}, {}, {"clearance": 3e-4}]}
    env.reset(options={**options, "reset_mask": np.array([False, True, True])})
    assert [parameters.clearance for parameters in env.unwrapped.episodes.parameters] == [2e-4, 2e-4, 3e-4]


def test_returned_arrays_are_the_callers():
    env = make_vector(2)
    observations, _ = env.reset(seed=0)
    kept = [observations.copy()]
    results = [observations]
    for actions in random_actions(3, 2):
        step = env.step(actions)
        results += [*step[:4], step[4]["time_s"], step[4]["reward_terms"]["wear"]]
        kept += [array.copy() for array in results[-6:]]
    for result, saved in zip(results, kept, strict=True):
        assert result.tobytes() == saved.tobytes()
        result[...] = 1
    assert_same(env.step(random_actions(1, 2)[0])[0].shape, (2, 9))


def test_seeds_are_by_lane_and_none_goes_on():
    env = make_vector(3, randomize=RANGES)
    env.reset(seed=[4, None, 9])
    assert env.np_random_seed[0] == 4
    assert env.np_random_seed[2] == 9
    drawn = env.unwrapped.episodes.parameters[0].clearance
    env.reset()
    assert env.unwrapped.episodes.parameters[0].clearance != drawn
    env.reset(seed=4)
    assert env.unwrapped.episodes.parameters[0].clearance == drawn
    with pytest.raises(ValueError, match="seed has 2 entries for num_envs = 3 lanes"):
        env.reset(seed=[1, 2])


def test_wrong_input_and_wrong_keywords_are_refused():
    env = make_vector(2)
    env.reset(seed=0)
    for call, message in (
        (lambda: env.step(np.zeros((3, 1))), r"shape \(3, 1\), expected \(2, 1\)"),
        (lambda: env.step(np.array([[0.0], [np.nan]])), "of lane 1 is not finite"),
        (lambda: env.step([[0.0], [10**400]]), "is no array of finite numbers"),
        (lambda: env.reset(options={"mask": 1}), "'mask' is unknown; choose from"),
        (lambda: env.reset(options={"reset_mask": [True, False]}), "array of bool"),
        (lambda: env.reset(options={"reset_mask": np.zeros(2, bool)}), "not all False"),
        (lambda: make_vector(0), "num_envs = 0"),
        (lambda: make_vector(2.5), "num_envs = 2.5 must be a whole number"),
        (lambda: make_vector(num_threads=0), "num_threads = 0"),
        (lambda: make_vector(max_episode_steps=np.nan), "max_episode_steps = nan"),
        (lambda: make_vector(render_mode="human"), "render_mode 'human'"),
        (lambda: make_vector(model="soft"), "model 'soft'"),
        (lambda: make_vector(autoreset_mode="Never"), "Never"),
    ):
        with pytest.raises(ValueError, match=message):
            call()


def test_steps_need_a_reset():
    env = make_vector(2, autoreset_mode=AutoresetMode.DISABLED, max_episode_steps=1)
    with pytest.raises(gymnasium.error.ResetNeeded, match="before using"):
        env.step(np.zeros((2, 1)))
    with pytest.raises(gymnasium.error.ResetNeeded, match="all lanes"):
        env.reset(options={"reset_mask": np.array([True, False])})
    env.reset(seed=0)
    env.step(np.zeros((2, 1)))
    with pytest.raises(gymnasium.error.ResetNeeded, match=r"lanes \[0, 1\] have ended"):
        env.step(np.zeros((2, 1)))


def test_frames_are_those_of_single_environments():
    env = make_vector(2, render_mode="rgb_array", randomize=RANGES)
    env.reset(seed=0)
    env.step(np.ones((2, 1)))
    frames = env.render()
    single = gymnasium.make(DEPLOY_V1, render_mode="rgb_array", randomize=RANGES)
    single.reset(seed=1)
    single.step(np.ones(1))
    assert np.array_equal(frames[1], single.render())
    with pytest.warns(UserWarning, match="does nothing without a render mode"):
        assert make_vector(2).render() == (None, None)
