"""Every method of the table: order, rejected and failed steps, snapshots, energy, lanes, events and settings."""

from __future__ import annotations

import copy
import math
import pickle
from dataclasses import replace

import numpy as np
import pytest
from helpers import attempt, fingerprint, orders
from mechanisms import Vector, floating_pair, pendulum, rotor

from solar_env.array import ArrayParameters, build
from solar_env.mechanics.arrays.columns import ANGLE, RATE
from solar_env.mechanics.arrays.model import GRAVITY, MOTOR_WORK, joint_integrals
from solar_env.mechanics.integrators.methods.table import METHODS, method_of
from solar_env.mechanics.integrators.run import advance_lanes
from solar_env.mechanics.integrators.settings import INTEGRATORS, Integrator, RungeKutta
from solar_env.mechanics.mechanism.description import Mechanism
from solar_env.mechanics.modal.tables import GREATEST_STEP
from solar_env.mechanics.records.recording import make_recorder
from solar_env.mechanics.running.batch import Batch
from solar_env.mechanics.running.errors import SimulationError
from solar_env.mechanics.running.simulation import Simulation

every_method = pytest.mark.parametrize("name", METHODS)
FIXED = "generalized-alpha"
every_adaptive_method = pytest.mark.parametrize("name", [name for name in METHODS if name != FIXED])
# A moment of the array in which its joints strike their bearings often.
IMPACTS = 0.06
# s, 64 of the greatest step that the modal method has tables for, whose steps are halves of it.
END = 64 * GREATEST_STEP
ARRAY = ArrayParameters(clearance=1e-5, spring_stiffness=(5.0, 3.75))
# Panels that bend, for the methods that are made for them.
LEVELS = {"rosenbrock": "flexible-clearance:1 element", "modal-radau": "flexible-clearance:4 modes"}
TENTATIVE = ("clock", "multipliers", "a", "algorithmic_a", "power")  # what a step that fails may leave


def controlled(name: str) -> Integrator:
    """The method with its error under control, or with a small step."""
    return INTEGRATORS[name]().with_options(2e-5 if name == FIXED else None, None if name == FIXED else 1e-4)


def deploying(name: str, **changes: float) -> Simulation:
    return Simulation(build(replace(ARRAY, **changes), LEVELS.get(name, "rigid-clearance")), controlled(name))


def at_fixed_step(name: str, mechanism: Mechanism, step: float, rtol: float = 0.1) -> Simulation:
    """A simulation that takes steps of one size, whatever their error."""
    loose = {} if name == FIXED else {"velocity_scale": 1e9, "rtol": 0.1}
    if name == "modal-radau":
        # Newton's iteration goes by the tolerance, too.
        loose = {"velocity_scale": 0.1, "rtol": rtol}
    simulation = Simulation(mechanism, INTEGRATORS[name](**loose).with_options(step, None))
    simulation.state.clock["step_size"], simulation.state.clock["last_error"] = step, 1.0
    return simulation


def swing(simulation: Simulation) -> Vector:
    """Angle and rate of the pendulum."""
    return simulation.joint_loads()[0, [ANGLE, RATE]]


def driven(simulation: Simulation) -> Vector:
    """Angle, rate and the motor's work after a drive by a constant torque."""
    simulation.set_motor_torque(0, 0.4)
    simulation.advance(END)
    return np.append(swing(simulation), joint_integrals(simulation.state.integrals)[0, MOTOR_WORK])


def test_the_table_has_a_row_for_every_choice_of_settings() -> None:
    assert list(METHODS) == list(INTEGRATORS)
    for name, kind in INTEGRATORS.items():
        assert method_of(kind()) is METHODS[name]
    with pytest.raises(ValueError, match="must be one of RungeKutta"):
        method_of("runge-kutta")


@every_method
@pytest.mark.parametrize(
    ("mechanism", "rtol"),
    [(pendulum(), 1e-3), (floating_pair(), 1e-4)],
    ids=["constrained and projected", "free bodies"],
)
def test_a_method_converges_with_the_order_that_its_row_declares(name: str, mechanism: Mechanism, rtol: float) -> None:
    order, errors = METHODS[name].order, []
    coarsest = {2: 100, 4: 40, 5: 64}[order]
    exact = driven(Simulation(mechanism, RungeKutta(rtol=1e-13)))
    for steps in (coarsest, 2 * coarsest, 4 * coarsest)[: 2 if order > 4 else 3]:
        simulation = at_fixed_step(name, mechanism, END / steps * (1 + 1e-12), rtol)
        errors.append(float(np.abs(driven(simulation) - exact).max()))
        assert simulation.state.clock["steps"][0] == steps
    assert errors[-1] > 1e-13, "lost in rounding"
    assert orders(errors).mean() == pytest.approx(order, abs=0.4)


