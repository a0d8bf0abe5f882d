"""Explicit steps where everything is known in closed form: sizes, events, interpolants, books, and what ends a call."""

from __future__ import annotations

import contextlib
import math
from dataclasses import replace

import numpy as np
import pytest
from helpers import attempt, fingerprint, single_steps
from mechanisms import block, floating_pair, pendulum, towards_walls

from solar_env.array import ArrayParameters, build
from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.arrays.columns import ANGLE
from solar_env.mechanics.integrators.methods.rosenbrock import make_stage_arrays
from solar_env.mechanics.integrators.methods.runge_kutta import take_stages
from solar_env.mechanics.integrators.methods.stages import cubic_weights, quintic_weights, refresh
from solar_env.mechanics.integrators.settings import RungeKutta
from solar_env.mechanics.joints.laws import PowerLaw
from solar_env.mechanics.mechanism.description import GROUND, Bearing, Body, Joint, Mechanism, Stop
from solar_env.mechanics.running.diagnosis import SimulationWarning
from solar_env.mechanics.running.errors import SimulationError
from solar_env.mechanics.running.simulation import Simulation, simulate

# Nothing is ever rejected: a step is as long as it is asked for.
UNCONTROLLED = RungeKutta(rtol=0.1, velocity_scale=1e9)
CLEARANCE = 1e-3
CHORD = 3e-3  # share by which an angle is off after one long step: its coordinates run on a circle
STOP = Stop(gap=0.01, stiffness=100.0, exponent=1.0, ramp_depth=1e-3, damping=10.0)


def with_step(mechanism: Mechanism, step: float, integrator: RungeKutta = UNCONTROLLED) -> Simulation:
    """A simulation that tries one step a call, the next one of a given size."""
    simulation = single_steps(mechanism, integrator)
    simulation.state.clock["step_size"], simulation.state.clock["last_error"] = step, 1.0
    if integrator is UNCONTROLLED:
        simulation.state.clock["energy_scale"] = 1e9
    return simulation


def test_in_free_flight_steps_begin_with_a_microsecond_and_grow_tenfold_up_to_their_bound() -> None:
    simulation = single_steps(block((1e-5, 0.0)), RungeKutta(max_step=0.5))
    times = [0.0]
    for _ in range(9):
        attempt(simulation, 50.0)
        times.append(simulation.time)
    assert np.diff(times) == pytest.approx([1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 0.5, 0.5, 0.5], rel=1e-9)


def test_the_next_step_follows_from_the_errors_of_the_last_two() -> None:
    simulation = with_step(pendulum(), 0.02, RungeKutta())
    clock = simulation.state.clock
    for _ in range(6):
        attempt(simulation, 10.0)
        start, before = simulation.time, clock["last_error"][0]
        attempt(simulation, 10.0)
        error = clock["last_error"][0]
        assert 1e-4 < error <= 1.0
        # Proportional and integral control of an error of order four.
        growth = 0.9 * error ** (-0.72 / 4.0) * before ** (0.4 / 4.0)
        assert clock["step_size"][0] == pytest.approx((simulation.time - start) * growth, rel=1e-12)
    assert clock["rejected_steps"][0] == 0


def test_errors_below_a_ten_thousandth_of_the_tolerance_are_remembered_as_that() -> None:
    simulation = with_step(block((1e-5, 0.0)), 1e-3, RungeKutta())
    attempt(simulation, 10.0)
    assert simulation.state.clock["last_error"][0] == 1e-4


def test_a_step_that_is_refused_is_tried_again_at_a_tenth_at_least_and_passes_with_what_is_left_for_safety() -> None:
    far = with_step(floating_pair(), 0.05, RungeKutta(rtol=1e-11))
    attempt(far, 10.0)
    assert far.state.clock["step_size"][0] == pytest.approx(0.005, rel=1e-12)
    simulation = with_step(floating_pair(), 0.002, RungeKutta(rtol=1e-11))
    assert not attempt(simulation, 10.0)
    assert (simulation.time, simulation.state.clock["rejected_steps"][0]) == (0.0, 1)
    attempt(simulation, 10.0)
    assert simulation.time > 0.0
    # The error goes with the fourth power of the step, but for terms of a higher order.
    assert simulation.state.clock["last_error"][0] == pytest.approx(0.9**4, rel=0.02)


