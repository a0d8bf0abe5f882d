"""Whole runs: the same bits again, samples, snapshots, arrays of any number of panels, and what is refused."""

from __future__ import annotations

import math
import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from deployments import EXAMPLES, array, every_integrator, in_contact
from helpers import fingerprint, in_miniature
from mechanisms import block, pendulum, rotor

from solar_env.array import ArrayParameters, build
from solar_env.array.deployment import simulate as simulate_array
from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.arrays.columns import ANGLE, FORCE_X, FORCE_Y
from solar_env.mechanics.integrators.settings import GeneralizedAlpha, Integrator, ModalRadau, Rosenbrock, RungeKutta
from solar_env.mechanics.running.simulation import Simulation, simulate
from solar_env.mechanics.running.trajectory import Trajectory


def same(one: Trajectory, other: Trajectory) -> None:
    """Demand equal bits of everything that does not depend on the samples' times."""
    for name in (
        "wear_journal",
        "wear_bearing",
        "contacts",
        "latch_times",
        "peak_force",
        "postlock_peak_force",
        "postlock_impulse",
        "postlock_sliding_work",
        "contact_starts",
    ):
        assert getattr(one, name).tobytes() == getattr(other, name).tobytes(), name
    for name in ("coordinates", "velocities", "angles", "impulse", "sliding_work"):
        assert getattr(one, name)[-1].tobytes() == getattr(other, name)[-1].tobytes(), name


def test_an_integrator_that_is_none_is_refused() -> None:
    with pytest.raises(ValueError, match="integrator = 'rosenbrock' must be one of RungeKutta"):
        Simulation(pendulum(), "rosenbrock")  # type: ignore[arg-type]


ARRAYS: list[tuple[str, Integrator]] = [
    ("rigid-clearance", RungeKutta()),
    ("rigid-clearance", GeneralizedAlpha(step=4e-5)),
    ("flexible-clearance", Rosenbrock()),
    ("flexible-clearance", ModalRadau()),
]


def test_samples_stand_at_the_times_asked_for() -> None:
    run = simulate(pendulum(), 0.25, output_step=0.1)
    assert run.time == pytest.approx([0.0, 0.1, 0.2, 0.25], rel=1e-15)
    assert simulate(pendulum(), 0.3, output_step=0.1).time == pytest.approx([0.0, 0.1, 0.2, 0.3], rel=1e-15)


@pytest.mark.parametrize("integrator", [RungeKutta(rtol=1e-9), GeneralizedAlpha(step=1e-3)], ids=lambda i: i.name)
def test_samples_between_steps_are_as_good_as_the_steps(integrator: Integrator) -> None:
    sampled = simulate(pendulum(), 0.5, integrator=integrator, output_step=0.0137)
    for k in (7, 20, 33):
        landed = Simulation(pendulum(), integrator)
        landed.advance(float(sampled.time[k]))
        assert sampled.coordinates[k] == pytest.approx(landed.state.q, abs=1e-5)
        assert sampled.velocities[k] == pytest.approx(landed.state.v, abs=1e-4)
        assert sampled.joint_force[k, 0] == pytest.approx(landed.joint_loads()[0, [FORCE_X, FORCE_Y]], abs=0.05)


def test_progress_is_told_and_ends_with_the_duration() -> None:
    told: list[float] = []
    simulate(pendulum(), 0.3, progress=told.append)
    assert told == sorted(told)
    assert len(told) > 5
    assert told[-1] == 0.3


