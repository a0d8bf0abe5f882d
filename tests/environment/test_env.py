"""The environment keeps Gymnasium's and Stable-Baselines3's contracts, and its reward means what it says."""

from __future__ import annotations

import math
import subprocess
import sys
import warnings

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env as check_by_gymnasium
from stable_baselines3.common.env_checker import check_env as check_by_stable_baselines3

import solar_env
from solar_env.array import MODELS, PanelModel
from solar_env.environment.registration import ENVIRONMENTS
from solar_env.environment.task.observations import OBSERVABLES
from solar_env.environment.task.reward import REWARD_TERMS
from solar_env.mechanics.arrays.model import SLIDING_WORK, joint_integrals
from solar_env.mechanics.joints.joint import MOTOR_TORQUE, NORMAL

ID = "solar_env/Deploy-v0"
RANGES = {"clearance": (1e-4, 3e-4), "friction_coefficient": (0.05, 0.3)}
# Few elements and modes, which is quick.
LEVELS = {model: {"model": model, "elements": 2} for model in MODELS}
LEVELS |= {f"{model}-modal": {"model": model, "modes": 4} for model in MODELS if model.startswith("flexible")}
# Springs that deploy the array within three seconds.
STRONG = {"spring_stiffness": 2.0}
# The root latches nine seconds after the outer joint.
LATE_ROOT = {"cable_stiffness": 0.02}


def make(model="rigid-clearance", **keywords):
    return gymnasium.make(ID, **LEVELS[model], **keywords).unwrapped


def deploy(env, policy=lambda observation: [0.0], seed=0, options=None):
    """Run one episode; returns its return, steps and the last info."""
    observation, _ = env.reset(seed=seed, options=options)
    total, steps = 0.0, 0
    while True:
        observation, reward, terminated, truncated, info = env.step(policy(observation))
        total, steps = total + reward, steps + 1
        if terminated or truncated:
            return total, steps, info


def main_body_spin(state):
    """Angular velocity of the line through the main body's base points, or of its frame [rad/s]."""
    if hasattr(state, "loads"):
        return state.v[2]
    (x, y), (u, v) = state.q[2:4] - state.q[:2], state.v[2:4] - state.v[:2]
    return (x * v - y * u) / (x * x + y * y)


@pytest.fixture(scope="module", params=LEVELS)
def passive(request):
    """The model, and what `deploy` returns of its passive deployment."""
    return request.param, deploy(make(request.param))


@pytest.mark.parametrize("name", ENVIRONMENTS)
@pytest.mark.parametrize(
    "keywords",
    [
        {},
        {"observation": "privileged"},
        {"randomize": RANGES},
        {"parameters": {"panel_count": 3}},
    ],
    ids=["default", "privileged", "randomized", "three panels"],
)
@pytest.mark.parametrize("model", LEVELS)
def test_both_checkers_accept_every_id_without_a_warning(name, model, keywords):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        env = gymnasium.make(name, **LEVELS[model], render_mode="rgb_array", **keywords).unwrapped
        check_by_gymnasium(env)
        check_by_stable_baselines3(env)


@pytest.mark.parametrize("model", LEVELS)
def test_reward_terms_sum_to_the_reward_and_each_adds_up_to_its_figure_over_a_deployment(model):
    env = make(model, reward={"attitude_disturbance": 1.0, "prelatch_wear": 2.0, "missed_deadline": 100.0})
    env.reset(seed=0)
    sums, spin, terminated = dict.fromkeys(env.reward.names, 0.0), 0.0, False
    while not terminated:
        _, reward, terminated, _, info = env.step([0.2])
        assert math.isclose(reward, math.fsum(info["reward_terms"].values()), abs_tol=1e-12)
        for name, value in info["reward_terms"].items():
            sums[name] += value
        spin = max(spin, abs(main_body_spin(env.simulation.state)))
    figures = info["deployment"]
    after = sum(figures["postlock_sliding_work_J"])
    before = joint_integrals(env.simulation.state.integrals)[:, SLIDING_WORK].sum() - after
    assert sums["peak_impact"] == pytest.approx(-sum(figures["peak_postlock_force_N"]) / 500.0, rel=1e-9)
    assert sums["wear"] == pytest.approx(-after / 0.05, rel=1e-9)
    assert sums["prelatch_wear"] == pytest.approx(-2.0 * before / 0.05, rel=1e-9)
    assert sums["attitude_disturbance"] == pytest.approx(-spin / 0.01, rel=1e-9)
    assert sums["missed_deadline"] == 0.0


