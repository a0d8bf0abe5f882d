import math
from dataclasses import replace

import numpy as np
import pytest
from helpers import MOTION_TIMES, make_motion

from solar_env.array.deployment import simulate
from solar_env.studies.common import measures
from solar_env.studies.common.motion import from_trajectory

IMPACTS = [(0, 0.1, 10.0), (1, 0.15, 20.0), (0, 0.2, 30.0), (0, 0.3, 40.0)]


def test_the_angle_error_is_the_greatest_difference_up_to_the_time():
    reference = make_motion()
    angles = reference.angles.copy()
    angles[3, 1] += 1e-3
    angles[8, 0] += 1.0
    motion = replace(reference, angles=angles)
    assert measures.angle_error(motion, reference, until=0.5) == pytest.approx(1e-3)
    assert measures.angle_error(motion, reference, until=0.8) == pytest.approx(1.0)


def test_motions_sampled_at_other_times_are_not_compared():
    with pytest.raises(ValueError, match="different times"):
        measures.angle_error(make_motion(time=MOTION_TIMES + 0.01), make_motion(), until=1.0)


@pytest.mark.parametrize(
    ("latch", "expected"), [((0.502, math.nan), 2e-3), ((0.5, 0.7), 0.0), ((math.nan, math.nan), math.inf)]
)
def test_the_latch_error_counts_the_joints_that_should_latch(latch, expected):
    assert measures.latch_error(make_motion(latch=latch), make_motion()) == pytest.approx(expected)


def test_without_a_latching_there_is_no_latch_error():
    assert math.isnan(measures.latch_error(make_motion(), make_motion(latch=(math.nan, math.nan))))


def test_the_horizon_ends_at_the_first_impact_that_two_references_tell_differently():
    other = [*IMPACTS[:3], (0, 0.3, 41.0)]
    assert measures.horizon(make_motion(impacts=IMPACTS), make_motion(impacts=IMPACTS)) == (3, 1)
    assert measures.horizon(make_motion(impacts=IMPACTS), make_motion(impacts=other)) == (2, 1)
    assert measures.horizon(make_motion(impacts=IMPACTS), make_motion()) == (0, 0)


def test_errors_are_taken_over_a_quarter_of_the_horizon_and_few_impacts():
    assert measures.compared_impacts((0, 1, 5, 9, 54)) == (0, 1, 2, 3, 3)


def test_impact_errors_are_those_of_the_first_impacts_alone():
    motion = make_motion(impacts=[(0, 0.1001, 10.1), (1, 0.15, 20.0), (0, 0.25, 60.0), (0, 0.3, 40.0)])
    reference = make_motion(impacts=IMPACTS)
    assert measures.impact_errors(motion, reference, (1, 1)) == pytest.approx((1e-4, 0.01))
    assert measures.impact_errors(motion, reference, (2, 1)) == pytest.approx((0.05, 1.0))
    assert measures.impact_errors(motion, reference, (0, 0)) == (0.0, 0.0)
    assert measures.impact_errors(make_motion(), reference, (1, 0)) == (math.inf, math.inf)


def test_predicted_impacts_are_counted_up_to_the_first_wrong_one_of_each_joint():
    reference = make_motion(impacts=IMPACTS)
    motion = make_motion(impacts=[(0, 0.1, 10.05), (1, 0.15, 20.0), (0, 0.2, 35.0), (0, 0.3, 40.0)])
    assert measures.predicted_impacts(motion, reference, (3, 1)) == 2
    assert measures.predicted_impacts(reference, reference, (3, 1)) == 4
    assert measures.predicted_impacts(make_motion(), reference, (3, 1)) == 0


def test_a_study_keeps_what_a_run_sums_up_after_the_latching_and_the_greatest_wear_and_loss():
    """Of a run whose figures before and after the latching are told apart."""
    run = simulate({"spring_stiffness": 2.0}, duration=4.0)
    run = replace(run, peak_force=2.0 * run.postlock_peak_force)
    totals = from_trajectory(run).totals
    first = np.searchsorted(run.time, np.nanmin(run.latch_times))
    for name, so_far in (("impulse", run.impulse), ("sliding_work", run.sliding_work)):
        assert np.all(so_far[-1] - so_far[first] <= totals[name])
        assert np.all(totals[name] <= so_far[-1] - so_far[first - 1])
        assert np.all(so_far[first - 1] > 0.01 * so_far[-1])
    assert totals["peak_force"].tolist() == run.postlock_peak_force.tolist()
    assert totals["wear_depth"].tolist() == run.wear_depth.tolist()
    lost = sum(run.energies[f"{what}_dissipation"][-1] for what in ("contact", "friction", "latch", "material"))
    stored = run.energies["spring"][0] + run.energies["cable"][0]
    assert totals["energy_lost"] == pytest.approx([lost / stored] * 2)
    assert set(totals) == {"impulse", "sliding_work", "peak_force", "wear_depth", "energy_lost"}


def test_a_study_keeps_motion_contacts_and_counts_as_the_run_has_them():
    run = simulate({"spring_stiffness": 2.0}, duration=1.0)
    motion = from_trajectory(run)
    assert np.array_equal(motion.time, run.time)
    assert np.array_equal(motion.angles, run.angles)
    assert np.array_equal(motion.latch_times, run.latch_times, equal_nan=True)
    assert np.all(np.diff(motion.contacts["start_s"]) >= 0.0)
    assert sorted(motion.contacts["peak_force"]) == sorted(run.contacts["peak_force"])
    for name in ("steps", "evaluations", "factorizations", "wall_time"):
        assert getattr(motion, name) == run.metadata["wall_time_s" if name == "wall_time" else name], name
    assert motion.energy_residual == run.energy_residual / run.energy_put_in


def test_peak_forces_are_compared_joint_by_joint_where_the_reference_has_one():
    own, right, none = (
        replace(make_motion(), totals={"peak_force": np.array(forces)})
        for forces in ((11.0, 5.0), (10.0, 0.0), (0.0, 0.0))
    )
    assert measures.force_error(own, right) == pytest.approx(0.1)
    assert math.isnan(measures.force_error(own, none))
