"""The environment keeps Gymnasium's and Stable-Baselines3's contracts, and its observations mean what they say."""

from __future__ import annotations

import math
import subprocess
import sys
import warnings

import gymnasium
import numpy as np
import pytest
from deployments import LEVELS
from episodes import RANGES, STRONG, main_body_spin, make
from gymnasium.utils.env_checker import check_env as check_by_gymnasium
from stable_baselines3.common.env_checker import check_env as check_by_stable_baselines3

import solar_env
from solar_env.environment.registration import CURRENT, DEPLOY_RANDOMISED_V1, DEPLOY_V1
from solar_env.environment.task.observations import OBSERVABLES
from solar_env.environment.task.reward import REWARD_TERMS


@pytest.mark.parametrize("name", CURRENT)
@pytest.mark.parametrize(
    "keywords",
    [{}, {"observation": "privileged", "randomize": RANGES, "parameters": {"panel_count": 3}}],
    ids=["default", "three panels"],
)
@pytest.mark.parametrize("model", LEVELS)
def test_both_checkers_accept_every_id_without_a_warning(name, model, keywords):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        env = gymnasium.make(name, model=model, render_mode="rgb_array", **keywords).unwrapped
        check_by_gymnasium(env)
        check_by_stable_baselines3(env)


@pytest.mark.parametrize("model", LEVELS)
def test_drive_observation_is_the_array_in_the_stated_units(model):
    env = make(model)
    env.reset(seed=0)
    for _ in range(60):
        observation, *_ = env.step([0.5])
    entries = dict(zip(env.observation_names, observation, strict=True))
    loads = env.simulation.joint_loads()
    assert entries["theta_1"] == pytest.approx(loads[0, 2] / (math.pi / 2), rel=1e-6)
    assert entries["theta_2"] == pytest.approx(loads[1, 2] / math.pi, rel=1e-6)
    assert entries["rate_2"] == pytest.approx(loads[1, 3], rel=1e-6)
    assert entries["motor_torque"] == pytest.approx(0.5)
    assert entries["time_to_deadline"] == pytest.approx(1.0 - 6.0 / 20.0)
    assert (entries["latched_1"], entries["latched_2"], entries["time_since_latch"]) == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("model", LEVELS)
def test_the_privileged_observation_adds_journals_contacts_and_the_spin_of_the_main_body(model):
    env = make(model, observation="privileged")
    env.reset(seed=0)
    for _ in range(10):
        observation, *_ = env.step([0.5])
    entries = dict(zip(env.observation_names, observation, strict=True))
    loads, state = env.simulation.joint_loads(), env.simulation.state
    clearance = 2e-4 if "clearance" in model else math.inf
    for joint in (0, 1):
        eccentricity = entries[f"eccentricity_x_{joint + 1}"], entries[f"eccentricity_y_{joint + 1}"]
        # In clearances, of which a contact's step leaves its motion off by less than a millionth.
        assert eccentricity == pytest.approx(loads[joint, :2] / clearance, abs=1e-6)
        assert entries[f"in_contact_{joint + 1}"] == state.joints["in_contact"][joint]
    assert entries["main_body_spin"] == pytest.approx(main_body_spin(state), rel=1e-6)
    assert entries["main_body_spin"] < 0.0


@pytest.mark.parametrize(
    "keywords",
    [{"observation": "privileged"}, {"observation": "history", "hardware": {"rate_noise": 5.0}}],
    ids=["past the deadline", "noise beyond the bounds"],
)
@pytest.mark.filterwarnings("ignore::solar_env.array.parameters.checks.UnitWarning")
def test_no_observation_of_an_episode_leaves_the_space(keywords):
    """Of one that has latched before the deadline, which then passes within the window after the latching."""
    env = make("rigid-clearance", deadline=12.4, **keywords)
    observation, info = env.reset(seed=0)
    time_to_deadline = env.observation_names.index("time_to_deadline")
    rates = [env.observation_names.index(name) for name in ("rate_1", "rate_2")]
    seen, over = [observation], False
    while not over:
        left = max(12.4 - info["time_s"], 0.0) / 12.4
        assert env.observation_space.contains(seen[-1])
        assert seen[-1][time_to_deadline] == pytest.approx(left, abs=1e-6)
        observation, _, over, _, info = env.step([0.0])
        seen.append(observation)
    assert env.observation_space.contains(seen[-1])
    assert info["deployment"]["latched"]
    assert info["time_s"] > 20.0
    assert seen[-1][time_to_deadline] == 0.0
    assert np.any(np.abs(np.array(seen)[:, rates]) == 5.0) == ("hardware" in keywords)


def test_returned_arrays_and_dictionaries_belong_to_the_caller():
    env = make()
    first, info = env.reset(seed=0)
    kept, terms = first.copy(), dict(info["reward_terms"])
    second, _, _, _, other = env.step([1.0])
    assert not np.shares_memory(first, second)
    assert np.array_equal(first, kept)
    assert info["reward_terms"] == terms
    assert info["reward_terms"] is not other["reward_terms"]