@pytest.mark.parametrize(("start", "refused"), [(0.0, 7), (1e3, 4)])
def test_a_force_beyond_numbers_ends_a_call_once_steps_are_lost_in_rounding(start: float, refused: int) -> None:
    simulation = Simulation(block((0.0, 0.0)))
    clock = simulation.state.clock
    clock["time"], clock["step_size"], clock["last_error"] = start, 0.9e-6, 1.0
    simulation.set_motor_torque(0, 1e308)
    with pytest.raises(SimulationError, match="no longer finite") as caught, np.errstate(all="ignore"):
        simulation.advance(start + 1.0)
    # A tenth of the step each time, down to 1e-13 of the time, or of a second.
    assert clock["rejected_steps"][0] == refused
    assert (caught.value.reason, simulation.time) == ("not_finite", start)


def test_a_call_that_ends_just_after_a_step_does_not_shorten_the_next_one() -> None:
    simulation = Simulation(block((1e-5, 0.0)))
    simulation.state.clock["step_size"], simulation.state.clock["last_error"] = 0.1, 1.0
    simulation.advance(1e-7)
    assert simulation.state.clock["step_size"][0] == pytest.approx(0.1, rel=1e-12)
    # One that ends a step early lets it grow all the same.
    simulation.advance(1e-7 + 0.09)
    assert simulation.state.clock["step_size"][0] == pytest.approx(0.9, rel=1e-9)
    assert simulation.state.clock["steps"][0] == 2


def wheel(name: str, angle: float = 0.0) -> Body:
    return Body(f"{name} wheel", 1.0, 2.0, length=1.0, centroid=(0.0, 0.0), angle=angle)


def pin(name: str, lock_angle: float | None = None, stow_angle: float | None = None, sign: int = 1) -> Joint:
    """An ideal joint of a wheel of 2 kg m2 with the ground, with a latch or a stow stop."""
    ends = (0.0, 0.0), (0.0, 0.0)
    return Joint(
        name, GROUND, f"{name} wheel", *ends, sign=sign, stop=STOP, lock_angle=lock_angle, stow_angle=stow_angle
    )


def spun_up(angle: float, torque: float = 0.5) -> float:
    """Time [s] in which a torque turns a wheel by an angle from rest."""
    return math.sqrt(2.0 * 2.0 * angle / torque)


def test_the_motors_work_up_to_a_latching_is_torque_times_lock_angle_and_no_more() -> None:
    simulation = with_step(Mechanism((wheel("a"),), (pin("a", lock_angle=0.02),)), 0.5)
    simulation.set_motor_torque(0, 0.5)
    attempt(simulation, 3.0)
    assert simulation.time == pytest.approx(spun_up(0.02), rel=CHORD)
    assert simulation.state.joints["latch_time"][0] == simulation.time
    assert m.joint_integrals(simulation.state.integrals)[0, m.MOTOR_WORK] == pytest.approx(0.5 * 0.02, rel=CHORD)
    assert simulation.joint_loads()[0, ANGLE] == pytest.approx(0.02, rel=1e-9)


@pytest.mark.parametrize("sign", [1, -1])
def test_a_stow_stop_sets_in_at_its_face_and_is_not_felt_before(sign: int) -> None:
    simulation = with_step(Mechanism((wheel("a"),), (pin("a", stow_angle=0.0, sign=sign),)), 1.0)
    simulation.set_motor_torque(0, -0.5)
    attempt(simulation, 3.0)
    own = simulation.state.joints[0]
    assert simulation.time == pytest.approx(spun_up(STOP.gap), rel=CHORD)
    assert (own["stop_engaged"], own["latched"]) == (1, 0)
    assert m.joint_integrals(simulation.state.integrals)[0, m.LATCH_DISSIPATION] == 0.0


LATCHES = (pin("a", lock_angle=0.02), pin("b", lock_angle=0.03))
STOPS = (pin("a", stow_angle=0.0), pin("b", stow_angle=0.0))
MIXED = (pin("a", lock_angle=0.02), pin("b", stow_angle=0.0))


@pytest.mark.parametrize(
    ("joints", "torques", "first", "time"),
    [
        (LATCHES, (0.5, 0.5), 0, spun_up(0.02)),
        (LATCHES[::-1], (0.5, 0.5), 1, spun_up(0.02)),
        (STOPS, (-0.5, -1.0), 1, spun_up(STOP.gap, 1.0)),
        (STOPS, (-1.0, -0.5), 0, spun_up(STOP.gap, 1.0)),
        # The latch is twice as far as the stop, and reached with torques of twice or half as much a unit of way.
        (MIXED, (4.0, -1.0), 0, None),
        (MIXED, (1.0, -1.0), 1, None),
    ],
)
def test_of_two_latchings_or_stow_stops_within_a_step_the_earlier_one_ends_it(
    joints: tuple[Joint, Joint], torques: tuple[float, float], first: int, time: float | None
) -> None:
    simulation = with_step(Mechanism((wheel("a"), wheel("b")), joints), 1.0)
    for k, torque in enumerate(torques):
        simulation.set_motor_torque(k, torque)
    attempt(simulation, 3.0)
    own = simulation.state.joints
    columns = ["stop_engaged" if joint.lock_angle is None else "latched" for joint in joints]
    assert [own[column][k] for k, column in enumerate(columns)] == [k == first for k in range(2)]
    assert time is None or simulation.time == pytest.approx(time, rel=CHORD)