@pytest.mark.parametrize(("model", "integrator"), [*ARRAYS, ("rigid-clearance", GeneralizedAlpha(step=1.3e-5))])
def test_results_depend_neither_on_samples_nor_progress_nor_buffers_nor_on_how_often_a_call_comes_back(
    model: str, integrator: Integrator, monkeypatch: pytest.MonkeyPatch
) -> None:
    def run(output_step: float = 0.01, **options: Any) -> Trajectory:
        mechanism = array(integrator, model)
        return simulate(mechanism, 0.5, integrator=integrator, output_step=output_step, **options)

    told: list[float] = []
    whole, coarse = run(), run(output_step=0.25)
    same_samples = [run(progress=told.append)]
    with monkeypatch.context() as patch:
        patch.setattr("solar_env.mechanics.running.simulation._CONTACTS_PER_DRAIN", 3)
        same_samples.append(run())
    monkeypatch.setattr("solar_env.mechanics.running.simulation.STEPS_PER_CALL", 7)
    same_samples.append(run())
    assert len(whole.contacts) > 10
    assert len(told) > 10
    assert (len(whole.time), len(coarse.time)) == (51, 3)
    same(whole, coarse)
    for other in same_samples:
        same(whole, other)
        for name in ("coordinates", "normal_force", "sliding_work"):
            assert getattr(other, name).tobytes() == getattr(whole, name).tobytes(), name
        for name, series in whole.energies.items():
            assert series.tobytes() == other.energies[name].tobytes(), name
        assert other.metadata["steps"] == whole.metadata["steps"]


def test_the_contact_table_agrees_with_the_totals() -> None:
    run = simulate(build(ArrayParameters()), 2.0)
    for j in range(2):
        own = run.contacts[run.contacts["joint"] == j]
        assert len(own) == run.contact_starts[j]
        assert own["impulse"].sum() == pytest.approx(run.impulse[-1, j], rel=1e-10, abs=0.0)
        assert own["sliding_work"].sum() == pytest.approx(run.sliding_work[-1, j], rel=1e-9, abs=0.0)
        assert own["peak_force"].max() == run.peak_force[j]
        closed = own[np.isfinite(own["end_s"])]
        assert np.all(closed["end_s"] > closed["start_s"])
        # Contacts of one joint follow each other.
        assert np.all(closed["start_s"][1:] >= closed["end_s"][:-1] - 1e-12)
        assert np.all(np.isnan(own["end_s"][len(closed) :]))


@every_integrator
@pytest.mark.parametrize("model", ["rigid-ideal", "rigid-clearance"])
@pytest.mark.parametrize(("panels", "duration"), [(1, 11.0), (4, 21.0)])
def test_arrays_of_any_number_of_panels_deploy_and_latch(
    panels: int, duration: float, model: str, integrator: Integrator
) -> None:
    simulation = Simulation(build(ArrayParameters(panel_count=panels), model), integrator)
    simulation.advance(duration)
    joints = simulation.state.joints
    assert joints["latched"].all()
    assert np.all((joints["latch_time"] > 5.0) & (joints["latch_time"] < duration))
    locks = [math.pi / 2] + [math.pi] * (panels - 1)
    assert simulation.joint_loads()[:, ANGLE] == pytest.approx(locks, abs=0.2)


def test_integrators_agree_on_when_the_joints_with_clearance_latch() -> None:
    runs = [simulate(build(ArrayParameters(panel_count=1)), 11.0, integrator=i) for i in EXAMPLES]
    # The impacts of the first seconds are chaotic; what they leave in the latch times was seen to be some 1e-5 s.
    for other in runs[1:]:
        assert other.latch_times == pytest.approx(runs[0].latch_times, abs=1e-3)


def test_an_impulse_stops_what_it_should() -> None:
    # A block of 1 kg thrown at a wall with 0.3 m/s: the impulse of the first impact is its change of momentum.
    simulation = Simulation(block((0.3, 0.0)), RungeKutta(rtol=1e-8))
    simulation.advance(0.0045)
    assert simulation.state.joints["in_contact"][0] == 0
    assert simulation.state.integrals[m.IMPULSE] == pytest.approx(0.3 - simulation.state.v[0], rel=1e-7)


@pytest.mark.parametrize("torque", [math.nan, math.inf, -math.inf])
def test_a_torque_that_is_not_finite_is_refused(torque: float) -> None:
    with pytest.raises(ValueError, match=f"motor torque = {torque!r} N m must be finite"):
        Simulation(rotor()).set_motor_torque(0, torque)


@pytest.mark.parametrize("end", [0.4, -1.0, math.nan, math.inf])
def test_an_end_time_in_the_past_or_never_is_refused(end: float) -> None:
    simulation = Simulation(pendulum())
    simulation.advance(0.5)
    with pytest.raises(ValueError, match=f"end_time = {end!r} s"):
        simulation.advance(end)
    assert simulation.time == 0.5