def test_the_same_seed_gives_the_same_bits_in_two_processes():
    keywords = {"parameters": STRONG, "randomize": RANGES}
    program = (
        "import gymnasium, solar_env, hashlib\n"
        f"env = gymnasium.make({DEPLOY_V1!r}, **{keywords!r}).unwrapped\n"
        "observation, _ = env.reset(seed=7)\n"
        "digest = hashlib.sha256(observation.tobytes())\n"
        "env.action_space.seed(3)\n"
        "for _ in range(60):\n"
        "    observation, reward, *_ = env.step(env.action_space.sample())\n"
        "    digest.update(observation.tobytes() + repr(reward).encode())\n"
        "digest.update(env.simulation.state.q.tobytes())\n"
        "print(env.simulation.state.joints['latched'].sum(), digest.hexdigest())\n"
    )
    runs = [
        subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True) for _ in range(2)
    ]
    assert runs[0].stdout == runs[1].stdout
    assert runs[0].stdout.startswith("2 "), "both joints have latched, and the struggle with the latches is in the bits"


def test_observations_and_rewards_are_the_same_uncompiled(run_python):
    """Up to rounding, which compiled code contracts."""
    keywords = {
        "model": "rigid-clearance",
        "control_period": 1e-3,
        "parameters": {"initial_spin": 0.1, "initial_rate": 0.5},
        "observation": [row.name for row in OBSERVABLES],
        "reward": {**{term.name: 1.0 for term in REWARD_TERMS}, "missed_deadline": 100.0},
        "driven_joint": 1,
    }
    program = (
        "import gymnasium, solar_env\n"
        f"env = gymnasium.make({DEPLOY_RANDOMISED_V1!r}, **{keywords!r})\n"
        "print(*env.reset(seed=7)[0])\n"
        "for action in (0.5, -0.3, 0.1):\n"
        "    observation, reward, _, _, info = env.step([action])\n"
        "    print(*observation, reward, *info['reward_terms'].values())\n"
    )
    compiled, plain = (
        np.array(run_python(program, NUMBA_DISABLE_JIT=disabled).split(), dtype=float) for disabled in ("0", "1")
    )
    assert compiled == pytest.approx(plain, rel=1e-6, abs=1e-12)
    assert np.count_nonzero(compiled) > 40


def test_seeds_fix_the_draws_and_successive_resets_draw_anew():
    env = gymnasium.make(DEPLOY_V1, randomize=RANGES).unwrapped
    draws = []
    for seed in (1, None, 1):
        env.reset(seed=seed)
        draws.append(env.episode_parameters)
    assert draws[0] == draws[2] != draws[1]
    low, high = RANGES["clearance"]
    assert all(low <= value <= high for value in draws[0].clearance)
    assert draws[0].clearance[0] != draws[0].clearance[1], "drawn joint by joint"


def test_reset_options_change_one_episode_only():
    env = gymnasium.make(DEPLOY_V1).unwrapped
    env.reset(options={"parameters": {"clearance": 1e-4}})
    assert env.episode_parameters.clearance == 1e-4
    env.reset()
    assert env.episode_parameters.clearance == 2e-4


def test_wrong_keywords_are_refused_by_name():
    for keywords, words in (
        ({"model": "rigid-idea"}, "rigid-idea.*rigid-ideal.*flexible-clearance"),
        ({"model": "flexible-ideal:0 elements"}, "elements.*0"),
        ({"parameters": {"clearence": 1e-4}}, "clearence.*clearance"),
        ({"randomize": {"clearance": (0.0, 1e-4)}}, "clearance.*positive"),
        ({"torque_limit": -0.5}, "torque_limit.*-0.5"),
        ({"control_period": math.inf}, "control_period.*inf"),
        ({"settling_window": 0.01}, "settling_window.*control_period"),
        ({"render_mode": "ansi"}, "ansi.*human.*rgb_array"),
    ):
        with pytest.raises(ValueError, match=words):
            solar_env.SolarArrayEnv(**keywords)


def test_an_action_that_is_none_is_refused_and_leaves_the_episode_running():
    env = gymnasium.make(DEPLOY_V1).unwrapped
    env.reset(seed=0)
    for action in ([0.0, 0.0], 0.0, [], [math.nan], [-math.inf], 10**400, [10**400]):
        with pytest.raises(ValueError, match=r"shape|finite"):
            env.step(action)
    env.step([0.0])
    assert env.simulation.time == pytest.approx(0.1)


def test_actions_outside_the_box_are_clipped_and_reset_options_checked():
    env = gymnasium.make(DEPLOY_V1).unwrapped
    env.reset(seed=0)
    env.step([40.0])
    assert env.simulation.state.joints["motor_torque"][0] == env.task.torque_limit
    with pytest.raises(ValueError, match="wind"):
        env.reset(options={"wind": 3.0})
    with pytest.raises(ValueError, match="panel_count"):
        env.reset(options={"parameters": {"panel_count": 3}})


def test_stepping_before_reset_or_after_the_end_asks_for_a_reset():
    env = gymnasium.make(DEPLOY_V1, deadline=0.2).unwrapped
    with pytest.raises(gymnasium.error.ResetNeeded):
        env.step([0.0])
    env.reset(seed=0)
    env.step([0.0])
    _, _, terminated, _, _ = env.step([0.0])
    assert terminated
    with pytest.raises(gymnasium.error.ResetNeeded):
        env.step([0.0])