def test_an_episode_ends_exactly_one_window_after_the_last_latching(passive):
    _, (_, steps, info) = passive
    figures = info["deployment"]
    assert figures["latched"]
    assert figures["duration_s"] == pytest.approx(max(figures["latch_times_s"]) + 10.0, abs=1e-9)
    assert steps == math.ceil(figures["duration_s"] / 0.1 - 1e-9)


def test_the_energy_residual_of_an_episode_is_that_of_its_simulation():
    env = make("rigid-clearance", parameters=STRONG, postlock_window=0.5)
    _, _, info = deploy(env)
    assert info["deployment"]["energy_residual_J"] == env.simulation.energy_residual()
    env.reset(seed=0)
    stored = env.simulation.state.clock["initial_energy"]
    falsified = 0.001 * stored[0]  # within the share that nobody is warned of
    stored += falsified
    over = False
    while not over:
        *_, over, _, info = env.step([0.0])
    assert info["deployment"]["energy_residual_J"] == env.simulation.energy_residual()
    assert info["deployment"]["energy_residual_J"] == pytest.approx(-falsified, rel=0.1)


def test_nothing_counts_as_after_the_latching_where_none_has_latched():
    env = make("rigid-clearance", deadline=0.55)
    _, _, info = deploy(env, lambda observation: [1.0])
    assert min(info["deployment"]["contact_starts"]) > 0
    for name in ("peak_postlock_force_N", "postlock_impulse_Ns", "postlock_sliding_work_J"):
        assert info["deployment"][name] == [0.0, 0.0], name


def test_a_missed_deadline_terminates_and_costs_more_than_the_worst_deployment():
    env = gymnasium.make(ID).unwrapped
    total, steps, info = deploy(env, lambda observation: [-1.0])
    assert not info["deployment"]["latched"]
    assert steps == 200
    assert total == -25.0
    # Driving at full torque throughout, after latching too, is about the worst that a deployment can be.
    hard, _, _ = deploy(env, lambda observation: [1.0 if observation[2] >= 0.0 else -1.0])
    assert total < -env.reward.largest_cost < hard < 0.0


@pytest.mark.parametrize("model", LEVELS)
def test_a_deadline_ends_the_episode_of_every_model(model):
    env = make(model, deadline=0.55)
    total, steps, info = deploy(env, lambda observation: [-1.0])
    assert (total, steps) == (-25.0, 6)
    assert info["deployment"]["latch_times_s"] == [None, None]
    assert info["deployment"]["duration_s"] == pytest.approx(0.55, abs=1e-12)


def test_the_charges_are_bounded_whatever_the_forces():
    env = gymnasium.make(ID).unwrapped
    env.reset(seed=0)
    env.simulation.state.clock["latched_joints"] = 1
    env.simulation.state.joints["postlock_peak_force"] = 1e9
    _, reward, _, _, info = env.step([0.0])
    assert info["reward_terms"]["peak_impact"] == -12.0
    assert reward >= -env.reward.largest_cost


def test_braking_before_the_latch_is_rewarded(passive):
    model, (alone, _, _) = passive
    # Ten decisions a second cannot damp what bends in flexible panels: a stiff control only shakes them.
    gain, damping = (10.0, 0.0) if model.startswith("flexible") else (20.0, 20.0)

    def brake(observation):
        """Follow a rate that falls to zero towards the lock, then damp."""
        theta_1, rate_1, rate_2, latched = observation[0], observation[2], observation[3], observation[4] > 0.0
        wanted = min(0.2, max(0.005, 0.15 * (1.0 - theta_1)))
        torque = -damping * rate_1 if latched else gain * (wanted - 0.5 * (rate_1 + rate_2 / 2.0))
        return [float(np.clip(torque, -1.0, 1.0))]

    total, _, info = deploy(make(model), brake)
    assert info["deployment"]["latched"]
    # Of the forces that panels without a mesh have, as those with twelve elements, it takes off a third at best.
    assert total > (0.8 if model == "flexible-ideal-modal" else 0.5) * alone


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
        assert eccentricity == pytest.approx(loads[joint, :2] / clearance, rel=1e-6)
        assert entries[f"in_contact_{joint + 1}"] == state.joints["in_contact"][joint]
    assert entries["main_body_spin"] == pytest.approx(main_body_spin(state), rel=1e-6)
    assert entries["main_body_spin"] < 0.0


