"""Every method of the table: its order, what a rejected step leaves, snapshots, energy, lanes and recording."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from helpers import attempt, fingerprint, orders
from mechanisms import Vector, floating_pair, pendulum, rotor

from solar_env.array import ArrayParameters, build
from solar_env.mechanics.arrays.columns import ANGLE, RATE
from solar_env.mechanics.integrators.methods.table import METHODS, method_of
from solar_env.mechanics.integrators.run import advance_lanes
from solar_env.mechanics.integrators.settings import INTEGRATORS, Integrator, RungeKutta
from solar_env.mechanics.mechanism.description import Mechanism
from solar_env.mechanics.modal.panel.tables import GREATEST_STEP
from solar_env.mechanics.records.recording import make_recorder
from solar_env.mechanics.running.batch import Batch
from solar_env.mechanics.running.simulation import Simulation

every_method = pytest.mark.parametrize("name", METHODS)
# A moment of the array in which its joints strike their bearings often.
IMPACTS = 0.06
# s, 64 of the greatest step that the modal method has tables for, whose steps are halves of it.
END = 64 * GREATEST_STEP
ARRAY = ArrayParameters(clearance=1e-5, spring_stiffness=(5.0, 3.75))


def controlled(name: str) -> Integrator:
    """The method with its error under control."""
    return INTEGRATORS[name](rtol=1e-4)


def at_fixed_step(name: str, mechanism: Mechanism, step: float) -> Simulation:
    """A simulation that takes steps of one size, whatever their error."""
    loose = {"velocity_scale": 1e9} if name == "generalized-alpha" else {"velocity_scale": 1e9, "rtol": 0.1}
    simulation = Simulation(mechanism, INTEGRATORS[name](**loose).with_options(step, None))
    simulation.state.clock["step_size"], simulation.state.clock["last_error"] = step, 1.0
    return simulation


def swing(simulation: Simulation) -> Vector:
    """Angle and rate of the pendulum."""
    return simulation.joint_loads()[0, [ANGLE, RATE]]


def end_of(name: str, steps: int) -> Vector:
    simulation = at_fixed_step(name, pendulum(), END / steps * (1 + 1e-12))
    simulation.advance(END)
    assert simulation.state.clock["steps"][0] == steps
    return swing(simulation)


def test_the_table_has_a_row_for_every_choice_of_settings() -> None:
    assert list(METHODS) == list(INTEGRATORS)
    for name, kind in INTEGRATORS.items():
        assert method_of(kind()) is METHODS[name]
    with pytest.raises(ValueError, match="must be one of RungeKutta"):
        method_of("runge-kutta")


@every_method
def test_a_method_converges_with_the_order_that_its_row_declares(name: str) -> None:
    order = METHODS[name].order
    coarsest = {2: 100, 3: 64, 4: 40}[order]
    exact = Simulation(pendulum(), RungeKutta(rtol=1e-13))
    exact.advance(END)
    errors = [float(np.abs(end_of(name, coarsest * k) - swing(exact)).max()) for k in (1, 2, 4)]
    assert errors[-1] > 1e-13, "lost in rounding"
    assert orders(errors).mean() == pytest.approx(order, abs=0.4)


@every_method
def test_a_rejected_step_leaves_no_trace_in_the_motion_or_its_history(name: str) -> None:
    tried = Simulation(build(ARRAY), controlled(name))
    tried.advance(IMPACTS)
    # Contacts that began long ago do not bound the step.
    tried.state.joints["contact_start"] = -1.0
    before = fingerprint(tried.state, skip=("clock", "multipliers", "a", "algorithmic_a", "power"))
    tried.integrator = replace(tried.integrator, max_steps=1)
    tried.state.clock["step_size"] = 0.5
    rejected, time = tried.state.clock["rejected_steps"][0], tried.time
    attempt(tried, 1.0)
    assert tried.state.clock["rejected_steps"][0] == rejected + 1
    assert tried.time == time
    assert fingerprint(tried.state, skip=("clock", "multipliers", "a", "algorithmic_a", "power")) == before


@every_method
def test_a_restored_snapshot_goes_on_to_the_same_bits(name: str) -> None:
    simulation = Simulation(build(ARRAY), controlled(name))
    simulation.advance(0.5 * IMPACTS)
    kept = simulation.snapshot()
    simulation.advance(IMPACTS)
    there = fingerprint(simulation.state)
    assert simulation.state.joints["contact_starts"].min() > 0
    simulation.restore(kept)
    simulation.advance(IMPACTS)
    assert fingerprint(simulation.state) == there


@every_method
def test_the_energy_book_of_a_smooth_motion_closes_to_the_tolerance(name: str) -> None:
    for mechanism in (pendulum(), floating_pair()):
        simulation = Simulation(mechanism, INTEGRATORS[name](rtol=1e-6))
        simulation.advance(3.0)
        residual, turnover = simulation.energy_book()
        assert abs(residual) < (1e-3 if METHODS[name].order == 2 else 1e-5) * turnover


@every_method
def test_a_lane_of_a_batch_has_the_bits_of_its_simulation_alone(name: str) -> None:
    def lanes() -> list[Simulation]:
        arrays = [replace(ARRAY, spring_preload_angle=1.0 + 0.1 * k) for k in range(3)]
        return [Simulation(build(array), controlled(name)) for array in arrays]

    batch, alone = Batch(lanes()), lanes()
    for share in (0.5, 1.0):
        batch.advance(np.arange(3), np.full(3, share * IMPACTS))
        for simulation in alone:
            simulation.advance(share * IMPACTS)
    for inside, outside in zip(batch.simulations, alone, strict=True):
        assert outside.state.joints["contact_starts"].min() > 0
        assert fingerprint(inside.state) == fingerprint(outside.state)


@every_method
def test_recording_does_not_change_a_bit(name: str) -> None:
    silent, recorded = (Simulation(build(ARRAY), controlled(name)) for _ in range(2))
    recorder = make_recorder(recorded.model, recorded.state, np.linspace(0.0, IMPACTS, 77), 1000)
    silent.advance(IMPACTS)
    recorded.advance(IMPACTS, recorder)
    assert recorder.filled[0] == 77
    assert fingerprint(recorded.state) == fingerprint(silent.state)


@every_method
def test_a_latching_is_found_inside_a_step(name: str) -> None:
    # angle = torque t^2 / (2 inertia) from rest, inertia 2 kg m2.
    simulation = at_fixed_step(name, rotor(1.0), 0.01)
    simulation.set_motor_torque(0, 0.5)
    simulation.advance(3.0)
    tolerance = 1e-4 if METHODS[name].order == 2 else 1e-9
    assert simulation.state.joints["latch_time"][0] == pytest.approx(math.sqrt(8.0), rel=tolerance)


def test_each_method_has_compiled_kernels_of_its_own() -> None:
    settings = {method.kernel_settings.__name__ for method in METHODS.values()}
    assert len(settings) == len(METHODS)
    for signature in getattr(advance_lanes, "signatures", []):
        assert signature[2].instance_class.__name__ in settings
