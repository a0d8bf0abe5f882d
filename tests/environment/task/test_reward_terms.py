"""Every term of the reward charges the growth of its figure, at its price; single and in a vector. Quick uncompiled."""

from __future__ import annotations

import math

import gymnasium
import numpy as np
import pytest

import solar_env
from solar_env.environment.registration import DEPLOY_V1
from solar_env.environment.task.drive import task_numbers
from solar_env.environment.task.reward import REWARD_TERMS, Price, Reward, charge
from solar_env.mechanics.arrays import model as m

PERIODS, LATCHING = 12, 5
# What a missed deadline must cost for every other term to be charged at the same time.
DEAR = {"missed_deadline": 1e6}
ALL = {term.name: 1.0 for term in REWARD_TERMS} | DEAR

each = pytest.mark.parametrize("term", REWARD_TERMS, ids=[term.name for term in REWARD_TERMS])
# The imagined array stays folded.
MOVING = [term for term in REWARD_TERMS if term.name != "opening"]


def motion(lane):
    """States at the ends of some control periods of an imagined deployment that is never finished, by period.

    Peaks and sliding work never fall, the motor's work and the spin go up and down, and one joint latches.
    """
    random = np.random.default_rng(lane)
    work = random.uniform(0.0, 0.05, (PERIODS, 2)).cumsum(axis=0)
    peaks = random.uniform(0.0, 300.0, (PERIODS, 2)).cumsum(axis=0)
    motor = random.normal(0.0, 0.1, PERIODS).cumsum()
    spin = random.normal(0.0, 0.02, PERIODS)
    return work, peaks, motor, spin


def show(state, lane, period):
    """Write the state at the end of a period, the deadline in the last one."""
    work, peaks, motor, spin = motion(lane)
    by_joint = m.joint_integrals(state.integrals)
    by_joint[:, m.SLIDING_WORK], by_joint[0, m.MOTOR_WORK] = work[period], motor[period]
    if period >= LATCHING:
        state.clock["latched_joints"] = 1
        state.joints["lock_sliding_work"] = work[LATCHING]
        state.joints["postlock_peak_force"] = peaks[period] - peaks[LATCHING]
        state.joints["lock_peak_force"] = peaks[LATCHING]
    state.joints["peak_force"] = peaks[period]
    x, y = state.q[2:4] - state.q[:2]
    state.v[2:4] = state.v[:2] + spin[period] * np.array([-y, x])
    state.clock["time"] = times()[period]


def figures(lane):
    """(PERIODS,) the figure of every term, of the same imagined deployment."""
    work, peaks, motor, spin = motion(lane)
    index = np.arange(PERIODS)
    total, after = work.sum(axis=1), index >= LATCHING
    at_latching = total[LATCHING]
    return {
        "peak_impact": np.where(after, (peaks - peaks[LATCHING]).sum(axis=1), 0.0),
        "wear": total,
        "missed_deadline": np.where(index == PERIODS - 1, 2.0, 0.0),  # folded to the end
        "attitude_disturbance": np.maximum.accumulate(np.abs(spin)),
        "postlock_wear": np.where(after, total - at_latching, 0.0),
        "motor_work": np.abs(np.diff(motor, prepend=0.0)).cumsum(),
        "prelatch_peak": peaks[np.minimum(index, LATCHING)].sum(axis=1),
        "time": times(),
        "lateness": np.maximum(times() - 19.9, 0.0),
    }


def times():
    """(PERIODS,) ends of the control periods [s]."""
    return np.array([0.1 * (period + 1) for period in range(PERIODS - 1)] + [20.0])


def charged(reward, lanes=1, **keywords):
    """Infos and rewards of the imagined deployments in some lanes: (lanes, PERIODS) by term, and (lanes, PERIODS)."""
    env = gymnasium.make_vec(DEPLOY_V1, lanes, model="rigid-ideal", reward=reward, **keywords).unwrapped
    env.reset(seed=0)
    task = task_numbers(env.task, env.hardware, env.parameters[0])
    count = len(env.reward.names)
    terms, rewards = np.zeros((lanes, PERIODS, count)), np.zeros((lanes, PERIODS))
    for lane, simulation in enumerate(env.episodes.batch.simulations):
        account = np.zeros((count, 2))
        for period in range(PERIODS):
            show(simulation.state, lane, period)
            charge_for = simulation.model, simulation.state, task, env.reward.rows, account, terms[lane, period]
            rewards[lane, period] = charge(*charge_for)
    return dict(zip(env.reward.names, np.moveaxis(terms, 2, 0), strict=True)), rewards