@pytest.mark.parametrize("angles", [(0.02, 0.03), (0.02, 0.02)], ids=["one after the other", "at one instant"])
def test_latchings_all_happen_in_their_time(angles: tuple[float, float]) -> None:
    joints = tuple(pin(name, lock_angle=angle) for name, angle in zip("ab", angles, strict=True))
    simulation = Simulation(Mechanism((wheel("a"), wheel("b")), joints), UNCONTROLLED)
    for k in range(2):
        simulation.set_motor_torque(k, 0.5)
    simulation.advance(0.6)
    assert simulation.state.clock["latched_joints"][0] == simulation.state.joints["latched"].sum() == 2
    assert simulation.state.joints["latch_time"] == pytest.approx([spun_up(angle) for angle in angles], rel=CHORD)


@pytest.mark.parametrize(("angle", "lock_angle"), [(0.0, 0.0), (0.5, 0.3)], ids=["at it", "beyond it"])
def test_a_joint_that_starts_at_its_lock_angle_or_beyond_latches_at_once(angle: float, lock_angle: float) -> None:
    mechanism = Mechanism((wheel("a", angle=angle),), (pin("a", lock_angle),))
    beyond = angle > lock_angle
    with pytest.warns(SimulationWarning, match="0.19 rad deep in its latch") if beyond else contextlib.nullcontext():
        simulation = with_step(mechanism, 0.1)
    attempt(simulation, 3.0)
    assert simulation.state.joints["latched"][0] == 1
    assert simulation.state.joints["latch_time"][0] == 0.0


def flight_and_wheel(speed: float, lock_angle: float) -> Mechanism:
    """A block that flies towards its bearing's wall and a wheel that is turned to its latch."""
    gap = block((speed, 0.0))
    return Mechanism((*gap.bodies, wheel("a")), (*gap.joints, pin("a", lock_angle=lock_angle)))


@pytest.mark.parametrize("first", ["contact", "latching"])
@pytest.mark.parametrize("order", [1, -1], ids=["contact's joint first", "latch's joint first"])
def test_of_a_contact_and_a_latching_within_a_step_the_earlier_one_ends_it(first: str, order: int) -> None:
    contact, latching = (0.2, 0.4) if first == "contact" else (0.4, 0.2)
    whole = flight_and_wheel(CLEARANCE / contact, 0.5 * latching**2 / 4.0)
    simulation = with_step(replace(whole, joints=whole.joints[::order]), 1.0)
    joints = simulation.state.joints[::order]
    simulation.set_motor_torque(1 if order == 1 else 0, 0.5)
    attempt(simulation, 1.0)
    assert simulation.time == pytest.approx(0.2, rel=CHORD)
    assert (joints["in_contact"][0], joints["latched"][1]) == ((1, 0) if first == "contact" else (0, 1))


@pytest.mark.parametrize("widths", [(1e-3, 2e-3), (2e-3, 1e-3)])
def test_a_journal_meets_the_narrower_of_two_bearings_first(widths: tuple[float, float]) -> None:
    simulation = with_step(towards_walls(*widths), 1.0)
    attempt(simulation, 1.0)
    assert simulation.state.joints["in_contact"].tolist() == [width == 1e-3 for width in widths]
    assert simulation.time == pytest.approx(1e-3 / 0.3, rel=1e-12)
    assert simulation.state.joints["contact_start"].max() == simulation.time


@pytest.mark.parametrize("resolution", [14.1, 14.34, 14.6, 15.0, 15.2, 15.5, 15.8])
def test_a_peak_is_found_wherever_in_its_step_it_lies(resolution: float) -> None:
    """A linear contact is half a period of a spring, the peak in its middle: after half of so many steps."""
    stiffness, speed = 1e6, 0.3
    bearing = Bearing(CLEARANCE, 0.01, PowerLaw(stiffness, 1.0))
    simulation = Simulation(block((speed, 0.0), bearing=bearing), RungeKutta(rtol=1e-4, impact_resolution=resolution))
    simulation.advance(CLEARANCE / speed + 4e-3)
    assert not simulation.state.joints["in_contact"][0]
    # The steps lose 4e-6; samples of them alone would miss up to 8e-5.
    assert simulation.state.joints["peak_force"][0] == pytest.approx(speed * math.sqrt(stiffness), rel=5e-6)


