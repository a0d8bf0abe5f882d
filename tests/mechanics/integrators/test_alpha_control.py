"""Adaptive steps of generalized-alpha: how they grow, what is refused, and how they meet a wall."""

from __future__ import annotations

import math
from functools import cache
from typing import Any

import pytest
from helpers import attempt, single_steps
from mechanisms import block, pendulum, towards_walls

from solar_env.mechanics.integrators.settings import GeneralizedAlpha, RungeKutta, alpha_coefficients
from solar_env.mechanics.joints.joint import penetration
from solar_env.mechanics.joints.laws import PowerLaw
from solar_env.mechanics.mechanism.description import Bearing, Mechanism
from solar_env.mechanics.running.simulation import Simulation

SPEED, CLEARANCE = 0.3, 1e-3
FLIGHT = CLEARANCE / SPEED


def alpha(mechanism: Mechanism, **settings: Any) -> Simulation:
    return single_steps(mechanism, GeneralizedAlpha(**{"rtol": 1e-4, "max_step": 1.0, **settings}))


def take_step(simulation: Simulation, end: float) -> None:
    """Try steps until one is accepted."""
    start = simulation.time
    while simulation.time == start:
        attempt(simulation, end)


def steps_of(simulation: Simulation, count: int, end: float = 100.0) -> list[float]:
    """Sizes of the next steps that are accepted."""
    sizes = []
    for _ in range(count):
        start = simulation.time
        take_step(simulation, end)
        sizes.append(simulation.time - start)
    return sizes


def test_in_free_flight_steps_double_from_the_one_asked_for_up_to_their_bound() -> None:
    simulation = alpha(block((1e-5, 0.0)), step=1e-3, max_step=0.01)
    assert steps_of(simulation, 6) == pytest.approx([1e-3, 2e-3, 4e-3, 8e-3, 0.01, 0.01], rel=1e-12)
    assert simulation.state.clock["rejected_steps"][0] == 0


@pytest.mark.parametrize(
    ("end", "steps"),
    [(0.008, [0.008]), (0.01, [0.01]), (0.013, [0.0065, 0.0065]), (0.025, [0.01, 0.0075, 0.0075])],
)
def test_a_call_ends_with_two_even_steps_rather_than_with_a_sliver(end: float, steps: list[float]) -> None:
    simulation = alpha(block((1e-5, 0.0)), step=0.01, max_step=0.01)
    assert steps_of(simulation, len(steps), end) == pytest.approx(steps, rel=1e-12)
    assert simulation.time == end


STIFFNESS, STEP = 1e6, 1e-4


@cache
def in_contact() -> Simulation:
    """A block of 1 kg on a linear spring, half a millisecond after it struck the wall, by the explicit method."""
    linear = Bearing(CLEARANCE, 0.01, PowerLaw(STIFFNESS, 1.0))
    simulation = Simulation(block((SPEED, 0.0), bearing=linear), RungeKutta(rtol=1e-10))
    simulation.advance(FLIGHT + 5e-4)
    assert simulation.state.joints["in_contact"][0]
    return simulation


def first_step(rtol: float, rho: float = 1.0) -> Simulation:
    """The block after its next accepted step, in a simulation whose time began with 0."""
    linear = Bearing(CLEARANCE, 0.01, PowerLaw(STIFFNESS, 1.0))
    simulation = alpha(block((SPEED, 0.0), bearing=linear), step=STEP, rtol=rtol, rho_inf=rho, velocity_scale=0.5)
    simulation.restore(in_contact().snapshot())
    clock = simulation.state.clock
    simulation.state.joints["contact_start"] -= clock["time"]
    clock["time"], clock["step_size"], clock["acceleration_current"] = 0.0, 0.0, 0
    clock["steps"], clock["rejected_steps"] = 0, 0
    take_step(simulation, 10.0)
    return simulation


@cache
def passing_tolerance(rho: float = 1.0) -> float:
    """Tolerance that the error of the step just meets, from the growth of 0.9 over the root of the error."""
    rtol = 0.1
    while not 1.5 * STEP < (grown := first_step(rtol, rho).state.clock["step_size"][0]) < 1.99 * STEP:
        rtol /= 1.5
    return float(rtol * (0.9 * STEP / grown) ** 2)


def test_the_error_of_a_step_is_that_of_its_coordinates_per_unit_of_time() -> None:
    # The trapezoidal rule's accelerations are those of its instants: a coordinate is off by h^3/12 of the jerk, here
    # minus the stiffness times the speed, for 1 kg.
    speed = SPEED * math.cos(math.sqrt(STIFFNESS) * 5e-4)
    expected = STEP**2 / 12.0 * STIFFNESS * speed / (0.5 + speed)
    assert passing_tolerance() == pytest.approx(expected, rel=0.05)


