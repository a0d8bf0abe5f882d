"""The reward ranks controllers as the physical figures do, and no trick pays."""

from __future__ import annotations

import math

import gymnasium
import numpy as np
import pytest
from charged import (
    FORCE_SCALE,
    LARGEST,
    MISSED,
    SAMPLING,
    SOFT_CABLE,
    TASK,
    WORK_SCALE,
    WORST_DEPLOYMENT,
    all_latched,
    any_latched,
    assert_charged,
    chatter,
    constant,
    deploy,
    erratic,
    held_short_at,
    in_turn,
    mean_total,
    phases,
    physical_record,
    step_of,
    viscous,
)
from scipy.stats import spearmanr

from agents.laws.table import TUNABLE
from agents.torque_laws import Signals
from solar_env.environment.registration import DEPLOY_V1
from solar_env.environment.task.reward import Price
from solar_env.environment.task.task import Task


@pytest.fixture(scope="module")
def wide_set():
    """Controllers from all over: every torque law with parameters anywhere in their ranges, and torques of no law."""
    signals = Signals.of(gymnasium.make(DEPLOY_V1))
    generator = np.random.default_rng(0)
    laws = [constant(action) for action in (-1.0, -0.5, -0.25, 0.0, 0.25, 0.5, 1.0)]
    laws += [erratic(seed) for seed in range(3)]
    laws += [constant(action) for action in generator.uniform(-0.2, 0.0, 8)]  # brakes
    for law in TUNABLE.values():
        parameters = type(law.defaults)
        for _ in range(8):
            controller = law(signals, parameters.from_unit(generator.random(len(parameters.bounds()))))
            laws.append(lambda observation, step, controller=controller: controller.predict(observation)[0][0])
    return deploy(laws)


@pytest.fixture(scope="module")
def deployments(wide_set):
    """Returns, peak forces [N] and sliding work [J] of the controllers that deploy the array."""
    deployed = [run for run in wide_set if run.latched]
    assert len(deployed) >= 30
    return tuple(np.array([getattr(run, name) for run in deployed]) for name in ("total", "force", "work"))


@pytest.fixture(scope="module")
def passive():
    """Passive deployments that differ by micrometres, which spreads what impacts make of them."""
    return deploy([constant(0.0)] * 6, randomize=SAMPLING)


def rank_correlation(one, other):
    return float(spearmanr(one, other).statistic)


def test_limits_durations_and_prices_are_the_documented_ones():
    assert Task(0.5, 0.1, 20, 10, driven_joint=0) == TASK
    env = gymnasium.make(DEPLOY_V1).unwrapped
    assert env.task == TASK
    assert env.reward.names == ("peak_impact", "wear", "missed_deadline")
    assert env.reward.prices["peak_impact"] == Price(FORCE_SCALE, 1.0, LARGEST)
    assert env.reward.prices["wear"] == Price(WORK_SCALE, 1.0, LARGEST)
    assert env.reward.prices["missed_deadline"] == Price(1.0, MISSED, 2.0)


def test_the_passive_deployment_returns_what_the_documentation_promises(passive):
    """Up to the spread of deployments that differ by micrometres, which another processor's rounding spreads too."""
    alone = deploy([constant(0.0)])[0]
    assert alone.total == pytest.approx(-2.8, abs=0.2)
    assert mean_total(passive) == pytest.approx(-2.8, abs=0.2)


def test_the_return_ranks_deployments_as_force_and_wear_together_do(deployments):
    """As their product does, which knows of no prices.

    0.95 stands for a tenth of the pairs in another order, half of what `solar-env ladder --ask` allows by default.
    """
    total, force, work = deployments
    assert rank_correlation(total, -force * work) > 0.95


@pytest.mark.parametrize("figure", ["force", "work"])
def test_a_figure_that_is_a_third_larger_is_ranked_so(deployments, figure):
    """In nine of ten pairs at least, and wrongly less than half as often as by a return that left the figure out.

    Less than a third is within what rigid panels leave open.
    """
    total, force, work = deployments
    values, left = {"force": (force, work), "work": (work, force)}[figure]
    one, other = np.triu_indices(len(total), 1)
    apart = np.abs(np.log(values[one] / values[other])) > math.log(4.0 / 3.0)
    assert apart.sum() > 200

    def wrong(score):
        return np.mean(((score[one] > score[other]) == (values[one] > values[other]))[apart])

    assert wrong(total) < 0.1
    assert wrong(total) < 0.5 * wrong(-left)


def test_whoever_misses_the_deadline_ranks_below_all_who_deploy(wide_set):
    missed = [run.total for run in wide_set if not run.latched]
    assert len(missed) >= 3
    assert max(missed) < WORST_DEPLOYMENT < min(run.total for run in wide_set if run.latched)


def test_holding_the_array_folded_or_short_of_its_latches_never_pays(passive):
    openings = (0.5, 0.9, 0.985)
    runs = deploy([constant(-1.0), *(held_short_at(opening) for opening in openings)])
    missed = [np.sum(run.terms, axis=0)[2] for run in runs]
    assert missed == sorted(missed), "the wider open, the less it costs"
    for run in runs:
        assert run.figures["latch_times_s"] == [None, None]
        assert -2.0 * MISSED - 1.0 <= run.total <= -MISSED < WORST_DEPLOYMENT < min(alone.total for alone in passive)


