import math
from dataclasses import replace

import pytest
from helpers import MOTION_TIMES, make_motion

from solar_env.studies import measures

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
