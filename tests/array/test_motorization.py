"""The torque that drives each hinge, beside the torque that the standard asks for, as one works it out by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

from solar_env.array import ArrayParameters
from solar_env.array.motorization import motorization

FREE = {"cable_stiffness": 0.0, "spring_stiffness": (0.4, 0.15), "spring_preload_angle": (2.6, 4.0)}


def test_a_harness_at_the_end_of_the_opening_is_weighed_as_by_hand():
    array = ArrayParameters(**FREE, harness_torque=((0.0, 0.02), (1.0, 0.0), (math.pi, -0.05)))
    _, outer = motorization(array)
    ratio, angle = outer.ratio
    assert angle == math.pi
    assert ratio == pytest.approx(0.15 * (4.0 - math.pi) / (2.0 * 3.0 * 0.05))
    assert motorization(array, {"harness": 1.5})[1].ratio[0] == pytest.approx(2.0 * ratio)
    assert outer.stalls_at is None
    # Where the harness opens, it drives.
    assert outer.driving[0] == pytest.approx(0.15 * 4.0 + 0.02)


def test_friction_and_damper_resist_over_the_whole_opening():
    array = ArrayParameters(**FREE, hinge_friction_torque=0.01, hinge_damping=(0.6, 0.0))
    root, outer = motorization(array)
    at_lock = 0.4 * (2.6 - math.pi / 2)
    slow = 0.6 * (math.pi / 2) / 60.0
    assert root.ratio == (pytest.approx(at_lock / (2.0 * 3.0 * (0.01 + slow))), pytest.approx(math.pi / 2))
    np.testing.assert_allclose(outer.resisting, 0.01)


def test_a_spring_that_is_relaxed_before_the_lock_is_told_where():
    root, outer = motorization(ArrayParameters(**{**FREE, "spring_preload_angle": (0.8, 4.0)}))
    assert root.stalls_at == pytest.approx(0.8, abs=math.pi / 400)
    assert str(root).startswith("joint 1: no torque left from 0.8")
    assert str(outer) == "joint 2: nothing to overcome"


def test_hinges_that_cable_loops_hold_together_share_their_torques():
    array = {**FREE, "cable_stiffness": 20.0, "hinge_friction_torque": (0.01, 0.02)}
    root, outer, together = motorization(ArrayParameters(**array))
    assert together.driving[-1] == pytest.approx(root.driving[-1] + 2.0 * outer.driving[-1])
    assert together.asked[-1] == pytest.approx(2.0 * 3.0 * (0.01 + 2.0 * 0.02))
    assert root.ratio[0] > together.ratio[0] > outer.ratio[0]


def test_a_factor_that_is_none_is_refused():
    with pytest.raises(ValueError, match="uncertainty factor 'harnes' is unknown; did you mean 'harness'"):
        motorization(ArrayParameters(), {"harnes": 1.5})
    with pytest.raises(ValueError, match="friction = -1 must be positive"):
        motorization(ArrayParameters(), {"friction": -1})


def test_weight_that_hangers_leave_is_lifted_as_by_hand():
    """A panel that hangs from its root at first, and stands out level at last."""
    array = {"panel_count": 1, "body_fixed": True, "gravity": 9.81, "spring_stiffness": 30.0}
    held = {"spring_preload_angle": 3.0, "offloading_share": 0.5, "offloading_friction": 0.01}
    (hinge,) = motorization(ArrayParameters(**array, **held))
    lifted, rubbed = 6.0 * 9.81 * 0.5 * 0.75, 0.01 * 6.0 * 9.81 * 0.5 * 0.75
    ratio, angle = hinge.ratio
    assert angle == math.pi / 2
    assert ratio == pytest.approx(30.0 * (3.0 - math.pi / 2) / (2.0 * (1.1 * lifted + 3.0 * rubbed)))
    assert hinge.resisting[[0, -1]] == pytest.approx([rubbed, rubbed + lifted])
    with pytest.raises(ValueError, match=r"gravity = 9\.81 needs body_fixed = true"):
        ArrayParameters(gravity=9.81)
