"""Steps of the adaptive methods at impacts: their start at the wall, their peaks, and many at once."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from helpers import attempt, single_steps
from mechanisms import block, towards_walls

from solar_env.array import ArrayParameters, build
from solar_env.mechanics.integrators.settings import Rosenbrock, RungeKutta
from solar_env.mechanics.joints.joint import penetration
from solar_env.mechanics.joints.laws import PowerLaw
from solar_env.mechanics.mechanism.description import Bearing, Point
from solar_env.mechanics.mechanism.textbook import bouncing_block
from solar_env.mechanics.running.errors import SimulationError
from solar_env.mechanics.running.simulation import Simulation, simulate

# Nothing is ever rejected: the step is max_step.
UNCONTROLLED = RungeKutta(rtol=0.1, velocity_scale=1e9)


def depth_of(simulation: Simulation) -> tuple[float, float]:
    """Penetration and its rate of the first joint."""
    model, state = simulation.model, simulation.state
    return penetration(model.joints[0], model.markers, state.q, state.v)


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
        # One after a latching counts as such.
        latched = speed > 0.03
        simulation.state.clock["latched_joints"] = int(latched)
        simulation.advance((clearance + 5.0 * deepest) / speed)
        assert not simulation.state.joints["in_contact"][0]
        for peak in ("contact_peak", "peak_force", "recent_peak_force"):
            assert simulation.state.joints[peak][0] == pytest.approx(stiffness * deepest**1.5, rel=error)
        assert simulation.state.joints["postlock_peak_force"][0] == latched * simulation.state.joints["peak_force"][0]


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


def test_a_thousand_further_impacts_at_one_instant_are_followed_but_not_more() -> None:
    # A block whose journals strike the walls of as many bearings at one instant.
    followed, piled_up = (Simulation(towards_walls(*[1e-3] * count)) for count in (1001, 1002))
    instant = 1e-3 / 0.3
    followed.advance(instant + 1e-9)
    assert followed.state.joints["in_contact"].all()
    with pytest.raises(SimulationError, match=r"joint 1002 strikes, .* without time going on \(1001 times\)") as caught:
        piled_up.advance(instant + 1e-9)
    assert caught.value.reason == "events"
    assert caught.value.time == piled_up.time == pytest.approx(instant, rel=1e-12)
    assert piled_up.state.joints["in_contact"].sum() == 1001
