"""The array's deployment by every method, for tests."""

from __future__ import annotations

import pytest

from solar_env.array import ArrayParameters, build
from solar_env.mechanics.integrators.settings import GeneralizedAlpha, Integrator, ModalRadau, RungeKutta
from solar_env.mechanics.mechanism.description import Mechanism
from solar_env.mechanics.running.simulation import Simulation

# A method with each control of steps: adaptive, its own, and that of modal panels.
EXAMPLES: list[Integrator] = [RungeKutta(), GeneralizedAlpha(step=4e-5), ModalRadau()]
every_integrator = pytest.mark.parametrize("integrator", EXAMPLES, ids=lambda i: i.name)
# Levels of natural coordinates, and of all methods; few elements and modes, which is quick.
BEAMS = ["flexible-ideal:2 elements", "flexible-clearance:2 elements"]
NATURAL_LEVELS = ["rigid-ideal", "rigid-clearance", *BEAMS]
LEVELS = [*NATURAL_LEVELS, "flexible-ideal:4 modes", "flexible-clearance:4 modes"]


def array(integrator: Integrator, model: str = "rigid-clearance") -> Mechanism:
    """The array, with modal panels for their own method."""
    if isinstance(integrator, ModalRadau):
        model = f"{model.replace('rigid', 'flexible')}:3 modes"
    elif model.startswith("flexible"):
        model += ":2 elements"
    return build(ArrayParameters(), model)


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
