"""Newton's iteration on the joints' loads where it is hard: sliding that turns, bent panels, bodies held twice."""

import pytest

from solar_env import ArrayParameters, SimulationError, SimulationWarning, simulate
from solar_env.array import build
from solar_env.mechanics.integrators.settings import ModalRadau
from solar_env.mechanics.mechanism.description import GROUND, Body, Joint, Mechanism
from solar_env.mechanics.running.simulation import Simulation

SHORT = 13.0  # s, a little after the latches


@pytest.mark.parametrize(("modes", "onset"), [(100, 1e-4), (32, 1e-6)])
def test_sliding_may_turn_in_any_step(modes: int, onset: float) -> None:
    """With residual flexibility that gives way at once, and friction that sets in over micrometres a second."""
    parameters = ArrayParameters(friction_speed_zero=onset, friction_speed_full=10.0 * onset)
    trajectory = simulate(parameters, model=f"flexible-clearance:{modes} modes", duration=SHORT)
    assert trajectory.time[-1] == SHORT
    assert trajectory.metadata["rejected_steps"] < 0.3 * trajectory.metadata["steps"]


@pytest.mark.parametrize(("spin", "rtol"), [(3.0, 2e-4), (4.5, 2e-4), (7.0, 1e-3), (2.0, 1e-5)])
def test_no_step_is_struck_by_the_return_of_a_gap(spin: float, rtol: float) -> None:
    """What an array that spins lets its ideal joints drift apart by is taken back at a speed that grows bit by bit."""
    array = build(ArrayParameters(initial_spin=spin), "rigid-ideal")
    simulation = Simulation(array, ModalRadau(rtol=rtol))
    simulation.advance(6.0)
    assert simulation.formulation.drift(simulation.model, simulation.state)[0] < 1e-7


def test_a_body_that_is_held_twice_is_reported_and_not_moved() -> None:
    pins = tuple(Joint(f"at {x}", GROUND, "arm", (x, 0.0), (x, 0.0)) for x in (0.0, 1.0))
    held = Mechanism((Body("arm", 1.0, 1.0, 1.0, (0.0, 0.0)),), pins, gravity=(1.0, -9.81))
    with pytest.raises(SimulationError, match="constraints are redundant"):
        Simulation(held, ModalRadau()).advance(0.1)


def test_a_run_that_fails_outside_the_range_of_its_panels_says_so_too() -> None:
    soft = ArrayParameters().with_changes({"panel_young": ArrayParameters().panel_young / 1000.0})
    with pytest.warns(SimulationWarning, match="have bent by 0."), pytest.raises(SimulationError, match="use beam"):
        simulate(soft, model="flexible-ideal", duration=1.0)
