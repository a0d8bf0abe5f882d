"""The array's deployment by every method, for tests."""

from __future__ import annotations

import pytest

from solar_env.array import ArrayParameters, build
from solar_env.mechanics.integrators.settings import GeneralizedAlpha, Integrator, ModalRadau, RungeKutta
from solar_env.mechanics.mechanism.description import Mechanism
from solar_env.mechanics.running.simulation import Simulation

# A method with each control of steps: adaptive, its own, and that of modal panels.
EXAMPLES: list[Integrator] = [RungeKutta(), GeneralizedAlpha(rtol=1e-4), ModalRadau()]
every_integrator = pytest.mark.parametrize("integrator", EXAMPLES, ids=lambda i: i.name)


def array(integrator: Integrator, model: str = "rigid-clearance") -> Mechanism:
    """The array, with modal panels for their own method."""
    if isinstance(integrator, ModalRadau):
        return build(ArrayParameters(), model.replace("rigid", "flexible"), modes=3)
    return build(ArrayParameters(), model, 2)


def in_contact(integrator: Integrator) -> Simulation:
    """A deployment, stopped in the middle of a contact, the motor running."""
    simulation = Simulation(array(integrator), integrator)
    simulation.set_motor_torque(0, 0.2)
    end = 0.3
    while simulation.state.joints["in_contact"].sum() == 0:
        simulation.advance(end)
        end += 1e-4
        assert end < 1.0
    return simulation
