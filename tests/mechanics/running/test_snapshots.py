"""The state of a simulation saved, restored, copied and pickled."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable
from pathlib import Path

import pytest
from deployments import EXAMPLES, array, every_integrator, in_contact
from helpers import fingerprint
from mechanisms import pendulum

from solar_env.array import ArrayParameters, build
from solar_env.mechanics.integrators.settings import Integrator, ModalRadau, RungeKutta
from solar_env.mechanics.running.simulation import Simulation


@every_integrator
def test_a_restored_state_continues_to_the_same_bits_in_the_middle_of_a_contact(integrator: Integrator) -> None:
    """In the same simulation and in another one."""
    simulation = in_contact(integrator)
    saved = simulation.snapshot()
    before = fingerprint(saved)
    simulation.advance(simulation.time + 0.2)
    expected = fingerprint(simulation.state)
    starts = simulation.state.joints["contact_starts"].copy()
    for one in (simulation, Simulation(array(integrator), integrator)):
        one.restore(pickle.loads(pickle.dumps(saved)))
        assert fingerprint(one.state) == fingerprint(saved) == before
        one.advance(one.time + 0.2)
        assert fingerprint(one.state) == expected
    # Something worth restoring happened on the way.
    assert starts.sum() > saved.joints["contact_starts"].sum()


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


@every_integrator
def test_a_simulation_can_be_copied_and_pickled_while_it_runs(integrator: Integrator) -> None:
    """A copy is a mechanism of its own, which goes on to the same bits."""
    simulation = in_contact(integrator)
    saved = simulation.snapshot()
    copies = [copy.deepcopy(simulation), pickle.loads(pickle.dumps(simulation))]
    simulation.advance(0.6)
    for other in copies:
        assert fingerprint(other.state) == fingerprint(saved)
        other.advance(0.6)
        assert fingerprint(other.state) == fingerprint(simulation.state)


def test_an_integrator_of_another_formulation_is_refused() -> None:
    simulation = Simulation(build(ArrayParameters()), RungeKutta())
    other = Simulation(build(ArrayParameters()), ModalRadau())
    with pytest.raises(ValueError, match="the snapshot is a State, the integrator 'modal-radau' needs a ModalState"):
        other.restore(simulation.snapshot())
    simulation.integrator = ModalRadau()
    with pytest.raises(ValueError, match="'modal-radau' needs other arrays than those of this simulation; make a new"):
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