@every_adaptive_method
def test_a_rejected_step_leaves_no_trace_in_the_motion_or_its_history(name: str) -> None:
    tried = Simulation(build(ARRAY), controlled(name))
    tried.advance(IMPACTS)
    # Contacts that began long ago do not bound the step.
    tried.state.joints["contact_start"] = -1.0
    before = fingerprint(tried.state, skip=TENTATIVE)
    tried.integrator = replace(tried.integrator, max_steps=1)
    tried.state.clock["step_size"] = 0.5
    rejected, time = tried.state.clock["rejected_steps"][0], tried.time
    attempt(tried, 1.0)
    assert tried.state.clock["rejected_steps"][0] == rejected + 1
    assert tried.time == time
    assert fingerprint(tried.state, skip=TENTATIVE) == before


@every_adaptive_method
def test_a_tighter_tolerance_gives_a_smaller_error_at_more_steps(name: str) -> None:
    exact = Simulation(floating_pair(), RungeKutta(rtol=1e-12))
    exact.advance(2.0)
    errors, steps = [], []
    for rtol in (1e-4, 1e-6, 1e-8):
        simulation = Simulation(floating_pair(), INTEGRATORS[name](rtol=rtol, max_step=0.1))
        simulation.advance(2.0)
        errors.append(np.abs(swing(simulation) - swing(exact)).max())
        steps.append(int(simulation.state.clock["steps"][0]))
    assert errors[0] > 10 * errors[1] > 100 * errors[2]
    assert errors[2] < 1e-7
    assert steps == sorted(set(steps))


@every_method
def test_every_call_ends_on_its_very_end(name: str) -> None:
    simulation = Simulation(floating_pair(), INTEGRATORS[name]().with_options(0.1, None))
    # Start + (end - start) is not always the end.
    for end in np.cumsum(np.random.default_rng(0).uniform(1e-9, 0.05, 300)):
        simulation.advance(end)
        assert simulation.time == end


@every_method
def test_an_infinite_force_is_reported_with_its_time_and_leaves_the_last_accepted_state(name: str) -> None:
    simulation = deploying(name)
    simulation.advance(IMPACTS)
    simulation.set_motor_torque(0, 1e308)
    before = fingerprint(simulation.state, skip=TENTATIVE)
    with np.errstate(all="ignore"), pytest.raises(SimulationError, match=r"at t = [0-9.]+ s") as caught:
        simulation.advance(1.0)
    assert caught.value.reason in ("not_finite", "newton", "constraints")
    assert caught.value.time == simulation.time == IMPACTS
    assert fingerprint(simulation.state, skip=TENTATIVE) == before


@every_method
def test_a_call_that_outgrows_its_bound_of_steps_says_so_and_can_go_on(name: str) -> None:
    bounded, whole = deploying(name), deploying(name)
    bounded.integrator = replace(bounded.integrator, max_steps=7)
    with pytest.raises(SimulationError, match=r"7 steps were taken in one call .* raise max_steps") as caught:
        bounded.advance(IMPACTS)
    assert caught.value.reason == "steps"
    assert 0 < bounded.state.clock["steps"][0] <= 7
    while not attempt(bounded, IMPACTS):
        pass
    whole.advance(IMPACTS)
    assert fingerprint(bounded.state, skip=("clock",)) == fingerprint(whole.state, skip=("clock",))
    assert bounded.state.clock["steps"] == whole.state.clock["steps"]


@every_method
def test_a_snapshot_in_a_contact_a_copy_and_a_pickle_go_on_to_the_same_bits(name: str) -> None:
    simulation, end = deploying(name), 0.25 * IMPACTS
    simulation.set_motor_torque(0, 0.2)
    while not simulation.state.joints["in_contact"].any():
        simulation.advance(end)
        end += 1e-5
    saved = simulation.snapshot()
    before = fingerprint(saved)
    others = [copy.deepcopy(simulation), pickle.loads(pickle.dumps(simulation)), deploying(name)]
    others[-1].restore(pickle.loads(pickle.dumps(saved)))
    simulation.advance(2.0 * IMPACTS)
    there = fingerprint(simulation.state)
    assert simulation.state.joints["contact_starts"].sum() > saved.joints["contact_starts"].sum()
    simulation.restore(saved)
    for one in (*others, simulation):
        assert fingerprint(one.state) == fingerprint(saved) == before
        one.advance(2.0 * IMPACTS)
        assert fingerprint(one.state) == there


