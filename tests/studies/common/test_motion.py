import math
from dataclasses import replace

import numpy as np
import pytest
from helpers import MOTION_TIMES, make_motion

from solar_env.array.deployment import simulate
from solar_env.studies.common.motion import angle_error, force_error, from_trajectory, latch_error


def test_the_angle_error_is_the_greatest_difference_up_to_the_time():
    reference = make_motion()
    angles = reference.angles.copy()
    angles[3, 1] += 1e-3
    angles[8, 0] += 1.0
    motion = replace(reference, angles=angles)
    assert angle_error(motion, reference, until=0.5) == pytest.approx(1e-3)
    assert angle_error(motion, reference, until=0.8) == pytest.approx(1.0)


def test_motions_sampled_at_other_times_are_not_compared():
    with pytest.raises(ValueError, match="different times"):
        angle_error(make_motion(time=MOTION_TIMES + 0.01), make_motion(), until=1.0)


@pytest.mark.parametrize(
    ("latch", "expected"), [((0.502, math.nan), 2e-3), ((0.5, 0.7), 0.0), ((math.nan, math.nan), math.inf)]
)
def test_the_latch_error_counts_the_joints_that_should_latch(latch, expected):
    assert latch_error(make_motion(latch=latch), make_motion()) == pytest.approx(expected)
    assert math.isnan(latch_error(make_motion(), make_motion(latch=(math.nan, math.nan)))), "none should"


def test_a_study_keeps_the_motion_and_what_the_run_comes_to_after_the_latching():
    run = simulate({"spring_stiffness": 2.0}, duration=4.0)
    run = replace(run, peak_force=2.0 * run.postlock_peak_force)
    motion = from_trajectory(run)
    assert np.array_equal(motion.time, run.time)
    assert np.array_equal(motion.angles, run.angles)
    assert np.array_equal(motion.latch_times, run.latch_times, equal_nan=True)
    for name in ("steps", "evaluations", "factorizations", "wall_time"):
        assert getattr(motion, name) == run.metadata["wall_time_s" if name == "wall_time" else name], name
    assert motion.energy_residual == run.energy_residual / run.energy_put_in
    assert set(motion.totals) == {"peak_force_N", "sliding_work_J", "impacts", "wear_depth_m"}
    assert motion.totals["peak_force_N"].tolist() == run.postlock_peak_force.tolist()
    assert motion.totals["wear_depth_m"].tolist() == run.wear_depth.tolist()
    first = np.searchsorted(run.time, np.nanmin(run.latch_times))
    work, so_far = motion.totals["sliding_work_J"], run.sliding_work
    assert np.all(so_far[-1] - so_far[first] <= work)
    assert np.all(work <= so_far[-1] - so_far[first - 1])
    assert np.all(so_far[first - 1] > 0.01 * so_far[-1])
    starts = [run.contacts["start_s"][run.contacts["joint"] == joint] for joint in (0, 1)]
    assert motion.totals["impacts"].tolist() == [np.sum(own > np.nanmin(run.latch_times)) for own in starts]


def test_peak_forces_are_compared_joint_by_joint_where_the_reference_has_one():
    own, right, none = (
        replace(make_motion(), totals={"peak_force_N": np.array(forces)})
        for forces in ((11.0, 5.0), (10.0, 0.0), (0.0, 0.0))
    )
    assert force_error(own, right) == pytest.approx(0.1)
    assert math.isnan(force_error(own, none))
