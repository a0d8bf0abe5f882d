"""The explicit Runge-Kutta method: order, error control, latching, and what a rejected or failed step leaves."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from helpers import attempt, fingerprint, orders, single_steps
from mechanisms import Vector, block, floating_pair, pendulum, rotor

from solar_env.array import ArrayParameters, build
from solar_env.mechanics.arrays.columns import ANGLE
from solar_env.mechanics.integrators.methods.runge_kutta import make_runge_kutta_arrays, take_stages
from solar_env.mechanics.integrators.methods.stages import cubic_weights, quintic_weights, refresh
from solar_env.mechanics.integrators.settings import RungeKutta
from solar_env.mechanics.joints.contact.power_law import PowerLaw
from solar_env.mechanics.mechanism.description import Bearing, Mechanism
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
        arrays = make_runge_kutta_arrays(model, state)
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