@pytest.mark.parametrize(
    ("law", "keywords"),
    [
        # Passively the outer joint latches at 12.28 s and the root at 12.30 s.
        (constant(0.0), {"deadline": 12.29}),
        (constant(-1.0), {"parameters": SOFT_CABLE}),
        (in_turn(constant(0.0), constant(-1.0), any_latched), {"parameters": SOFT_CABLE}),
    ],
    ids=["by chance", "root held folded", "root pushed back"],
)
def test_latching_one_joint_and_not_the_other_never_pays(law, keywords):
    run = deploy([law], **keywords)[0]
    root, outer = run.figures["latch_times_s"]
    assert root is None
    assert outer is not None
    peak_impact, _, missed = np.sum(run.terms, axis=0)
    assert -2.0 * MISSED < missed < -MISSED
    assert peak_impact < 0.0, "what the one latching did is charged on top"
    assert run.total < missed < WORST_DEPLOYMENT


@pytest.mark.parametrize("model", ["rigid-clearance", "rigid-ideal"])
def test_how_close_to_the_deadline_it_latched_makes_no_difference(model):
    for action in (0.0, 0.6):
        ample = deploy([constant(action)], model=model)[0]
        deadline = TASK.control_period * math.ceil(ample.last_latch / TASK.control_period)
        tight = deploy([constant(action)], model=model, deadline=deadline)[0]
        assert tight.terms == ample.terms
        assert tight.times[-1] == pytest.approx(ample.last_latch + TASK.settling_window)
        assert sum(sum(terms) for terms in tight.terms[round(deadline / TASK.control_period) :]) < 0.0


def test_an_episode_is_charged_for_what_the_same_torques_do_to_an_array_without_a_task():
    """Peaks after the first latching and then in both joints, wear from the start; and the figures at the end.

    Of an array whose root latches nine seconds after the outer joint, while the motor swings to and fro.
    """
    (run,) = deploy([lambda observation, step: 0.3 * math.sin(0.05 * step)], parameters=SOFT_CABLE, control_period=0.02)
    root, outer = run.figures["latch_times_s"]
    assert outer + 5.0 < root
    record = physical_record(run, **SOFT_CABLE)
    peaks, work = record.peaks, record.work
    first, second = step_of(outer, run), step_of(root, run)
    assert np.all(peaks[:first].max(axis=0) > 10.0)
    assert np.all(work[first - 1] > 1e-3)
    assert not np.any(np.array(run.terms)[:first, 0])
    assert np.sum(run.terms[:first], axis=0)[1] == pytest.approx(-work[first - 1].sum() / WORK_SCALE, rel=1e-9)
    before = second - 1
    assert peaks[first + 1 : second, 0].max() > 10.0, "the open joint has a share in what comes next"
    assert work[before, 0] > work[first, 0] + 1e-3
    assert_charged(run.terms, peaks, work, first, before)
    assert_charged(run.terms, peaks, work, first, len(run.times) - 1)
    for name, so_far in (("postlock_impulse_Ns", record.impulse), ("postlock_sliding_work_J", work)):
        least, greatest = (so_far[-1] - so_far[start] for start in (first, first - 1))
        assert np.all(least * (1.0 - 1e-9) <= run.figures[name]), name
        assert np.all(run.figures[name] <= greatest * (1.0 + 1e-9)), name
        assert np.all(so_far[-1] > greatest + 0.1 * least), "what came before the latching would show"
    turned = np.diff(record.angles, axis=0, prepend=0.0)[:, 0]
    motor_work = TASK.torque_limit * np.array(run.actions) @ turned
    assert abs(motor_work) > 0.01
    assert run.figures["motor_work_J"] == pytest.approx(motor_work, rel=1e-5)
    assert run.figures["wear_depth_max_m"] == pytest.approx(record.wear.tolist(), rel=1e-9, abs=0.0)


def test_neither_chatter_nor_pressing_with_full_torque_gains_anything_over_a_damper():
    damper = viscous(3.0, 3.0)
    alone = deploy([damper] * 3, randomize=SAMPLING)
    shaking = [*phases((1, -1)), *phases((1, 1, -1, -1))]
    pressing = [constant(1.0), constant(-1.0)]
    best = min(run.total for run in alone)
    for when in ("before", "after", "both"):
        laws = {
            "before": [in_turn(law, damper, all_latched) for law in shaking],
            "after": [in_turn(damper, law, all_latched) for law in shaking + pressing],
            "both": phases((1, -1)),
        }[when]
        for run in deploy(laws, randomize=SAMPLING):
            assert run.latched
            assert run.total < best, when


@pytest.mark.parametrize("model", ["rigid-ideal", "flexible-ideal:1 element"])
def test_the_return_does_not_depend_on_how_finely_a_torque_is_cut(model):
    """Up to the tolerance of the integration."""
    torques, totals = np.random.default_rng(1).uniform(-1.0, 1.0, 300), []
    for pieces in (1, 2):
        (run,) = deploy(
            [lambda observation, step, cut=pieces: torques[step // cut]], model=model, control_period=0.1 / pieces
        )
        totals.append(run.total)
    assert totals[1] == pytest.approx(totals[0], rel=0.01)


def test_charges_stop_at_their_bound_however_violent_the_deployment():
    """With a motor two hundred times as strong."""
    shaken, thrown, dropped = deploy(
        [in_turn(constant(1.0), chatter((1, -1)), any_latched), constant(1.0), constant(-1.0)], torque_limit=100.0
    )
    assert shaken.force > LARGEST * FORCE_SCALE
    assert shaken.work > LARGEST * WORK_SCALE
    assert np.sum(shaken.terms, axis=0) == pytest.approx([-LARGEST, -LARGEST, 0.0], abs=1e-12)
    for run in (shaken, thrown, dropped):
        assert np.max(run.terms) <= 0.0
        assert np.cumsum(run.terms, axis=0).min() >= -2.0 * MISSED - 1e-12
    assert dropped.total <= -MISSED < shaken.total < thrown.total
