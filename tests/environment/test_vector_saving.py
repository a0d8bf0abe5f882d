"""The vector environment copied, saved, restored and forked: it goes on to the same bits."""

from __future__ import annotations

import copy
import os
import pickle

import gymnasium
import numpy as np
import pytest
from episodes import LANES, RANGES, STRONG, assert_same, make_vector, random_actions

from solar_env.environment.registration import DEPLOY_V1


@pytest.mark.parametrize(
    ("model", "copied"),
    [
        ("rigid-clearance", copy.deepcopy),
        ("flexible-clearance:1 element", copy.deepcopy),
        ("flexible-clearance:4 modes", lambda env: pickle.loads(pickle.dumps(env))),
    ],
)
def test_a_copy_goes_on_as_the_original_and_tells_the_same(model, copied):
    keywords = {
        "parameters": STRONG,
        "settling_window": 0.5,
        "randomize": RANGES,
        "observation": ["drive", "distance", "speed"],
    }
    env = make_vector(3, model=model, **keywords).unwrapped
    env.reset(seed=1)
    actions = random_actions(45, 3)
    for action in actions[:10]:
        env.step(action)
    other = copied(env)
    before = env.lane(1).simulation.snapshot()
    infos = []
    for action in actions[10:]:
        results, copies = env.step(action), other.step(action)
        assert_same(results, copies)
        infos.append(results[4])
    assert any("deployment" in info for info in infos)
    # States that were saved go into the copy's lanes, too.
    other.lane(1).simulation.restore(before)
    assert other.episodes.times[1] == pytest.approx(1.0)
    lane = copy.copy(env.lane(2))
    assert lane.simulation is env.lane(2).simulation
    for each in (env, other):
        each.close()


def test_a_simulation_of_an_earlier_episode_stays_as_it_was():
    env = make_vector(2)
    env.reset(seed=0)
    env.step(np.ones((2, 1)))
    earlier = env.unwrapped.episodes.batch.simulations[0]
    coordinates = earlier.state.q.copy()
    env.reset()
    env.step(np.zeros((2, 1)))
    assert earlier.state.q.tobytes() == coordinates.tobytes()
    earlier.advance(0.2)
    assert earlier.time == 0.2


@pytest.mark.parametrize(
    ("model", "observation"),
    [("rigid-clearance", "history"), ("rigid-clearance", "drive"), ("flexible-clearance:4 modes", "privileged")],
)
def test_a_saved_episode_goes_on_to_the_same_bits_in_any_lane_as_often_as_one_likes(observation, model):
    """Mid-contact, with a noisy and late drive, after other episodes have come and gone in its lane."""
    env = make_vector(scenario="randomised", observation=observation, max_episode_steps=42, model=model).unwrapped
    env.reset(seed=5)
    actions = random_actions(42)
    for action in actions[:30]:
        observed = env.step(action)[0]
    saved, parameters = env.lane(1).save_episode(), env.lane(1).episode_parameters
    assert env.lane(1).simulation.state.joints["in_contact"].any()

    def goes_on(lane):
        return [
            [np.array(part[lane]) for part in env.step(np.tile(action[1], (LANES, 1)))[:4]] for action in actions[30:]
        ]

    expected = goes_on(1)
    assert expected[-1][3], "the episode is truncated after its last period"
    env.reset(seed=9)
    for lane in (0, 1, 1):
        assert_same(env.lane(lane).restore_episode(saved), observed[1])
        assert env.lane(lane).episode_parameters == parameters
        assert_same(goes_on(lane), expected)


def test_an_episode_of_another_task_or_drive_is_not_gone_on_with():
    one = make_vector(1, model="rigid-ideal").unwrapped
    one.reset(seed=0)
    saved = one.lane(0).save_episode()
    for keywords in (
        {"driven_joint": 1},
        {"control_period": 0.5},
        {"hardware": {"rate_noise": 1e-3}},
        {"model": "rigid-clearance"},
        {"observation": ("rate", "theta")},
        {"reward": {"wear": 0.5}},
    ):
        other = make_vector(1, **{"model": "rigid-ideal", **keywords}).unwrapped
        other.reset(seed=0)
        (name,) = keywords.get("hardware", keywords)
        with pytest.raises(ValueError, match=rf"the saved episode had {name} = .* go on with it in an equal one"):
            other.lane(0).restore_episode(saved)


def test_an_episode_is_not_gone_on_with_by_a_drive_that_knows_other_springs():
    arrays = [{"spring_stiffness": factor} for factor in (0.1, 0.2)]
    keywords = {"model": "rigid-ideal", "parameters": arrays, "torque_limit": 1.0}
    env = gymnasium.make_vec("solar_env/Deploy-v2", 2, **keywords).unwrapped
    env.reset(seed=0)
    saved = env.lane(0).save_episode()
    env.lane(0).restore_episode(saved)
    with pytest.raises(ValueError, match="the saved episode had load = "):
        env.lane(1).restore_episode(saved)


def test_what_cannot_be_saved_or_restored_is_refused():
    env = make_vector(autoreset_mode="Disabled", deadline=0.1).unwrapped
    with pytest.raises(gymnasium.error.ResetNeeded):
        env.lane(0).save_episode()
    env.reset(seed=0)
    saved = env.lane(0).save_episode()
    env.step(random_actions(1)[0])
    with pytest.raises(gymnasium.error.ResetNeeded, match="the episode of lane 0 has ended"):
        env.lane(0).save_episode()
    other = make_vector(model="flexible-clearance:2 elements", deadline=0.1).unwrapped
    other.reset(seed=0)
    with pytest.raises(ValueError, match=r"saved episode had model = 'rigid-clearance'"):
        other.lane(0).restore_episode(saved)
    other = make_vector(2, observation="history", deadline=0.1).unwrapped
    other.reset(seed=0)
    other.step(random_actions(1, 2)[0])
    with pytest.raises(ValueError, match=r"the saved episode had observation = \('theta_1', "):
        other.lane(0).restore_episode(saved)
    assert other.episodes.times.tolist() == pytest.approx([0.1, 0.1])
    other = make_vector(reward={"wear": 2.0, "peak_impact": 0.0}, deadline=0.1).unwrapped
    other.reset(seed=0)
    with pytest.raises(ValueError, match=r"the saved episode had reward = \{'peak_impact'"):
        other.lane(0).restore_episode(saved)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork on this system")
def test_it_goes_on_in_a_forked_process(run_python):
    program = """
import os
import gymnasium, numpy as np, solar_env
import sys
env = gymnasium.make_vec(sys.argv[1], num_envs=4, num_threads=2)
env.reset(seed=0)
first = env.step(np.zeros((4, 1)))[0]
reader, writer = os.pipe()
if os.fork() == 0:
    os.write(writer, env.step(np.zeros((4, 1)))[0].tobytes())
    os._exit(0)
os.wait()
there = np.frombuffer(os.read(reader, 4096), np.float32).reshape(4, -1)
print(np.array_equal(there, env.step(np.zeros((4, 1)))[0]))
"""
    assert run_python(program, DEPLOY_V1).split() == ["True"]
