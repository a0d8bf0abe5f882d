"""A control period with many samples of the drive is one compiled call, and the same as sample by sample."""

from __future__ import annotations

import numpy as np
import pytest
from episodes import assert_same, make, make_vector, random_actions
from helpers import fingerprint

from solar_env.mechanics.running.errors import SimulationError

RATED = {"action": "log_rate", "hardware": {"rate_noise": 1e-3, "motor_lag": 0.05}}


def after(actions, **keywords):
    """A simulation after some control periods; without an observed rate only the drive's loop draws noise."""
    env = make("rigid-clearance", observation=["theta"], **RATED, **keywords)
    env.reset(seed=3)
    for action in actions:
        env.step([action])
    return env.simulation


def test_a_period_of_fifty_samples_is_fifty_periods_of_one_sample():
    actions = [0.8, -0.3]
    one = after(actions, control_period=0.5)
    other = after(np.repeat(actions, 50), control_period=0.01)
    assert one.state.joints["contact_starts"].sum() > 0
    for simulation in (one, other):
        simulation.state.joints["recent_peak_force"] = 0.0  # of the last period
    assert (one.time, fingerprint(one.state)) == (1.0, fingerprint(other.state))


def test_how_often_a_call_comes_back_changes_no_bit(monkeypatch):
    seen = []
    for steps in (7, 5000):
        for name in ("STEPS_PER_CALL", "_FEWEST_STEPS_PER_CALL"):
            monkeypatch.setattr(f"solar_env.mechanics.running.batch.{name}", steps)
        env = make_vector(3, model="rigid-ideal", **RATED)
        env.reset(seed=3)
        seen.append([env.step(actions) for actions in random_actions(4, 3)])
    assert_same(*seen)


@pytest.mark.parametrize("action", ["torque", "log_rate"])
def test_the_bound_on_steps_is_one_of_the_control_period(action):
    env = make("rigid-ideal", action=action)
    env.reset(seed=0)
    env.step([0.5])
    clock = env.simulation.state.clock
    taken = int(clock["steps"][0] + clock["rejected_steps"][0])
    for bound in (taken, taken - 1):
        env = make("rigid-ideal", action=action, max_steps=bound)
        env.reset(seed=0)
        if bound == taken:
            env.step([0.5])
        else:
            with pytest.raises(SimulationError, match=f"{bound} steps were taken in one call"):
                env.step([0.5])


def test_a_lane_that_fails_between_samples_leaves_the_others_and_begins_anew():
    env, whole = (make_vector(3, model="rigid-ideal", autoreset_mode="Disabled", **RATED) for _ in range(2))
    for each in (env, whole):
        each.reset(seed=3)
    env.unwrapped.episodes.batch.simulations[1].state.v[:] = np.nan
    one, other = (each.step(np.full((3, 1), 0.6)) for each in (env, whole))
    assert one[3].tolist() == [False, True, False]
    for lane in (0, 2):
        assert_same([values[lane] for values in one[:3]], [values[lane] for values in other[:3]])
    assert one[1][1] == 0.0
    env.reset(options={"reset_mask": one[3]})
    assert not env.step(np.full((3, 1), 0.6))[3].any()


@pytest.mark.parametrize(("period", "deadline"), [(0.7, 2.1), (0.3, 0.9), (0.1, 2.1)])
def test_periods_that_fill_the_deadline_but_for_rounding_end_with_it(period, deadline):
    env = make("rigid-ideal", control_period=period, deadline=deadline, settling_window=period)
    env.reset(seed=0)
    ends = [env.step([0.0])[2] for _ in range(round(deadline / period))]
    assert ends == [False] * (len(ends) - 1) + [True]
    assert env.simulation.time == deadline
