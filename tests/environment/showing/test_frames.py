"""Frames of an environment show its present state."""

from __future__ import annotations

import math

import gymnasium
import numpy as np
import pytest
from deployments import BEAMS
from episodes import LATE_ROOT, make

import solar_env
from solar_env.environment.registration import DEPLOY_V1
from solar_env.mechanics.arrays.columns import MOTOR_TORQUE, NORMAL


def test_frames_are_played_at_the_pace_of_the_control_periods_in_whole_numbers():
    periods = (0.02, 0.1, 0.3, 2.0)
    rates = {
        period: solar_env.SolarArrayEnv(version="v1", control_period=period).metadata["render_fps"]
        for period in periods
    }
    assert rates == {0.02: 50, 0.1: 10, 0.3: 3, 2.0: 1}
    assert gymnasium.make_vec(DEPLOY_V1, num_envs=1, control_period=0.02).metadata["render_fps"] == 50


@pytest.mark.parametrize("model", BEAMS)
def test_a_frame_shows_bent_panels_as_smooth_curves(model, monkeypatch):
    env = make(model, render_mode="rgb_array")
    env.reset(seed=0)
    straight = env.render()
    nodes = env.simulation.state.q[4:].reshape(2, 3, 2, 2)
    nodes[:, 1, 0, 0] += 0.1  # the middles of the folded panels go aside, their ends stay
    assert np.any(straight != env.render())
    scenes = []
    monkeypatch.setattr("solar_env.environment.showing.film.Renderer.draw", lambda self, scene: scenes.append(scene))
    env.render()
    for panel, places in zip(scenes[0].panels, nodes, strict=True):
        np.testing.assert_allclose(panel[[0, len(panel) // 2, -1]], places[:, 0], rtol=0.0, atol=1e-15)
        # No corner turns as far as that of a polyline through the nodes alone.
        turns = np.diff(np.unwrap(np.arctan2(*np.diff(panel, axis=0).T[::-1])))
        assert np.abs(turns).max() < 0.5 * 2.0 * math.atan(0.1 / 0.75)


def test_a_frame_is_drawn_from_the_state_the_loads_and_the_recorded_peaks(monkeypatch):
    """Through impacts and rests, with no joint latched, then the outer one, then both."""
    scenes, peaks, times, met = [], [np.zeros(2)], [0.0], set()
    monkeypatch.setattr("solar_env.environment.showing.film.Renderer.draw", lambda self, scene: scenes.append(scene))
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
        assert scene.in_contact.tolist() == joints["in_contact"].astype(bool).tolist()
        assert np.all((scene.normal_force > 0.0) <= scene.in_contact)
        assert scene.normal_force.tolist() == loads[:, NORMAL].tolist()
        assert scene.latched.tolist() == [bool(time <= scene.time) for time in joints["latch_time"]]
        assert scene.motor_torques == (loads[0, MOTOR_TORQUE],)
        assert np.array_equal(scene.force_times, times)
        assert np.array_equal(scene.force_history, peaks)
        met.add((tuple(scene.latched), bool(scene.in_contact[0])))
    assert met == {
        (latched, touching) for latched in ((False, False), (False, True), (True, True)) for touching in (False, True)
    }
    assert min(scene.motor_torques[0] for scene in scenes) < 0.0 < max(scene.motor_torques[0] for scene in scenes)
    assert np.max(peaks) > 10.0
