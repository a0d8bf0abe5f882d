"""Closed cable loops: torque and energy, and the belt along the chord of a body that bends."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from belts import LOOP, PULLING, belt
from helpers import Forces, central_difference, rigid_motions
from mechanisms import ROUND_BEARING

from solar_env.mechanics.analysis.linearization import static_equilibrium
from solar_env.mechanics.arrays import columns
from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.bodies.markers import direction, place
from solar_env.mechanics.equations.build import compile_mechanism
from solar_env.mechanics.joints.cable_loop import cable_torque
from solar_env.mechanics.mechanism.description import GROUND, Body, CableLoop, FlexibleBody, Joint, Load, Mechanism

CABLE = CableLoop("a", "b", stiffness=4.0, wheel_ratio=2.0, torque_ratio=2.0, preload_torque=0.6)


def cable_row(cable: CableLoop) -> np.record:
    row = np.zeros(1, dtype=m.cable_type)
    for name in ("stiffness", "wheel_ratio", "torque_ratio", "preload_torque"):
        row[name] = getattr(cable, name)
    return row[0]


def test_a_cable_loop_halves_its_stiffness_when_one_strand_goes_slack() -> None:
    # Slack at twice the preload's torque: 2 * 0.6 / 4 = 0.3 rad.
    row = cable_row(CABLE)
    for stretch, torque, slope in ((0.1, 0.4, 4.0), (-0.2, -0.8, 4.0), (0.5, 1.2 + 0.4, 2.0), (-1.3, -1.2 - 2.0, 2.0)):
        found = cable_torque(row, stretch)
        assert found[:2] == pytest.approx((torque, slope), rel=1e-14)
    below, above = cable_torque(row, 0.3 - 1e-12), cable_torque(row, 0.3 + 1e-12)
    assert above[0] - below[0] == pytest.approx(0.0, abs=1e-11)
    assert above[2] - below[2] == pytest.approx(0.0, abs=1e-11)


def test_a_cable_torque_is_the_slope_of_its_energy() -> None:
    row = cable_row(CABLE)
    for stretch in (-1.0, -0.31, -0.1, 0.0, 0.2, 0.29, 0.7):
        # Quadratic pieces: no truncation.
        slope = (cable_torque(row, stretch + 1e-4)[2] - cable_torque(row, stretch - 1e-4)[2]) / 2e-4
        assert cable_torque(row, stretch)[0] == pytest.approx(slope, abs=1e-11)


def test_a_cable_of_infinite_preload_never_slackens_and_one_of_none_is_slack_at_once() -> None:
    tight, loose = (cable_row(replace(CABLE, preload_torque=p)) for p in (math.inf, 0.0))
    assert cable_torque(tight, 1e6)[0] == pytest.approx(4e6)
    assert cable_torque(loose, 0.1)[0] == pytest.approx(0.2)


def test_a_cable_of_no_stiffness_pulls_on_nothing() -> None:
    assert cable_torque(cable_row(replace(CABLE, stiffness=0.0)), 0.7) == (0.0, 0.0, 0.0)


def mismatch(forces: Forces, reverse: bool) -> float:
    """Of the wheels against the chord, from the bodies' places and directions."""
    markers, joints, q = forces.model.markers, forces.model.joints, forces.state.q
    wheels = [complex(*direction(markers[k], q)) for k in (joints[0]["inboard"], joints[1]["outboard"])]
    ends = [complex(*place(markers[k], q)) for k in (joints[0]["outboard"], joints[1]["inboard"])]
    chord = (ends[1] - ends[0]) * (-1.0 if reverse else 1.0)
    inner = np.angle(chord / wheels[0]) - 0.2
    outer = -(np.angle(wheels[1] / chord) + 0.3)
    return float(2.0 * inner - outer)


BELTS = [(seed, reverse) for seed in range(3) for reverse in (False, True)]


@pytest.mark.parametrize(("seed", "reverse"), BELTS)
@pytest.mark.parametrize("torque_ratio", [2.0, 1.0])
def test_a_belt_pulls_by_its_mismatch_against_the_chord(seed: int, reverse: bool, torque_ratio: float) -> None:
    forces = belt(seed, reverse=reverse, cable=replace(LOOP, torque_ratio=torque_ratio))
    forces.force(forces.state.q, forces.state.v)
    torque = 1.7 * mismatch(forces, reverse)
    assert forces.work.loads[:, columns.CABLE_TORQUE] == pytest.approx([-torque_ratio * torque, torque], rel=1e-12)


@pytest.mark.parametrize(("seed", "reverse"), BELTS)
@pytest.mark.parametrize("loop", [LOOP, PULLING], ids=["chord", "pulling"])
def test_the_forces_of_a_belt_are_the_slope_of_its_energy(seed: int, reverse: bool, loop: CableLoop) -> None:
    forces = belt(seed, reverse=reverse, cable=loop)
    q, v = forces.state.q, forces.state.v
    slope = central_difference(lambda x: forces.stored(x, v)[[m.CABLE]], q)[0]
    assert forces.force(q, v) == pytest.approx(-slope, abs=1e-9 * np.abs(slope).max())


@pytest.mark.parametrize(("seed", "reverse"), BELTS)
@pytest.mark.parametrize("loop", [LOOP, PULLING], ids=["chord", "pulling"])
def test_the_work_of_a_belt_of_other_torque_ratio_is_booked(seed: int, reverse: bool, loop: CableLoop) -> None:
    forces = belt(seed, reverse=reverse, cable=replace(loop, torque_ratio=1.0))
    q, v = forces.state.q, forces.state.v
    growth = central_difference(lambda t: forces.stored(q + t[0] * v, v)[[m.CABLE]], np.zeros(1))[0, 0]
    force = forces.force(q, v)
    put_in = forces.integral_powers()[:, m.CABLE_WORK].sum()
    assert force @ v == pytest.approx(put_in - growth, abs=1e-9 * float(np.abs(force) @ np.abs(v)))


