"""What steps record: samples inside them, the beginnings of contacts, sliding work and wear."""

from __future__ import annotations

import math

import numpy as np
import pytest
from mechanisms import block, pendulum, rotor
from scipy.interpolate import CubicHermiteSpline

from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.integrators.settings import GeneralizedAlpha, Integrator, RungeKutta
from solar_env.mechanics.joints.laws import PowerLaw
from solar_env.mechanics.mechanism.description import Bearing
from solar_env.mechanics.records.recording import Recorder, make_recorder, sample_columns
from solar_env.mechanics.running.simulation import Simulation

CLEARANCE, SPEED = 1e-3, 0.3


def sampled(simulation: Simulation, times: np.ndarray) -> tuple[Recorder, dict[str, slice]]:
    """Samples of a call that ends with the last of the times."""
    recorder = make_recorder(simulation.model, simulation.state, times, 0)
    simulation.advance(float(times[-1]), recorder)
    assert recorder.filled[0] == times.size
    return recorder, sample_columns(simulation.model, simulation.state)


@pytest.mark.parametrize(
    ("integrator", "steps", "error"),
    [(GeneralizedAlpha(step=1.0), 1, 1e-12), (RungeKutta(rtol=0.1, velocity_scale=1e9), 2, 1e-13)],
    ids=lambda value: getattr(value, "name", None),
)
def test_samples_within_a_long_step_are_those_of_free_fall_at_their_times(
    integrator: Integrator, steps: int, error: float
) -> None:
    # Heights and bearings in powers of two: nothing is lost in rounding.
    wide = Bearing(64.0, 0.01, PowerLaw(1e9))
    simulation = Simulation(block((2.0, 0.0), bearing=wide, gravity=(0.0, -8.0)), integrator)
    if isinstance(integrator, RungeKutta):
        simulation.state.clock["step_size"], simulation.state.clock["last_error"] = 0.75, 1.0
    times = np.array([0.0, 0.0, 0.125, 0.5, 0.75, 1.0, 1.0])
    recorder, columns = sampled(simulation, times)
    assert simulation.state.clock["steps"][0] == steps
    place, speed = recorder.samples[:, columns["q"]][:, :2], recorder.samples[:, columns["v"]][:, :2]
    assert place == pytest.approx(np.stack([2.0 * times, -4.0 * times**2], axis=1), abs=error)
    assert speed == pytest.approx(np.stack([np.full(times.size, 2.0), -8.0 * times], axis=1), abs=error)


def test_between_the_steps_samples_lie_on_the_cubic_through_both_ends() -> None:
    step = 0.02
    simulation = Simulation(pendulum(), GeneralizedAlpha(step=step))
    simulation.advance(0.4)
    state = simulation.state
    q0, v0 = state.q.copy(), state.v.copy()
    recorder, columns = sampled(simulation, 0.4 + step * np.array([0.25, 0.5, 0.75, 1.0]))
    cubic = CubicHermiteSpline([0.4, 0.4 + step], np.stack([q0, state.q]), np.stack([v0, state.v]))
    assert recorder.samples[:, columns["q"]] == pytest.approx(cubic(recorder.times), abs=1e-12)
    assert recorder.samples[:, columns["v"]] == pytest.approx(cubic(recorder.times, 1), abs=1e-11)


@pytest.mark.parametrize(
    ("integrator", "error"), [(GeneralizedAlpha(step=0.1), 1e-3), (RungeKutta(rtol=0.1, velocity_scale=1e9), 1e-4)]
)
def test_samples_of_the_motors_work_within_a_step_grow_with_the_angle(integrator: Integrator, error: float) -> None:
    simulation = Simulation(rotor(3.0), integrator)
    simulation.set_motor_torque(0, 0.5)
    simulation.state.clock["step_size"], simulation.state.clock["last_error"] = 0.1, 1.0
    times = np.linspace(0.0, 0.1, 6)
    recorder, columns = sampled(simulation, times)
    # Angle = torque t^2 / (2 inertia), 2 kg m2.
    work = m.joint_integrals(recorder.samples[:, columns["integrals"]])[:, 0, m.MOTOR_WORK]
    assert work == pytest.approx(0.5 * 0.5 * times**2 / 4.0, rel=error, abs=1e-12)


@pytest.mark.parametrize("end", [5e-3, 7e-3, 20e-3])
def test_a_contact_within_a_step_begins_when_the_straight_path_meets_the_wall(end: float) -> None:
    soft = Bearing(CLEARANCE, 0.01, PowerLaw(1e-6, 1.0))
    simulation = Simulation(block((SPEED, 0.0), bearing=soft), GeneralizedAlpha(step=1.0))
    simulation.advance(1e-3)
    simulation.advance(end)
    own = simulation.state.joints[0]
    assert own["in_contact"]
    assert own["contact_start"] == pytest.approx(CLEARANCE / SPEED, rel=1e-6)
    assert own["impact_speed"] == pytest.approx(SPEED, rel=1e-6)


def test_a_journal_that_begins_inside_the_wall_is_in_contact_from_the_steps_start() -> None:
    soft = Bearing(CLEARANCE, 0.01, PowerLaw(1e-6, 1.0))
    simulation = Simulation(
        block((SPEED, 0.0), bearing=soft, position=(1.5 * CLEARANCE, 0.0)), GeneralizedAlpha(step=1.0)
    )
    simulation.state.joints["in_contact"] = 0
    simulation.advance(1e-3)
    assert simulation.state.joints["contact_start"][0] == 0.0


def test_wear_takes_the_sliding_work_of_the_steps_which_is_the_load_times_the_way() -> None:
    load, speed = 1.0, 0.2
    bearing = Bearing(
        CLEARANCE,
        0.01,
        PowerLaw(1e6, 1.0),
        friction_coefficient=0.1,
        wear_coefficient=1e-6,
        width=0.5,
    )
    mechanism = block((0.0, speed), bearing=bearing, position=(CLEARANCE + load / 1e6, 0.0), gravity=(load, 0.0))
    simulation = Simulation(mechanism, GeneralizedAlpha(step=1e-6))
    end = 5e-5
    simulation.advance(end)
    work = m.joint_integrals(simulation.state.integrals)[0, m.SLIDING_WORK]
    # Within 10 micrometres of its way the wall's curve presses by up to 0.05 N more.
    assert work == pytest.approx(load * speed * end, rel=0.05)
    section = simulation.state.wear_journal[0].sum() * 0.01 * 2.0 * math.pi / simulation.state.wear_journal[0].size
    assert section * 0.5 == pytest.approx(1e-6 * work, rel=1e-9)