@pytest.mark.parametrize("name", ["duration", "output_step"])
@pytest.mark.parametrize("value", [0.0, -1.0, math.nan, math.inf])
def test_a_duration_or_output_step_without_sense_is_refused(name: str, value: Any) -> None:
    arguments = {"duration": 1.0, name: value}
    with pytest.raises(ValueError, match=f"{name} = {value!r} s must be positive and finite"):
        simulate(pendulum(), **arguments)


@pytest.mark.parametrize("step", [1e-12, 5e-324])
def test_samples_without_number_are_refused_before_the_run(step: float) -> None:
    wanted = rf"output_step = {step!r} s makes \S+ samples of 30.0 s, more than 10,000,000; choose at least 3e-06 s"
    with pytest.raises(ValueError, match=wanted):
        simulate(pendulum(), 30.0, output_step=step)
    with pytest.raises(ValueError, match=wanted):
        simulate_array(output_step=step)


UNCOMPILED = """
import sys
sys.path.insert(0, sys.argv[1])
import numba
from helpers import in_miniature
assert numba.config.DISABLE_JIT
in_miniature()
"""


def test_the_kernels_also_run_uncompiled_where_an_index_out_of_bounds_is_an_error(
    run_python: Callable[..., str], capsys: pytest.CaptureFixture[str]
) -> None:
    uncompiled = run_python(UNCOMPILED, str(Path(__file__).parents[2]), NUMBA_DISABLE_JIT="1").splitlines()
    in_miniature()
    compiled = capsys.readouterr().out.splitlines()
    assert len(uncompiled) == len(compiled) == 12
    for one, other in zip(uncompiled, compiled, strict=True):
        name, *figures = one.split()
        expected_name, *expected = other.split()
        assert name == expected_name
        # The compiler contracts products and sums: rounding, which the first impacts magnify.
        assert [float(x) for x in figures] == pytest.approx([float(x) for x in expected], rel=1e-6, abs=1e-9)


def test_a_pickled_snapshot_continues_to_the_same_bits_in_another_process(
    tmp_path: Path, run_python: Callable[..., str]
) -> None:
    simulation = in_contact(EXAMPLES[0])
    path = tmp_path / "snapshot.pickle"
    path.write_bytes(pickle.dumps(simulation.snapshot()))
    end = simulation.time + 0.2
    simulation.advance(end)
    program = """
import pickle, sys, hashlib
from solar_env.array import ArrayParameters, build
from solar_env.mechanics.running.simulation import Simulation
simulation = Simulation(build(ArrayParameters()))
simulation.restore(pickle.load(open(sys.argv[1], "rb")))
simulation.advance(float.fromhex(sys.argv[2]))
print(hashlib.sha256(b"".join(array.tobytes() for array in simulation.state)).hexdigest())
"""
    assert run_python(program, str(path), end.hex()).strip() == fingerprint(simulation.state)


def test_an_integrator_of_another_formulation_is_refused() -> None:
    simulation = Simulation(build(ArrayParameters()), RungeKutta())
    other = Simulation(build(ArrayParameters()), ModalRadau())
    with pytest.raises(ValueError, match="the snapshot is a State, the integrator 'modal-radau' needs a ModalState"):
        other.restore(simulation.snapshot())
    simulation.integrator = ModalRadau()
    with pytest.raises(ValueError, match="'modal-radau' needs arrays that this simulation does not have; make a new"):
        simulation.advance(0.1)


def test_a_snapshot_that_is_refused_changes_nothing() -> None:
    simulation = in_contact(RungeKutta())
    before = fingerprint(simulation.state)
    other = Simulation(build(ArrayParameters(wear_bins=7)))
    with pytest.raises(ValueError, match=r"snapshot\.wear_journal has shape \(2, 7\)"):
        simulation.restore(other.snapshot())
    with pytest.raises(ValueError, match=r"snapshot\.q has shape \(8,\), this mechanism needs \(12,\)"):
        simulation.restore(Simulation(pendulum()).snapshot())
    assert fingerprint(simulation.state) == before