def test_the_bounds_of_an_observation_are_those_of_the_documented_table():
    drive = [(-2, 2)] * 2 + [(-5, 5)] * 2 + [(0, 1)] * 2 + [(-1, 1), (0, 1), (0, 1)]
    remembered = [(-2, 2)] * 2 + [(-5, 5)] * 2 + [(-1, 1)]
    journal = [(-2, 2), (-2, 2), (0, 1)]
    for observation, bounds in (
        ("drive", drive),
        ("history", drive + 3 * remembered),
        ("privileged", drive + 2 * journal + [(-1, 1)]),
    ):
        space = gymnasium.make(ID, observation=observation).observation_space
        assert space.dtype == np.float32
        assert list(zip(space.low.tolist(), space.high.tolist(), strict=True)) == bounds, observation


@pytest.mark.parametrize(
    "keywords",
    [{"observation": "privileged"}, {"observation": "history", "hardware": {"rate_noise": 5.0}}],
    ids=["past the deadline", "noise beyond the bounds"],
)
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


def test_the_time_since_latching_counts_from_the_last_one_in_units_of_the_window():
    env = make("rigid-clearance", parameters=LATE_ROOT)
    env.reset(seed=0)
    index, counts, over = env.observation_names.index("time_since_latch"), [], False
    while not over:
        observation, _, over, _, info = env.step([0.0])
        joints = env.simulation.state.joints
        latched = int(joints["latched"].sum())
        since = info["time_s"] - max(joints["latch_time"]) if latched == 2 else 0.0
        assert observation[index] == np.float32(since / 10.0)
        counts.append(latched)
    assert np.bincount(counts).min() > 20, "before, between and after the latchings"
    assert observation[index] == 1.0


@pytest.mark.parametrize("model", LEVELS)
def test_returned_arrays_and_dictionaries_belong_to_the_caller(model):
    env = make(model)
    first, info = env.reset(seed=0)
    kept, terms = first.copy(), dict(info["reward_terms"])
    second, _, _, _, other = env.step([1.0])
    assert not np.shares_memory(first, second)
    assert np.array_equal(first, kept)
    assert info["reward_terms"] == terms
    assert info["reward_terms"] is not other["reward_terms"]


