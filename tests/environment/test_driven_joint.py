"""The motor sits on the hinge that the task names: torque, work, observation, frames and controllers follow it."""

from __future__ import annotations

import math

import gymnasium
import numpy as np
import pytest

from agents.laws.feedback import DamperParameters, ViscousDamper
from agents.laws.servo import ServoParameters, VelocityProfileServo
from agents.torque_laws import Signals
from solar_env.environment.registration import DEPLOY_V1
from solar_env.environment.task.observations import observation_entries

SHORT = {"model": "rigid-ideal", "control_period": 1e-3}
joints = pytest.mark.parametrize("joint", [0, 1])


def make(joint, **keywords):
    return gymnasium.make(DEPLOY_V1, driven_joint=joint, **{**SHORT, **keywords}).unwrapped


@joints
def test_torque_and_work_are_those_of_the_driven_joint_alone(joint):
    env = make(joint, parameters={"initial_rate": 0.5}, observation=["theta", "motor_torque"])
    first, _ = env.reset(seed=0)
    for _ in range(5):
        last, *_ = env.step([0.8])
    expected = [0.0, 0.0]
    expected[joint] = 0.4
    assert env.simulation.state.joints["motor_torque"].tolist() == pytest.approx(expected)
    assert last[2] == pytest.approx(0.8)
    turned = (last - first)[joint] * (math.pi / 2, math.pi)[joint]
    work = env._episodes.figures(0)["motor_work_J"]
    assert work == pytest.approx(0.4 * turned, rel=1e-3)
    assert work > 1e-4


def test_the_frame_names_the_torque_of_the_driven_joint(monkeypatch):
    scenes = []
    monkeypatch.setattr("solar_env.environment.showing.film.Renderer.draw", lambda self, scene: scenes.append(scene))
    env = make(1, render_mode="rgb_array")
    env.reset(seed=0)
    env.step([-0.6])
    env.render()
    assert scenes[-1].motor_torques == (pytest.approx(-0.3),)


@joints
def test_futures_drive_the_same_joint(joint):
    env = make(joint, deadline=0.004)
    env.reset(seed=0)
    futures = env.futures(2)
    futures.step(np.arange(2), np.array([[0.5], [-0.5]]))
    assert futures.batch.states.joints["motor_torque"][:, joint].tolist() == [0.25, -0.25]


@joints
@pytest.mark.parametrize(
    ("law", "parameters"),
    [
        (ViscousDamper, DamperParameters(settling_damping=2.0)),
        (VelocityProfileServo, ServoParameters(settling_damping=2.0)),
    ],
)
def test_a_law_damps_the_joint_that_it_drives_once_the_array_has_latched(law, parameters, joint):
    names = [entry.name for entry in observation_entries(2, "drive")]
    controller = law(Signals(tuple(names), driven_joint=joint), parameters)
    actions = []
    for moving in (joint, 1 - joint):
        latched = np.ones(len(names), dtype=np.float32)
        for k in (0, 1):
            latched[names.index(f"rate_{k + 1}")] = 0.05 if k == moving else 0.0
        actions.append(float(controller.predict(latched)[0][0]))
    assert actions[0] < 0.0
    assert actions[1] == 0.0


def test_a_policy_trained_with_the_motor_on_one_joint_is_refused_on_another():
    signals = Signals.of(make(0))
    signals.check(make(0), "joint 1")
    with pytest.raises(ValueError, match="driven_joint is 1; the policy was trained with 0"):
        signals.check(make(1), "joint 1")