@pytest.mark.parametrize("term", MOVING, ids=[term.name for term in MOVING])
@pytest.mark.parametrize(
    "price",
    [Price(1.0, 1.0, 1e4), Price(0.03, 2.5, 4.0), Price(0.03, 2.5, 40.0, "decades")],
    ids=["as it is", "bounded", "in decades"],
)
def test_a_term_adds_up_to_minus_what_its_figure_costs_in_every_period(term, price):
    terms, _ = charged(
        {**DEAR, term.name: price} if term.name != "missed_deadline" else {term.name: Price(1.0, 1e6, 2.0)}
    )
    price = Price(1.0, 1e6, 2.0) if term.name == "missed_deadline" else price
    expected = np.minimum(figures(0)[term.name] / price.scale, price.bound)
    expected = price.weight * (np.log10(1.0 + expected) if price.form == "decades" else expected)
    assert -terms[term.name][0].cumsum() == pytest.approx(expected, rel=1e-9, abs=1e-9)
    assert expected[-1] > 0.0
    assert np.all(terms[term.name] <= 0.0)


@each
def test_a_term_is_the_same_in_every_lane_of_a_vector_and_the_reward_is_the_sum_of_all(term):
    together, rewards = charged(ALL, lanes=3)
    assert tuple(together) == tuple(row.name for row in REWARD_TERMS)
    alone, _ = charged({**DEAR, term.name: ALL[term.name]})
    assert together[term.name][0].tobytes() == alone[term.name][0].tobytes()
    of_time = ("missed_deadline", "time", "lateness", "opening")
    assert not np.array_equal(together[term.name][1], together[term.name][2]) or term.name in of_time
    assert rewards == pytest.approx(np.sum(list(together.values()), axis=0), rel=1e-12)


@each
def test_a_term_of_weight_zero_is_left_out_and_changes_nothing(term):
    if term.name == "missed_deadline":
        with pytest.raises(ValueError, match="missed_deadline costs 0"):
            Reward({term.name: 0.0})
        return
    others = {name: weight for name, weight in ALL.items() if name != term.name}
    # Named nowhere, the three that are charged by default are; with a weight of zero they are not.
    without, rewards = charged({**others, term.name: 0.0})
    full, _ = charged(ALL)
    assert tuple(without) == tuple(others)
    for name, values in without.items():
        assert values.tobytes() == full[name].tobytes()
    assert rewards == pytest.approx(np.sum(list(without.values()), axis=0), rel=1e-12)


@each
def test_the_documentation_lists_the_term_with_its_price(term):
    begins = f"| `{term.name}` | {term.figure} | {term.phase} |"
    (line,) = [line for line in solar_env.SolarArrayEnv.__doc__.splitlines() if line.strip().startswith(begins)]
    price = Reward().prices[term.name]
    assert f"| {price.scale:g} {term.unit} | {price.weight:g} | {price.bound:g} | {price.form} |" in line


@each
def test_what_a_missed_deadline_costs_must_exceed_what_all_else_can_together(term):
    """Whatever the weights and bounds: the bound of all others is the sum of weight times bound.

    Of time a missed deadline costs as much as any deployment.
    """
    if term.name in ("missed_deadline", "time", "lateness", "opening"):
        return
    edge = {**dict.fromkeys(ALL, 0.0), term.name: {"weight": 2.0, "bound": 7.0, "form": "linear"}}
    with pytest.raises(ValueError, match=r"missed_deadline costs 14\.0, which must exceed the 14\.0 .*not deploying"):
        Reward({**edge, "missed_deadline": 14.0})
    assert Reward({**edge, "missed_deadline": 14.1}).names.count(term.name) == 1


def test_a_reward_that_is_none_is_refused_by_name():
    for reward, words in (
        ({"peak_impacts": 1.0}, "peak_impacts.*peak_impact"),
        ({"wear": -1.0}, "wear.*weight.*-1.0.*not negative"),
        ({"wear": math.nan}, "wear.*weight.*nan"),
        ({"wear": True}, "wear.*weight.*True"),
        ({"wear": {"scale": 0.0}}, "wear.*scale.*0.0.*positive"),
        ({"wear": {"bound": math.inf}}, "wear.*bound.*inf"),
        ({"wear": {"price": 1.0}}, "wear.*price.*scale"),
        ({"wear": {"form": "octaves"}}, "wear.*octaves.*decades"),
        ({"motor_work": 1.0}, "missed_deadline costs 12.0.*22.0.*raise its weight"),
        (["wear"], "wear.*mapping"),
    ):
        with pytest.raises(ValueError, match=words):
            solar_env.SolarArrayEnv(reward=reward)
    env = solar_env.SolarArrayEnv(reward=lambda before, after: after["wears"])
    env.reset(seed=0)
    with pytest.raises(KeyError, match=r"quantity 'wears' is unknown; did you mean 'wear'"):
        env.step(env.action_space.sample())