def test_wear_follows_the_sliding_work_through_the_events_of_other_joints() -> None:
    """A block slides in its bearing while a wheel latches, which cuts a step."""
    bearing = Bearing(
        CLEARANCE,
        0.01,
        PowerLaw(1e6, damping=0.2),
        friction_coefficient=0.1,
        wear_coefficient=1e-6,
        width=0.5,
    )
    sliding = block((0.0, 0.2), bearing=bearing, position=(CLEARANCE + 1e-5, 0.0), spin=1.0)
    mechanism = Mechanism(
        (*sliding.bodies, wheel("a")), (*sliding.joints, pin("a", lock_angle=0.5e-6)), gravity=(1.0, 0.0), wear_bins=8
    )
    simulation = Simulation(mechanism)
    simulation.set_motor_torque(1, 0.5)
    simulation.advance(0.004)
    assert simulation.state.joints["latched"][1] == 1
    work = m.joint_integrals(simulation.state.integrals)[0, m.SLIDING_WORK]
    section = simulation.state.wear_journal[0].sum() * 0.01 * 2.0 * math.pi / 8.0
    assert work > 0.0
    assert section * 0.5 == pytest.approx(1e-6 * work, rel=1e-9)


def test_the_interpolants_meet_values_and_derivatives_at_both_ends() -> None:
    def polynomial(s: float) -> np.ndarray:
        return np.array([s**k for k in range(6)])

    def slope(s: float) -> np.ndarray:
        return np.array([k * s ** max(k - 1, 0) for k in range(6)])

    def bend(s: float) -> np.ndarray:
        return np.array([k * (k - 1) * s ** max(k - 2, 0) for k in range(6)])

    for s in np.linspace(0.0, 1.0, 11):
        quintic = np.array(quintic_weights(s))
        data = np.stack([polynomial(0.0), slope(0.0), bend(0.0), polynomial(1.0), slope(1.0), bend(1.0)])
        assert quintic @ data == pytest.approx(polynomial(s), abs=1e-14)
        cubic = np.array(cubic_weights(s))
        data = np.stack([polynomial(0.0), slope(0.0), polynomial(1.0), slope(1.0)])[:, :4]
        assert cubic @ data == pytest.approx(polynomial(s)[:4], abs=1e-14)


def test_the_lengths_of_bodies_do_not_drift() -> None:
    simulation = Simulation(floating_pair(), RungeKutta(rtol=1e-4))
    simulation.advance(20.0)
    for k, length in enumerate((1.0, 1.5)):
        d = simulation.state.q[4 * k + 2 : 4 * k + 4] - simulation.state.q[4 * k : 4 * k + 2]
        assert math.hypot(*d) == pytest.approx(length, abs=1e-9)


def mid_run() -> Simulation:
    """A deployment caught in a contact."""
    simulation = single_steps(build(ArrayParameters()), RungeKutta(rtol=1e-5))
    while simulation.state.clock["steps"][0] < 300 or not simulation.state.joints["in_contact"].any():
        attempt(simulation, 1.0)
    return simulation


def test_a_step_depends_on_nothing_but_the_accepted_state_and_its_size() -> None:
    simulation = mid_run()
    model, state = simulation.model, simulation.state
    h = 1e-5

    def step(*rejected: float) -> tuple[bytes, ...]:
        arrays = make_stage_arrays(model, state)
        stages = arrays.stages
        assert refresh(model, state, stages, arrays.work)
        stages.velocity[0] = state.v
        for tried in (*rejected, h):
            assert take_stages(model, state, arrays, tried)
        return tuple(array.tobytes() for array in (stages.q, stages.v, stages.gain, stages.acceleration, stages.power))

    alone = step()
    before = fingerprint(state, skip=("clock", "multipliers"))
    assert alone == step(7 * h) == step(0.01, 1e-9, 3.0)
    assert fingerprint(state, skip=("clock", "multipliers")) == before


def test_a_journal_driven_through_its_bearing_is_reported_not_followed() -> None:
    bearing = Bearing(1e-3, 0.01, PowerLaw(10.0))
    with pytest.raises(SimulationError, match=r"joint 1 sank 0\.0\d+ m into its bearing") as caught:
        simulate(block((0.3, 0.0), bearing=bearing), 1.0)
    assert caught.value.reason == "penetration"
    assert 0.0 < caught.value.time < 1.0


def test_a_joint_turned_past_the_range_of_its_angle_is_reported() -> None:
    simulation = Simulation(pendulum())
    simulation.set_motor_torque(0, 100.0)
    with pytest.raises(SimulationError, match=r"angle of joint 1 reached -?\d\.\d+ rad") as caught:
        simulation.advance(10.0)
    assert caught.value.reason == "joint_angle"
