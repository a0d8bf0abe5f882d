"""Torque laws do what they say, and have the parameters that were tuned for the environment they are used in."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from agents.environments import make_env, with_sampling
from agents.laws.baselines import load_parameters, make_baseline
from agents.laws.feedback import (
    DamperParameters,
    ProportionalDerivative,
    ProportionalDerivativeParameters,
    ViscousDamper,
)
from agents.laws.servo import RESERVE, ServoParameters, SoftStartParameters, SoftStartServo, VelocityProfileServo
from agents.laws.table import LAWS, TUNABLE
from agents.rollout import run_episode
from agents.torque_laws import Signals, weighted_opening
from solar_env.environment.registration import DEPLOY_V1

NAMES = ("theta_1", "theta_2", "rate_1", "rate_2", "latched_1", "latched_2")
NAMES += ("motor_torque", "time_to_deadline", "time_since_latch")
LIMIT = 0.5
SIGNALS = Signals(NAMES, LIMIT)
TIME_LEFT = 0.3 * SIGNALS.deadline  # in the observations of `observe`
SERVO = replace(ServoParameters(), difference_damping=3.0, settling_damping=2.0)
SOFT_START = SoftStartParameters(
    **vars(SERVO), torques=tuple(np.linspace(-0.2, 0.24, 12).tolist()), handover=10.0, blending=4.0
)


def observe(opening=0.0, rate=0.0, latched=0.0):
    """Both joints `opening` of their lock angles open, at `rate` lock angles a second."""
    values = [opening, opening, rate * np.pi / 2, rate * np.pi, latched, latched]
    return np.array([*values, 0.3, 0.3, 0.3], dtype=np.float32)


def law(name, signals=SIGNALS):
    """The law of a row, with parameters from anywhere in their ranges."""
    cls = LAWS[name]
    if name not in TUNABLE:
        return cls(signals)
    return cls(signals, cls.defaults.from_unit(np.random.default_rng(1).random(len(cls.defaults.bounds()))))


@pytest.mark.parametrize("opening", [0.0, 0.5, 0.99, 1.0])
def test_servo_torque_is_zero_on_the_profile_drives_below_it_and_brakes_above_it(opening):
    servo = VelocityProfileServo(SIGNALS, SERVO)
    reference = servo.reference_rate(opening, TIME_LEFT)
    assert servo.predict(observe(opening, reference))[0] == pytest.approx(0.0, abs=1e-5)
    assert servo.predict(observe(opening, reference - 0.01))[0] > 0.0
    assert servo.predict(observe(opening, reference + 0.01))[0] < 0.0


def test_servo_damps_the_rate_difference_of_the_joints():
    observation = observe(0.5, VelocityProfileServo(SIGNALS, SERVO).reference_rate(0.5, TIME_LEFT))
    # The weighted opening rate keeps to the profile: joint 1 is 0.01 / s faster, joint 2 as much slower.
    observation[2] += 0.01 * np.pi / 2
    observation[3] -= 0.01 * np.pi
    servo = VelocityProfileServo(SIGNALS, replace(SERVO, joint_2_weight=0.5))
    expected = -SERVO.difference_damping * 0.02 / LIMIT
    assert servo.predict(observation)[0] == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize(("start", "left"), [(0.0, SIGNALS.deadline), (0.3, 2.0), (0.95, 1.0)])
def test_a_servo_that_follows_its_profile_is_done_ahead_of_the_deadline_however_late_it_is(start, left):
    servo = VelocityProfileServo(SIGNALS, SERVO)
    follow = solve_ivp(lambda t, s: servo.reference_rate(s, left - t), (0.0, left - RESERVE), [start], max_step=0.01)
    assert follow.y[0, -1] > 0.98
    assert np.all(servo.reference_rate(follow.y[0], left - follow.t) >= servo.reference_rate(follow.y[0]))


def at_time(time, opening=0.0, rate=0.0, latched=0.0):
    """As `observe`, but at a time [s]."""
    observation = observe(opening, rate, latched)
    observation[NAMES.index("time_to_deadline")] = 1.0 - time / SIGNALS.deadline
    return observation


@pytest.mark.parametrize(("opening", "rate"), [(0.0, 0.0), (0.6, 0.3)])
def test_a_soft_start_knows_nothing_but_the_clock_until_it_hands_over(opening, rate):
    law = SoftStartServo(SIGNALS, SOFT_START)
    times = np.array([0.0, 1.0, 4.0 / 3.0, 6.0, 9.99])
    torques = LIMIT * np.concatenate([law.predict(at_time(time, opening, rate))[0] for time in times])
    # From -0.2 N m on, 0.04 N m more every 4/3 s.
    assert torques == pytest.approx(-0.2 + 0.03 * times, abs=1e-6)


def test_a_soft_start_hands_over_to_the_servo_by_and_by():
    law, servo = SoftStartServo(SIGNALS, SOFT_START), VelocityProfileServo(SIGNALS, SERVO)
    half = 0.5 * (servo.predict(at_time(12.0, 0.5, 0.07))[0] * LIMIT - 0.2 + 0.03 * 12.0)
    assert law.predict(at_time(12.0, 0.5, 0.07))[0] * LIMIT == pytest.approx(half, abs=1e-6)
    for servos in (at_time(14.0, 0.9, 0.02), at_time(5.0, 1.0, 0.02, latched=1.0)):  # late, and after the last latch
        assert law.predict(servos)[0] == servo.predict(servos)[0]


@pytest.mark.slow
def test_the_tuned_soft_start_wears_the_bearings_less_than_the_servo_where_panels_have_converged():
    env = make_env(DEPLOY_V1, with_sampling({"model": "flexible-clearance"}))
    runs = {
        name: [run_episode(env, make_baseline(name, env), seed=seed) for seed in range(4)]
        for name in ("servo", "soft-start")
    }
    assert all(episode["latched"] for episode in runs["soft-start"])
    servo, soft = (np.mean([episode["wear_depth_max_m"] for episode in runs[name]]) for name in runs)
    # In 100 episodes by 17 %.
    assert soft < 0.9 * servo


def test_servo_opposes_joint_1_and_holds_it_at_its_lock_angle_after_the_last_latch():
    servo = VelocityProfileServo(SIGNALS, replace(SERVO, settling_stiffness=4.0))
    turning, off_lock = (servo.predict(observe(*state, latched=1.0))[0] for state in ((1.0, 0.02), (1.01, 0.0)))
    assert turning == pytest.approx(-SERVO.settling_damping * 0.02 * np.pi / 2 / LIMIT, rel=1e-5)
    assert off_lock == pytest.approx(-4.0 * 0.01 * np.pi / 2 / LIMIT, rel=1e-4)


def test_a_filtered_servo_keeps_its_share_of_the_motor_torque_before_and_after_the_last_latch():
    plain, filtered = (VelocityProfileServo(SIGNALS, replace(SERVO, smoothing=share)) for share in (0.0, 0.8))
    motor = 0.3  # of the limit, as `observe` has it for all that it does not say
    for observation in (observe(0.9, 0.04), observe(1.01, 0.02, latched=1.0)):
        wanted = 0.8 * motor + 0.2 * plain.predict(observation)[0]
        np.testing.assert_allclose(filtered.predict(observation)[0], wanted, rtol=1e-5)


@pytest.mark.parametrize(("driven", "lock"), [(0, np.pi / 2), (1, np.pi)])
@pytest.mark.parametrize("latched", [0.0, 1.0])
def test_pd_is_a_spring_and_a_damper_to_the_lock_angle_up_to_its_saturation(driven, lock, latched):
    p = ProportionalDerivativeParameters(proportional_gain=0.2, derivative_gain=2.0, saturation=0.25)
    pd = ProportionalDerivative(replace(SIGNALS, driven_joint=driven), p)
    torque = 0.2 * 0.4 * lock - 2.0 * 0.02 * lock
    assert LIMIT * pd.predict(observe(0.6, 0.02, latched))[0] == pytest.approx(torque, rel=1e-5)
    assert LIMIT * pd.predict(observe(1.0, 0.3, latched))[0] == pytest.approx(-0.25, rel=1e-6)
    assert LIMIT * pd.predict(observe(0.0, -0.3, latched))[0] == pytest.approx(0.25, rel=1e-6)


@pytest.mark.parametrize(("weight", "share"), [(0.0, 1.0), (0.25, 0.75), (1.0, 0.0)])
def test_the_joints_share_in_the_opening_by_their_weights(weight, share):
    """Joint 1 is 0.1 of its lock angle further open than joint 2, and 0.2 lock angles a second faster."""
    entries = {"theta_1": 0.6, "theta_2": 0.5, "rate_1": 0.3 * np.pi / 2, "rate_2": 0.1 * np.pi}
    found = weighted_opening({name: np.array([value]) for name, value in entries.items()}, weight, SIGNALS.lock_angles)
    assert np.concatenate(found) == pytest.approx([0.5 + 0.1 * share, 0.1 + 0.2 * share, 0.2], rel=1e-12)


def test_damper_opposes_the_rate_of_joint_1_by_its_coefficient_of_the_phase():
    damper = ViscousDamper(SIGNALS, DamperParameters(damping=0.5, settling_damping=2.0))
    opening, latched = observe(0.5, 0.1), observe(1.0, 0.1, latched=1.0)
    assert damper.predict(opening)[0] == pytest.approx(-0.5 * 0.1 * np.pi / 2 / LIMIT, rel=1e-5)
    assert damper.predict(latched)[0] == pytest.approx(-2.0 * 0.1 * np.pi / 2 / LIMIT, rel=1e-5)


@pytest.mark.parametrize("name", TUNABLE)
def test_parameters_lie_in_the_ranges_that_tuning_searches_and_no_gain_is_negative(name):
    defaults = TUNABLE[name].defaults
    for parameters in (defaults, load_parameters(name, DEPLOY_V1, "rigid-clearance")):
        numbers = parameters.to_unit()
        assert np.all((numbers >= 0.0) & (numbers <= 1.0))
    low, high = defaults.bounds().T
    torques = low < 0.0
    # What may be negative is a torque, to either side alike and within the motor's limit.
    np.testing.assert_array_equal(low[torques], -high[torques])
    assert np.all(high[torques] <= LIMIT)


@pytest.mark.parametrize("name", LAWS)
def test_batched_prediction_equals_the_single_ones(name):
    controller = law(name)
    rng = np.random.default_rng(0)
    batch = rng.uniform(-1.0, 1.0, (20, len(NAMES))).astype(np.float32)
    actions, _ = controller.predict(batch)
    assert actions.shape == (20, 1)
    assert actions.dtype == np.float32
    assert np.all(np.abs(actions) <= 1.0)
    np.testing.assert_array_equal(actions, [controller.predict(row)[0] for row in batch])


def entries_read(name):
    """Entries that a law reads where the motor works on joint 1."""
    return {entry.replace("driven", "1") for entry in LAWS[name].reads}


@pytest.mark.parametrize("name", LAWS)
def test_entries_are_found_by_name_not_by_position_and_others_are_not_read(name):
    """With latches open and shut, for laws that hold the latched array otherwise than they deploy it."""
    rng = np.random.default_rng(0)
    batch = rng.uniform(-1.0, 1.0, (20, len(NAMES))).astype(np.float32)
    batch[:10, NAMES.index("latched_1")] = batch[:10, NAMES.index("latched_2")] = 1.0
    straight = law(name).predict(batch)[0]
    np.testing.assert_array_equal(law(name, Signals(NAMES[::-1], LIMIT)).predict(batch[:, ::-1])[0], straight)
    read = [k for k, entry in enumerate(NAMES) if entry in entries_read(name) or entry.startswith("latched")]
    others = rng.uniform(-1.0, 1.0, batch.shape).astype(np.float32)
    others[:, read] = batch[:, read]
    np.testing.assert_array_equal(law(name).predict(others)[0], straight)


@pytest.mark.parametrize("name", LAWS)
def test_a_law_is_refused_where_an_entry_that_it_reads_is_not_observed(name):
    for entry in entries_read(name):
        with pytest.raises(ValueError, match=f"reads {entry}, but the observation has only"):
            law(name, Signals(tuple(other for other in NAMES if other != entry), LIMIT))
