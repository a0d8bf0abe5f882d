"""The explicit Runge-Kutta method: order, error control, events on its interpolant, and what a rejected step leaves."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from helpers import (
    Vector,
    attempt,
    block,
    fingerprint,
    floating_pair,
    orders,
    pendulum,
    rotor,
    single_steps,
)

from solar_env.array import ArrayParameters, build
from solar_env.mechanics.integrators.methods.runge_kutta import make_runge_kutta_arrays, take_stages
from solar_env.mechanics.integrators.settings import Rosenbrock, RungeKutta
from solar_env.mechanics.integrators.step import cubic_weights, quintic_weights, refresh
from solar_env.mechanics.joints.contact.power_law import PowerLaw
from solar_env.mechanics.joints.joint import ANGLE, penetration
from solar_env.mechanics.mechanism.description import GROUND, Bearing, Body, Joint, Mechanism, Point
from solar_env.mechanics.mechanism.textbook import bouncing_block
from solar_env.mechanics.running.errors import SimulationError
from solar_env.mechanics.running.simulation import Simulation, simulate

# Nothing is ever rejected: the step is max_step.
UNCONTROLLED = RungeKutta(rtol=0.1, velocity_scale=1e9)


def with_step(mechanism: Mechanism, step: float, integrator: RungeKutta = UNCONTROLLED) -> Simulation:
    """A simulation whose next steps have a given size."""
    simulation = Simulation(mechanism, replace(integrator, max_step=step))
    simulation.state.clock["step_size"] = step
    simulation.state.clock["last_error"] = 1.0
    return simulation


def end_state(mechanism: Mechanism, end: float, steps: int, motor: float = 0.0) -> Vector:
    simulation = with_step(mechanism, end / steps * (1 + 1e-12))
    simulation.set_motor_torque(0, motor)
    simulation.advance(end)
    assert simulation.state.clock["steps"][0] == steps
    assert simulation.state.clock["rejected_steps"][0] == 0
    return np.concatenate([simulation.state.q, simulation.state.v, simulation.state.integrals])


def depth_of(simulation: Simulation) -> tuple[float, float]:
    """Penetration and its rate of the first joint."""
    model, state = simulation.model, simulation.state
    return penetration(model.joints[0], model.markers, state.q, state.v)


@pytest.mark.parametrize("mechanism", [floating_pair(), pendulum()], ids=["free bodies", "constrained and projected"])
def test_the_method_is_of_order_four(mechanism: Mechanism) -> None:
    end, motor = 1.0, 0.4
    reference = end_state(mechanism, end, 5120, motor)
    # Work of the motor included.
    errors = [np.abs(end_state(mechanism, end, n, motor) - reference).max() for n in (40, 80, 160, 320)]
    # The projected pendulum comes down to four from above.
    assert np.all((orders(errors) > 3.8) & (orders(errors) < 4.4))


def test_a_tighter_tolerance_gives_a_smaller_error_at_more_steps() -> None:
    errors, steps = [], []
    reference = end_state(floating_pair(), 3.0, 6000)
    for rtol in (1e-4, 1e-6, 1e-8):
        simulation = Simulation(floating_pair(), RungeKutta(rtol=rtol))
        simulation.advance(3.0)
        errors.append(np.abs(np.concatenate([simulation.state.q, simulation.state.v]) - reference[:16]).max())
        steps.append(int(simulation.state.clock["steps"][0]))
    # The error of a step is of order h^4 in its estimate, that of the run of order h^4: proportional to the tolerance.
    assert errors[0] > 10 * errors[1] > 100 * errors[2]
    assert steps[0] < steps[1] < steps[2]
    assert errors[2] < 1e-7


def test_the_end_time_is_met_to_the_last_bit() -> None:
    simulation = Simulation(floating_pair(), RungeKutta(rtol=1e-3))
    # Start + (end - start) is not always the end.
    for end in np.cumsum(np.random.default_rng(0).uniform(1e-9, 0.05, 300)):
        simulation.advance(end)
        assert simulation.time == end


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


def until_contact(simulation: Simulation, end: float) -> None:
    while not simulation.state.joints["in_contact"][0]:
        assert not attempt(simulation, end), "no contact began"


@pytest.mark.parametrize("spin", [0.0, 3.0])
@pytest.mark.parametrize("position", [(0.0, 0.0), (-3e-4, 8e-4)])
def test_an_impact_starts_at_the_wall_with_the_speed_of_the_approach(spin: float, position: Point) -> None:
    # A pin off the centroid of a spinning block: its path is curved.
    journal = (0.02, -0.01)
    start = (position[0] - journal[0], position[1] - journal[1])
    mechanism = block((0.05, 0.2), position=start, gravity=(0.0, -9.81), spin=spin, journal=journal)
    simulation = single_steps(mechanism, RungeKutta())
    simulation.state.clock["step_size"] = 0.1  # far past the wall
    until_contact(simulation, 0.1)
    depth, rate = depth_of(simulation)
    assert abs(depth) < 1e-12
    assert simulation.state.joints["impact_speed"][0] == rate
    assert simulation.state.joints["contact_start"][0] == simulation.time
    # The same flight in closed form.
    t = simulation.time
    angle = spin * t
    pin = np.array(start) + np.array([0.05, 0.2]) * t + np.array([0.0, -0.5 * 9.81]) * t * t
    pin += [
        journal[0] * math.cos(angle) - journal[1] * math.sin(angle),
        journal[0] * math.sin(angle) + journal[1] * math.cos(angle),
    ]
    # Rates enter the flight at the integrator's tolerance, 1e-6 of the body's length of 1 m at most.
    assert math.hypot(*pin) == pytest.approx(1e-3, abs=1e-9)


def test_the_time_and_speed_of_an_impact_in_straight_flight_are_exact() -> None:
    contacts = simulate(block((0.3, 0.0)), 0.01).contacts
    assert contacts["start_s"][0] == pytest.approx(1e-3 / 0.3, rel=1e-12)
    assert contacts["impact_speed"][0] == pytest.approx(0.3, rel=1e-12)


def test_an_approach_slower_than_the_bound_starts_with_the_bound() -> None:
    bearing = Bearing(1e-3, 0.01, PowerLaw(1e9, damping=0.2), minimum_impact_speed=0.05)
    contacts = simulate(block((0.01, 0.0), bearing=bearing), 0.12).contacts
    assert contacts["impact_speed"][0] == 0.05


@pytest.mark.parametrize("overshoot", [1e-4, 1e-7])
def test_a_graze_inside_a_step_is_not_missed(overshoot: float) -> None:
    # Thrown up so as to pass the wall by a share of the clearance, and down again: both ends of the step are free.
    clearance, gravity = 1e-3, 9.81
    speed = math.sqrt(2 * gravity * clearance * (1 + overshoot))
    top = speed / gravity
    simulation = single_steps(block((0.0, speed), gravity=(0.0, -gravity)), UNCONTROLLED)
    # The top comes at the middle of the step.
    simulation.state.clock["step_size"] = 2.0 * top
    until_contact(simulation, 2.0 * top)
    assert abs(depth_of(simulation)[0]) < 1e-12
    expected = (speed - math.sqrt(speed**2 - 2 * gravity * clearance)) / gravity
    # A height known to rounding gives the time to sqrt of it near the top.
    assert simulation.time == pytest.approx(expected, abs=2e-16 / math.sqrt(overshoot * clearance) + 1e-12)
    assert simulation.state.clock["steps"][0] == 1


def test_a_path_that_turns_back_before_the_wall_touches_nothing() -> None:
    speed = math.sqrt(2 * 9.81 * 1e-3 * (1 - 1e-9))
    run = simulate(block((0.0, speed), gravity=(0.0, -9.81)), speed / 9.81 * 1.5)
    assert len(run.contacts) == 0


def test_an_impact_gets_as_many_steps_as_asked() -> None:
    for resolution in (5.0, 20.0):
        simulation = single_steps(block((0.3, 0.0)), RungeKutta(impact_resolution=resolution, rtol=1e-3))
        until_contact(simulation, 1.0)
        own = simulation.state.joints[0]
        start, duration = own.contact_start, own.contact_duration
        steps = 0
        while simulation.time < start + duration:
            attempt(simulation, 1.0)
            steps += 1
        assert steps >= resolution


@pytest.mark.parametrize(("integrator", "error"), [(RungeKutta(), 5e-5), (Rosenbrock(), 1e-4)], ids=["1e-6", "1e-4"])
def test_the_peak_of_an_impact_is_found_between_the_steps(integrator: RungeKutta, error: float) -> None:
    mass, clearance, stiffness = 6.0, 2e-4, 7.39e10
    for speed in np.logspace(-3.0, 0.0, 20):
        simulation = Simulation(bouncing_block(Bearing(clearance, 0.01, PowerLaw(stiffness)), mass, speed), integrator)
        # Without damping all the energy of the approach is in the contact when the journal is deepest.
        deepest = (1.25 * mass * speed**2 / stiffness) ** 0.4
        simulation.advance((clearance + 5.0 * deepest) / speed)
        assert not simulation.state.joints["in_contact"][0]
        for peak in ("contact_peak", "peak_force", "recent_peak_force"):
            assert simulation.state.joints[peak][0] == pytest.approx(stiffness * deepest**1.5, rel=error)
        assert simulation.state.joints["postlock_peak_force"][0] == 0.0


@pytest.mark.parametrize("step", [0.01, 0.5, 10.0])
def test_a_latching_is_found_whatever_the_step(step: float) -> None:
    # angle = torque t^2 / (2 inertia)
    torque, lock = 0.5, 1.0
    simulation = with_step(rotor(lock), step)
    simulation.set_motor_torque(0, torque)
    simulation.advance(3.0)
    # The angle is quadratic in time, but its coordinates run on a circle: exact to the steps' error of order h^4.
    tolerance = 1e-10 if step < 0.1 else 2e-3
    assert simulation.state.joints["latch_time"][0] == pytest.approx(math.sqrt(2 * 2.0 * lock / torque), rel=tolerance)
    assert simulation.state.joints["latched"][0] == 1
    assert simulation.state.clock["latched_joints"][0] == 1


def test_a_latched_joint_stays_at_its_angle() -> None:
    simulation = Simulation(rotor(1.0))
    simulation.set_motor_torque(0, 0.5)
    simulation.advance(30.0)
    # The torque presses the joint against the far face: 1 + 0.01 + 0.5 / 100.
    assert simulation.joint_loads()[0, ANGLE] == pytest.approx(1.015, abs=1e-6)


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
        work, _, stages, own = make_runge_kutta_arrays(model, state)
        assert refresh(model, state, stages, work)
        stages.velocity[0] = state.v
        for tried in (*rejected, h):
            assert take_stages(model, state, stages, own.stiff, work, tried)
        return tuple(array.tobytes() for array in (stages.q, stages.v, stages.gain, stages.acceleration, stages.power))

    alone = step()
    before = fingerprint(state, skip=("clock", "multipliers"))
    assert alone == step(7 * h) == step(0.01, 1e-9, 3.0)
    assert fingerprint(state, skip=("clock", "multipliers")) == before


def test_a_failed_call_raises_with_its_time_and_keeps_the_last_accepted_state() -> None:
    simulation = mid_run()
    simulation.set_motor_torque(0, 1e308)
    before = fingerprint(simulation.state, skip=("clock", "multipliers", "a", "power"))
    simulation.integrator = RungeKutta(rtol=1e-5)
    with pytest.raises(SimulationError, match=r"at t = [0-9.]+ s the state is no longer finite") as caught:
        simulation.advance(1.0)
    assert caught.value.reason == "not_finite"
    assert caught.value.time == simulation.time
    assert fingerprint(simulation.state, skip=("clock", "multipliers", "a", "power")) == before


def test_a_run_that_outgrows_its_bound_of_steps_says_so_and_can_go_on() -> None:
    bounded = Simulation(build(ArrayParameters()), RungeKutta(max_steps=50))
    with pytest.raises(SimulationError, match=r"50 steps were taken in one call .* raise max_steps") as caught:
        bounded.advance(1.0)
    assert caught.value.reason == "steps"
    bounded.integrator = RungeKutta()
    bounded.advance(1.0)
    whole = Simulation(build(ArrayParameters()))
    whole.advance(1.0)
    assert fingerprint(bounded.state, skip=("clock",)) == fingerprint(whole.state, skip=("clock",))


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


@pytest.mark.parametrize(
    "changes",
    [
        {"rtol": 0.0},
        {"rtol": 0.2},
        {"rtol": math.nan},
        {"velocity_scale": 0.0},
        {"velocity_scale": math.nan},
        {"max_step": -1.0},
        {"max_step": 0.0},
        {"impact_resolution": 0.0},
        {"max_steps": 0},
        {"max_steps": math.nan},
        {"velocity_scale": math.inf},
        {"impact_resolution": math.inf},
    ],
)
def test_settings_without_sense_are_refused_by_name_and_value(changes: dict[str, Any]) -> None:
    ((name, value),) = changes.items()
    with pytest.raises(ValueError, match=f"{name} = {value!r}"):
        RungeKutta(**changes)


def test_a_journal_that_leaves_the_very_wall_and_comes_back_in_one_step_does_not_stop_time() -> None:
    # Powers of two keep it on the wall to the last bit; gravity brings it back within the first, long step.
    clearance = 2.0**-12
    parameters = ArrayParameters(panel_count=1, body_fixed=True, clearance=clearance, spring_stiffness=0.0)
    mechanism = replace(build(parameters, "rigid-clearance"), gravity=(1.0, 0.0))
    simulation = Simulation(mechanism, RungeKutta(rtol=1e-4, max_steps=500))
    state = simulation.state
    state.q[4::2] += clearance
    state.v[4::2] = -1e-6
    state.clock["step_size"], state.clock["last_error"] = 1e-2, 1.0
    simulation.advance(0.01)
    assert simulation.time == 0.01
    assert state.joints["contact_starts"][0] < 10


def side_by_side(bearings: int) -> Simulation:
    """A block whose journals strike the walls of as many bearings at one instant."""
    bearing = Bearing(1e-3, 0.01, PowerLaw(1e9, damping=0.2))
    body = Body("block", 1.0, 0.1, 1.0, (0.0, 0.0), velocity=(0.3, 0.0))
    pins = [Joint(f"{k}", GROUND, "block", (0.0, 0.0), (0.0, 0.0), bearing=bearing) for k in range(bearings)]
    return Simulation(Mechanism((body,), tuple(pins)))


def test_a_thousand_further_impacts_at_one_instant_are_followed_but_not_more() -> None:
    followed, piled_up = side_by_side(1001), side_by_side(1002)
    instant = 1e-3 / 0.3
    followed.advance(instant + 1e-9)
    assert followed.state.joints["in_contact"].all()
    with pytest.raises(SimulationError, match=r"joint 1002 strikes, .* without time going on \(1001 times\)") as caught:
        piled_up.advance(instant + 1e-9)
    assert caught.value.reason == "events"
    assert caught.value.time == piled_up.time == pytest.approx(instant, rel=1e-12)
    assert piled_up.state.joints["in_contact"].sum() == 1001
