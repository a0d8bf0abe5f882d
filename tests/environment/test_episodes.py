"""Episodes: when they end, and what they are charged."""

from __future__ import annotations

import math

import numpy as np
import pytest
from deployments import LEVELS
from episodes import LATE_ROOT, STRONG, deploy, main_body_spin, make
from scipy.optimize import brentq

from solar_env.mechanics.arrays.model import SLIDING_WORK, joint_integrals


@pytest.fixture(scope="module", params=LEVELS)
def passive(request):
    """The model, and what `deploy` returns of its passive deployment."""
    return request.param, deploy(make(request.param))


@pytest.mark.parametrize("model", ["rigid-clearance", "flexible-ideal:4 modes"])
def test_reward_terms_sum_to_the_reward_and_each_adds_up_to_its_figure_over_a_deployment(model):
    env = make(model, reward={"attitude_disturbance": 1.0, "postlock_wear": 2.0, "missed_deadline": 100.0})
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
    whole = joint_integrals(env.simulation.state.integrals)[:, SLIDING_WORK].sum()
    assert sum(figures["sliding_work_J"]) == pytest.approx(whole)
    assert sums["peak_impact"] == pytest.approx(-sum(figures["peak_postlock_force_N"]) / 500.0, rel=1e-9)
    assert sums["wear"] == pytest.approx(-whole / 0.1, rel=1e-9)
    assert sums["postlock_wear"] == pytest.approx(-2.0 * after / 0.05, rel=1e-9)
    assert sums["attitude_disturbance"] == pytest.approx(-spin / 0.01, rel=1e-9)
    assert sums["missed_deadline"] == 0.0


def test_an_episode_ends_exactly_one_window_after_the_last_latching(passive):
    _, (_, steps, info) = passive
    figures = info["deployment"]
    assert figures["latched"]
    assert figures["duration_s"] == pytest.approx(max(figures["latch_times_s"]) + 10.0, abs=1e-9)
    assert steps == math.ceil(figures["duration_s"] / 0.1 - 1e-9)


def test_the_energy_residual_of_an_episode_is_that_of_its_simulation():
    env = make("rigid-clearance", parameters=STRONG, settling_window=0.5)
    env.reset(seed=0)
    stored = env.simulation.state.clock["initial_energy"]
    falsified = 0.001 * stored[0]  # within the share that nobody is warned of
    stored += falsified
    over = False
    while not over:
        *_, over, _, info = env.step([0.0])
    assert info["deployment"]["energy_residual_J"] == env.simulation.energy_residual()
    assert info["deployment"]["energy_residual_J"] == pytest.approx(-falsified, rel=0.1)


def test_the_latch_torque_of_a_lone_panel_is_that_at_which_spring_and_undamped_latch_have_taken_its_energy():
    changes = {"panel_count": 1, "body_fixed": True, "spring_preload_angle": 2.5, "latch_damping": 0.0}
    _, _, info = deploy(make("rigid-ideal", parameters=changes, settling_window=0.5))
    met = math.pi / 2 + 0.01
    angle = brentq(lambda x: 0.05 * x * (5.0 - x) - 500.0 * (x - met) ** 2, met, met + 0.1)
    assert info["deployment"]["peak_latch_torque_Nm"] == [pytest.approx(1e3 * (angle - met), rel=1e-3)]


def test_nothing_counts_as_after_the_latching_where_none_has_latched():
    env = make("rigid-clearance", deadline=0.55)
    _, _, info = deploy(env, lambda observation: [1.0])
    assert min(info["deployment"]["contact_starts"]) > 0
    for name in ("peak_postlock_force_N", "postlock_impulse_Ns", "postlock_sliding_work_J"):
        assert info["deployment"][name] == [0.0, 0.0], name
    assert info["deployment"]["peak_prelatch_force_N"] == env.simulation.state.joints["peak_force"].tolist()
    assert min(info["deployment"]["peak_prelatch_force_N"]) > 0.0


@pytest.mark.parametrize("model", LEVELS)
def test_a_deadline_ends_the_episode_of_every_model(model):
    env = make(model, deadline=0.55)
    total, steps, info = deploy(env, lambda observation: [-1.0])
    assert steps == 6
    assert -50.01 < total <= -45.0
    assert info["deployment"]["latch_times_s"] == [None, None]
    assert info["deployment"]["duration_s"] == pytest.approx(0.55, abs=1e-12)


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
    assert total > (0.8 if model == "flexible-ideal:4 modes" else 0.5) * alone


def test_the_peak_before_latching_is_the_greatest_force_up_to_the_first_latching():
    env = make("rigid-clearance", parameters=LATE_ROOT)
    env.reset(seed=0)
    peaks, over = [env.simulation.state.joints["peak_force"].copy()], False
    while not over:
        *_, over, _, info = env.step([0.0])
        joints = env.simulation.state.joints
        if not joints["latched"].any():
            peaks.append(joints["peak_force"].copy())
    figure = np.array(info["deployment"]["peak_prelatch_force_N"])
    assert np.all(peaks[-1] <= figure)
    assert np.all(figure < 1.2 * peaks[-1]), "of the one period in which it latches"
    assert np.all(figure < 0.7 * np.array(info["deployment"]["peak_postlock_force_N"]))
    assert np.all(peaks[-1] > 0.0)


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