@every_method
def test_the_energy_book_of_a_smooth_motion_closes_to_the_tolerance(name: str) -> None:
    for mechanism in (pendulum(), floating_pair()):
        simulation = Simulation(mechanism, INTEGRATORS[name]() if name == FIXED else INTEGRATORS[name](rtol=1e-6))
        start = simulation.stored_energies()[GRAVITY]
        simulation.advance(3.0)
        assert abs(simulation.stored_energies()[GRAVITY] - start) > 1.0
        residual, turnover = simulation.energy_book()
        assert abs(residual) < (1e-3 if METHODS[name].order == 2 else 1e-5) * turnover


@every_method
@pytest.mark.parametrize("threads", [1, None])
def test_a_lane_of_a_batch_has_the_bits_of_its_simulation_alone(name: str, threads: int | None) -> None:
    batch, alone = ([deploying(name, spring_preload_angle=1.0 + 0.1 * k) for k in range(3)] for _ in range(2))
    together, ends = Batch(batch, threads), np.array([0.9, 1.0, 0.8]) * IMPACTS
    # Of the second half the order of the lanes is another.
    for share in (0.5, 1.0):
        together.advance(np.arange(3), share * ends)
        for simulation, end in zip(alone, share * ends, strict=True):
            simulation.advance(end)
    for inside, outside in zip(batch, alone, strict=True):
        assert outside.state.joints["contact_starts"].min() > 0
        assert fingerprint(inside.state) == fingerprint(outside.state)
    assert len({fingerprint(simulation.state) for simulation in alone}) == 3


@every_method
def test_recording_does_not_change_a_bit(name: str) -> None:
    silent, recorded = deploying(name), deploying(name)
    recorder = make_recorder(recorded.model, recorded.state, np.linspace(0.0, IMPACTS, 77), 1000)
    silent.advance(IMPACTS)
    recorded.advance(IMPACTS, recorder)
    assert recorder.filled[0] == 77
    assert recorder.filled[1] > 10
    assert fingerprint(recorded.state) == fingerprint(silent.state)


@every_method
def test_a_latching_is_found_inside_a_step_and_its_stop_holds(name: str) -> None:
    # angle = torque t^2 / (2 inertia) from rest, inertia 2 kg m2.
    simulation = at_fixed_step(name, rotor(1.0), 0.01)
    simulation.set_motor_torque(0, 0.5)
    simulation.advance(3.0)
    # Linear interpolation and a method of second order are both of order h^2.
    tolerance = 0.01**2 / 8 if METHODS[name].order == 2 else 1e-9
    assert simulation.state.joints["latch_time"][0] == pytest.approx(math.sqrt(8.0), abs=tolerance)
    assert simulation.state.clock["latched_joints"][0] == simulation.state.joints["latched"][0] == 1
    simulation.integrator = INTEGRATORS[name]()
    simulation.advance(30.0)
    # The torque presses the joint against the far face: 1 + 0.01 + 0.5 / 100.
    assert simulation.joint_loads()[0, ANGLE] == pytest.approx(1.015, abs=1e-6)


SENSELESS = {
    "rtol": (0.0, 0.2, math.nan),
    "velocity_scale": (0.0, math.inf, math.nan),
    "max_step": (0.0, -1.0, math.nan),
    "impact_resolution": (-1.0, 0.0, math.inf),
}
OF_ALPHA = {
    "step": (0.0, -1e-4, 2.0, math.nan),
    "rho_inf": (1.1, -0.1, math.nan),
    "newton_tolerance": (0.0,),
}
OF_ALL = {"max_steps": (0, 2.5, math.nan)}


@every_method
def test_settings_without_sense_are_refused_by_name_and_value(name: str) -> None:
    for setting, values in (OF_ALL | (OF_ALPHA if name == FIXED else SENSELESS)).items():
        for value in values:
            with pytest.raises(ValueError, match=f"{setting} = {value!r}"):
                INTEGRATORS[name](**{setting: value})


def test_kernels_are_compiled_for_the_settings_of_methods_alone() -> None:
    settings = {method.kernel_settings.__name__ for method in METHODS.values()}
    for signature in getattr(advance_lanes, "signatures", []):
        assert signature[2].instance_class.__name__ in settings