@pytest.mark.parametrize("model", LEVELS)
def test_the_same_seed_gives_the_same_bits_in_two_processes(model):
    keywords = {**LEVELS[model], "parameters": STRONG, "randomize": RANGES}
    program = (
        "import gymnasium, solar_env, hashlib\n"
        f"env = gymnasium.make({ID!r}, **{keywords!r}).unwrapped\n"
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
        f"env = gymnasium.make('solar_env/DeployRandomised-v0', **{keywords!r})\n"
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
    env = gymnasium.make(ID, randomize=RANGES).unwrapped
    draws = []
    for seed in (1, None, 1):
        env.reset(seed=seed)
        draws.append(env.episode_parameters)
    assert draws[0] == draws[2] != draws[1]
    low, high = RANGES["clearance"]
    assert all(low <= value <= high for value in draws[0].clearance)
    assert draws[0].clearance[0] != draws[0].clearance[1], "drawn joint by joint"


def test_reset_options_change_one_episode_only():
    env = gymnasium.make(ID).unwrapped
    env.reset(options={"parameters": {"clearance": 1e-4}})
    assert env.episode_parameters.clearance == 1e-4
    env.reset()
    assert env.episode_parameters.clearance == 2e-4


@pytest.mark.parametrize("model", LEVELS)
def test_a_restored_state_replays_the_same_step(model):
    env = make(model, parameters=STRONG)
    env.reset(seed=0)
    while not env.simulation.state.joints["latched"].all():
        env.step([0.0])
    before = env.simulation.snapshot()
    first, *_ = env.step([0.3])
    env.simulation.restore(before)
    second, *_ = env.step([0.3])
    assert np.array_equal(first, second)


@pytest.mark.parametrize(
    ("keywords", "words"),
    [
        ({"model": "rigid-idea"}, ["rigid-idea", "rigid-ideal", "flexible-clearance"]),
        ({"elements": 0}, ["elements", "0"]),
        ({"model": "flexible-ideal", "elements": -1}, ["elements", "-1"]),
        ({"model": "flexible-ideal", "elements": 1001}, ["elements", "1001", "1000"]),
        ({"model": "flexible-clearance", "elements": 2.5}, ["elements", "2.5", "whole number"]),
        ({"model": "flexible-clearance", "elements": "6"}, ["elements", "'6'", "whole number"]),
        ({"elements": True}, ["elements", "True", "whole number"]),
        ({"parameters": {"panel_young": 0.0}}, ["panel_young", "0.0"]),
        ({"parameters": {"clearence": 1e-4}}, ["clearence", "clearance"]),
        ({"parameters": {"body_mass": -1.0}}, ["body_mass", "-1"]),
        ({"parameters": {"clearance": math.nan}}, ["clearance", "nan"]),
        ({"randomize": {"clearance": (0.0, 1e-4)}}, ["clearance", "positive"]),
        ({"randomize": {"clearance": (2e-4, 1e-4)}}, ["clearance", "low <= high"]),
        ({"randomize": {"clearance": 1e-4}}, ["clearance", "pair"]),
        ({"randomize": {"colour": (0.0, 1.0)}}, ["colour"]),
        ({"observation": "all"}, ["all", "privileged"]),
        ({"torque_limit": -0.5}, ["torque_limit", "-0.5"]),
        ({"control_period": math.inf}, ["control_period", "inf"]),
        ({"postlock_window": 0.01}, ["postlock_window", "control_period"]),
        ({"render_mode": "human"}, ["human", "rgb_array"]),
    ],
)
def test_wrong_keywords_are_refused_by_name(keywords, words):
    with pytest.raises(ValueError, match="(?s)" + ".*".join(words)):
        solar_env.SolarArrayEnv(**keywords)


@pytest.mark.parametrize("model", ["rigid-ideal", "rigid-clearance", "flexible-clearance"])
def test_latches_without_play_hold_a_folded_array_that_the_motor_pushes_shut(model):
    env = make(model, parameters={"latch_gap": 0.0})
    env.reset(seed=0)
    for _ in range(5):
        observation, *_ = env.step([-1.0])
    # It bounces on a stop of 1000 N m/rad under the motor's 0.5 N m less the spring's 0.16 N m.
    assert abs(observation[0] * math.pi / 2) < 1e-3


def test_frames_are_played_at_the_pace_of_the_control_periods():
    assert solar_env.SolarArrayEnv(control_period=0.02).metadata["render_fps"] == 50.0
    assert gymnasium.make_vec(ID, num_envs=1, control_period=0.02).metadata["render_fps"] == 50.0
    assert solar_env.SolarArrayEnv.metadata["render_fps"] == 10


@pytest.mark.parametrize("action", [[0.0, 0.0], 0.0, [[0.0]], []])
def test_an_action_of_the_wrong_shape_is_refused(action):
    env = gymnasium.make(ID).unwrapped
    env.reset(seed=0)
    with pytest.raises(ValueError, match="shape"):
        env.step(action)


def test_an_action_that_is_not_finite_is_refused_and_leaves_the_episode_running():
    env = gymnasium.make(ID).unwrapped
    env.reset(seed=0)
    with pytest.raises(ValueError, match="finite"):
        env.step([math.nan])
    env.step([0.0])
    assert env.simulation.time == pytest.approx(0.1)


def test_actions_outside_the_box_are_clipped():
    env = gymnasium.make(ID).unwrapped
    env.reset(seed=0)
    env.step([40.0])
    assert env.simulation.state.joints["motor_torque"][0] == env.task.torque_limit


def test_stepping_before_reset_or_after_the_end_asks_for_a_reset():
    env = gymnasium.make(ID, deadline=0.2).unwrapped
    with pytest.raises(gymnasium.error.ResetNeeded):
        env.step([0.0])
    env.reset(seed=0)
    env.step([0.0])
    _, _, terminated, _, _ = env.step([0.0])
    assert terminated
    with pytest.raises(gymnasium.error.ResetNeeded):
        env.step([0.0])


def test_unknown_reset_options_and_another_panel_count_are_refused():
    env = gymnasium.make(ID).unwrapped
    with pytest.raises(ValueError, match="wind"):
        env.reset(options={"wind": 3.0})
    with pytest.raises(ValueError, match="panel_count"):
        env.reset(options={"parameters": {"panel_count": 3}})


def test_elements_is_a_keyword_only_and_divides_the_panels():
    with pytest.raises(TypeError):
        solar_env.SolarArrayEnv("flexible-ideal", None, 3)
    env = gymnasium.make(ID, model="flexible-ideal", elements=3).unwrapped
    env.reset(seed=0)
    assert env.simulation.model.bodies["elements"].tolist() == [0, 3, 3]
    assert solar_env.SolarArrayEnv().panels == PanelModel("ancf", 6)


@pytest.mark.parametrize("model", ["flexible-ideal", "flexible-clearance"])
def test_a_frame_shows_bent_panels_as_smooth_curves(model, monkeypatch):
    env = make(model, render_mode="rgb_array")
    env.reset(seed=0)
    straight = env.render()
    nodes = env.simulation.state.q[4:].reshape(2, 3, 2, 2)
    nodes[:, 1, 0, 0] += 0.1  # the middles of the folded panels go aside, their ends stay
    assert np.any(straight != env.render())
    scenes = []
    monkeypatch.setattr("solar_env.environment.film.Renderer.draw", lambda self, scene: scenes.append(scene))
    env.render()
    for panel, own in zip(scenes[0].panels, nodes, strict=True):
        assert np.array_equal(panel[[0, len(panel) // 2, -1]], own[:, 0])
        # No corner turns as far as that of a polyline through the nodes alone.
        turns = np.diff(np.unwrap(np.arctan2(*np.diff(panel, axis=0).T[::-1])))
        assert np.abs(turns).max() < 0.5 * 2.0 * math.atan(0.1 / 0.75)


def test_a_frame_is_drawn_from_the_state_the_loads_and_the_recorded_peaks(monkeypatch):
    """Through impacts and rests, with no joint latched, then the outer one, then both."""
    scenes, peaks, times, met = [], [np.zeros(2)], [0.0], set()
    monkeypatch.setattr("solar_env.environment.film.Renderer.draw", lambda self, scene: scenes.append(scene))
    parameters = {**LATE_ROOT, "clearance": (1e-4, 3e-4), "journal_radius": 0.02}
    env = make("rigid-clearance", parameters=parameters, render_mode="rgb_array")
    env.reset(seed=0)
    step, over = 0, False
    while not over:
        *_, over, _, info = env.step([0.4 * math.sin(0.3 * step)])
        env.render()
        scene, simulation, step = scenes[-1], env.simulation, step + 1
        joints, loads = simulation.state.joints, simulation.joint_loads()
        base, hinge, start_1, tip_1, start_2, tip_2 = simulation.state.q.reshape(6, 2)
        peaks.append(joints["recent_peak_force"].copy())
        times.append(info["time_s"])
        assert scene.time == info["time_s"]
        assert scene.main_body.mean(axis=0) == pytest.approx(base, abs=1e-12)
        assert scene.main_body[1:3].mean(axis=0) == pytest.approx(hinge, abs=1e-12)
        assert np.hypot(*np.diff(scene.main_body, axis=0).T) == pytest.approx([1.0] * 3)
        assert np.array_equal([panel[[0, -1]] for panel in scene.panels], [[start_1, tip_1], [start_2, tip_2]])
        assert scene.hinges == pytest.approx(np.array([hinge, tip_1]), abs=1e-12)
        assert scene.eccentricity == pytest.approx(np.array([start_1 - hinge, start_2 - tip_1]), abs=1e-12)
        assert scene.clearance.tolist() == [1e-4, 3e-4]
        assert scene.journal_radius.tolist() == [0.02, 0.02]
        assert scene.in_contact.tolist() == joints["in_contact"].astype(bool).tolist()
        assert np.all((scene.normal_force > 0.0) <= scene.in_contact)
        assert scene.normal_force.tolist() == loads[:, NORMAL].tolist()
        assert scene.latched.tolist() == [bool(time <= scene.time) for time in joints["latch_time"]]
        assert scene.motor_torque == loads[0, MOTOR_TORQUE]
        assert np.array_equal(scene.force_times, times)
        assert np.array_equal(scene.force_history, peaks)
        met.add((tuple(scene.latched), bool(scene.in_contact[0])))
    assert met == {
        (latched, touching) for latched in ((False, False), (False, True), (True, True)) for touching in (False, True)
    }
    assert min(scene.motor_torque for scene in scenes) < 0.0 < max(scene.motor_torque for scene in scenes)
    assert np.max(peaks) > 10.0


def test_without_a_render_mode_there_is_no_frame_but_a_hint():
    env = make("rigid-clearance")
    env.reset(seed=0)
    with pytest.warns(UserWarning, match='render_mode="rgb_array"'):
        frame = env.render()
    assert frame is None


@pytest.mark.parametrize("model", LEVELS)
def test_a_frame_shows_the_present_state(model):
    env = make(model, render_mode="rgb_array")
    env.reset(seed=0)
    folded = env.render()
    for _ in range(40):
        env.step([0.0])
    assert folded.shape == (540, 960, 3)
    assert folded.dtype == np.uint8
    assert not np.array_equal(folded, env.render())


def test_an_ideal_model_charges_joint_reactions_and_never_wears(passive):
    model, (total, _, info) = passive
    figures = info["deployment"]
    if "clearance" in model:
        assert min(figures["wear_depth_max_m"]) > 0.0 < min(figures["contact_starts"])
        return
    assert min(figures["peak_postlock_force_N"]) > 0.0
    assert figures["wear_depth_max_m"] == [0.0, 0.0]
    assert figures["contact_starts"] == [0, 0]
    assert total == pytest.approx(-sum(figures["peak_postlock_force_N"]) / 500.0)