@pytest.mark.parametrize("torque_ratio", [2.0, 1.0])
@pytest.mark.parametrize("loop", [LOOP, PULLING], ids=["chord", "pulling"])
def test_a_belt_changes_no_momentum(torque_ratio: float, loop: CableLoop) -> None:
    forces = belt(0, cable=replace(loop, torque_ratio=torque_ratio))
    force = forces.force(forces.state.q, forces.state.v)
    for field in rigid_motions(forces.model, forces.state.q):
        assert force @ field == pytest.approx(0.0, abs=1e-13 * float(np.abs(force) @ np.abs(field)))


def deflection(cable: CableLoop, torque: float) -> tuple[float, float]:
    """Bend of a beam's ends [rad] and turn of the arm at its tip, held by a loop from the ground; the beam is held."""
    beam = FlexibleBody("beam", 1.5, 2, 4.0, axial_stiffness=1e5, bending_stiffness=200.0)
    arm = Body("arm", 1.0, 0.1, 0.5, (0.2, 0.0), position=(1.5, 0.0))
    joints = (
        Joint("inner", GROUND, "beam", (0.0, 0.0), (0.0, 0.0)),
        Joint("outer", "beam", "arm", (1.5, 0.0), (0.0, 0.0)),
        Joint("tip", GROUND, "beam", (1.5, 0.0), (1.5, 0.0)),
    )
    mechanism = Mechanism((beam, arm), joints, (cable,), loads=(Load("arm", torque=torque),))
    model, _ = compile_mechanism(mechanism)
    q = static_equilibrium(mechanism)
    slopes = [direction(model.markers[model.joints[k]["outboard" if k == 0 else "inboard"]], q) for k in (0, 1)]
    turn = direction(model.markers[model.joints[1]["outboard"]], q)
    return max(abs(math.atan2(y, x)) for x, y in slopes), math.atan2(turn[1], turn[0])


def test_a_belt_along_the_chord_does_not_bend_the_panel_that_it_runs_along() -> None:
    bend, turn = deflection(CableLoop("inner", "outer", 40.0, 1.0, 1.0), 2.0)
    assert bend == pytest.approx(0.0, abs=1e-10)
    assert turn == pytest.approx(2.0 / 40.0, rel=1e-9)


def test_a_belt_between_two_joints_at_one_point_of_a_beam_is_refused() -> None:
    beam = FlexibleBody("beam", 1.5, 2, 4.0, axial_stiffness=1e5, bending_stiffness=200.0)
    joints = (
        Joint("inner", GROUND, "beam", (0.0, 0.0), (0.0, 0.0)),
        Joint("outer", "beam", "arm", (0.0, 0.0), (0.0, 0.0)),
    )
    arm = Body("arm", 1.0, 0.1, 0.5, (0.2, 0.0))
    with pytest.raises(ValueError, match="'outer': must attach to 'beam' at another point of its axis than 'inner'"):
        compile_mechanism(Mechanism((beam, arm), joints, (LOOP,)))


@pytest.mark.parametrize(("sign", "offset"), [(-1, 0.05), (1, 0.15)])
def test_the_pull_on_the_bearings_is_that_of_two_strands(sign: int, offset: float) -> None:
    """At rest at the joints' distance: twice the preload times the cosine of the slope of strands, open or crossed."""
    bodies = (
        Body("base", 1.0, 0.1, 1.0, (0.0, 0.0)),
        Body("arm", 1.0, 0.1, 1.5, (0.5, 0.0)),
        Body("last", 1.0, 0.1, 1.0, (0.5, 0.0), position=(1.5, 0.0)),
    )
    joints = (
        Joint("inner", "base", "arm", (0.0, 0.0), (0.0, 0.0), bearing=ROUND_BEARING),
        Joint("outer", "arm", "last", (1.5, 0.0), (0.0, 0.0), sign=sign, bearing=ROUND_BEARING),
    )
    loop = CableLoop("inner", "outer", 20.0, 2.0, 2.0, preload_torque=50.0 * 0.05, wheel_radius=0.05)
    forces = Forces(Mechanism(bodies, joints, (loop,)))
    force = forces.force(forces.state.q, forces.state.v)
    along, across = (sum(force[:4][k::2]) for k in (0, 1))
    assert along == pytest.approx(100.0 * math.sqrt(1.0 - (offset / 1.5) ** 2), rel=1e-12)
    assert across == pytest.approx(0.0, abs=1e-12)
    # Turned by 0.01 rad, the last body stretches one strand and eases the other: 0.2 N m on it, 4 N of difference.
    turned = replace(bodies[2], angle=0.01)
    forces = Forces(Mechanism((*bodies[:2], turned), joints, (loop,)))
    force = forces.force(forces.state.q, forces.state.v)
    assert sum(force[1:4:2]) == pytest.approx(-sign * 4.0 * offset / 1.5, rel=1e-9)


def test_wheels_that_do_not_fit_are_refused() -> None:
    with pytest.raises(ValueError, match=r"two wheels of 1\.8 m together do not fit between joints 1\.2 m apart"):
        belt(0, cable=replace(PULLING, wheel_radius=0.6))
    with pytest.raises(ValueError, match=r"CableLoop\.preload_torque = inf: must be finite"):
        replace(LOOP, wheel_radius=0.1)