@pytest.mark.parametrize("rho", [0.0, 0.3, 0.8])
def test_the_error_goes_with_how_far_beta_is_from_a_sixth(rho: float) -> None:
    beta = alpha_coefficients(rho)[2]
    assert passing_tolerance(rho) == pytest.approx(12.0 * (beta - 1.0 / 6.0) * passing_tolerance(), rel=0.05)


def test_a_step_that_is_refused_passes_the_second_time_with_what_is_left_for_safety() -> None:
    for refused in (1.1, 1.5, 4.0):
        simulation = first_step(passing_tolerance() / refused)
        clock = simulation.state.clock[0]
        assert clock["rejected_steps"] == 1
        # The error goes with the second power of the step.
        assert simulation.time == pytest.approx(STEP * 0.9 / math.sqrt(refused), rel=1e-6)
    accepted = first_step(passing_tolerance() / 0.9)
    assert (accepted.time, accepted.state.clock["rejected_steps"][0]) == (STEP, 0)


def test_a_step_far_too_long_is_tried_again_at_a_fifth() -> None:
    simulation = first_step(passing_tolerance() / 200.0)
    # 200 at first, 8 at a fifth, below 1 at 0.9 / sqrt(8) of that.
    assert simulation.state.clock["rejected_steps"][0] == 2
    assert simulation.time == pytest.approx(0.2 * STEP * 0.9 / math.sqrt(8.0), rel=0.02)


@pytest.mark.parametrize("share", [0.1, 0.21, 0.3, 0.4, 0.7])
def test_a_step_grows_where_that_gains_half_as_much_again_and_is_kept_else(share: float) -> None:
    simulation = first_step(passing_tolerance() / share)
    growth = min(0.9 / math.sqrt(share), 2.0)
    assert simulation.time == STEP
    assert simulation.state.clock["step_size"][0] == pytest.approx(STEP * growth if growth > 1.5 else STEP, rel=1e-9)


def test_a_step_whose_equations_are_not_solved_is_tried_again_at_a_quarter() -> None:
    simulation = alpha(pendulum(), step=1.0, rtol=0.1, velocity_scale=1e9)
    simulation.set_motor_torque(0, 300.0)
    take_step(simulation, 10.0)
    refused = simulation.state.clock["rejected_steps"][0]
    assert refused > 0
    assert simulation.time == 0.25**refused


@pytest.mark.parametrize("clearances", [(CLEARANCE,), (1.0, CLEARANCE), (CLEARANCE, 1.0), (0.0, CLEARANCE)])
def test_a_step_that_would_pass_the_wall_ends_on_it_and_the_next_ones_resolve_the_impact(
    clearances: tuple[float, ...],
) -> None:
    simulation = alpha(towards_walls(*clearances), step=2.5 * FLIGHT)
    (flight,) = steps_of(simulation, 1)
    joint = clearances.index(CLEARANCE)
    assert flight == pytest.approx(FLIGHT, rel=1e-9)
    model, state = simulation.model, simulation.state
    assert abs(penetration(model.joints[joint], model.markers, state.q, state.v)[0]) < 1e-12
    steps = []
    while not steps or state.joints["in_contact"][joint]:
        steps += steps_of(simulation, 1)
    own = state.joints[joint]
    assert own["contact_starts"] == 1
    assert own["contact_start"] == pytest.approx(FLIGHT, rel=1e-9)
    assert max(steps[:-1]) <= own["contact_duration"] / 24.0 * (1.0 + 1e-9)
    # Half a sine lasts as long as the duration that was predicted, or a little longer.
    assert len(steps) > 24


@pytest.mark.parametrize(
    ("step", "taken", "rejected"), [(1.5, 0.75, 1), (0.9, 0.9, 0)], ids=["by less than half of it", "not at all"]
)
def test_a_step_that_passes_the_wall_a_little_is_halved_first(step: float, taken: float, rejected: int) -> None:
    simulation = alpha(towards_walls(CLEARANCE), step=step * FLIGHT)
    assert steps_of(simulation, 1) == pytest.approx([taken * FLIGHT], rel=1e-12)
    assert simulation.state.clock["rejected_steps"][0] == rejected


def test_of_two_walls_within_a_step_the_nearer_one_ends_it() -> None:
    for clearances in ((CLEARANCE, 1.5 * CLEARANCE), (1.5 * CLEARANCE, CLEARANCE)):
        simulation = alpha(towards_walls(*clearances), step=4.0 * FLIGHT)
        assert steps_of(simulation, 1) == pytest.approx([FLIGHT], rel=1e-9)
