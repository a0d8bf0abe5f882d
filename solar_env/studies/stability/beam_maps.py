"""Map of explicit steps on beams: the step against the number of elements, with the theoretical limit.

A panel of the solar array floats, shaken by tiny random velocities. What is measured is the factor by which the
vibration grows from step to step.
"""

import math

import numpy as np

from solar_env.mechanics.bodies.cable_element.stable_step import beam_stable_step
from solar_env.mechanics.integrators.settings import RungeKutta
from solar_env.mechanics.mechanism.beams import PANEL, free_beam
from solar_env.mechanics.running.errors import SimulationError
from solar_env.mechanics.running.simulation import Simulation
from solar_env.studies.stability.maps import Axis, Cell, Kind, Said, StabilityMap, log_range

LIBRARY, UNBOUNDED = "library", "without its bound"
STEPS = 300
_ENOUGH = 1e10  # growth of the energy at which a run has shown what it does
_ROUNDING = 1.0 + 1e-3  # of the energy
_AT_ONCE = 2  # steps between looks at the energy


def stable_step(elements: float) -> float:
    """Theoretical limit of the step [s] for a free panel of so many elements."""
    count = int(elements)
    return beam_stable_step(
        count, PANEL.length / count, PANEL.linear_density, PANEL.axial_stiffness, PANEL.bending_stiffness, PANEL.damping
    )


def _shaken(elements: int, step: float) -> Simulation:
    """A panel with tiny random velocities, about to take steps of a given size whose errors do not matter."""
    simulation = Simulation(free_beam(PANEL, elements), RungeKutta(rtol=0.1, velocity_scale=1e9, max_step=step))
    simulation.state.v[:] = 1e-6 * np.random.default_rng(0).normal(size=simulation.state.v.size)
    simulation.state.clock["step_size"] = step
    simulation.state.clock["last_error"] = 1.0
    return simulation


def measure_vibration(panel: str, step: float, elements: float) -> Cell:
    """Factor of the vibration's amplitude from step to step."""
    simulation = _shaken(int(elements), step)
    if panel == UNBOUNDED:
        simulation.model = simulation.model._replace(stable_step=math.inf)
    start, growth, taken = simulation.stored_energies().sum(), 1.0, 0
    try:
        while taken < STEPS and growth < _ENOUGH:
            simulation.advance(simulation.time + _AT_ONCE * step)
            taken = int(simulation.state.clock["steps"][0])
            growth = float(simulation.stored_energies().sum() / start)
    except SimulationError as error:
        return Cell(Kind.BLOW_UP, math.nan, Said.ERROR, str(error))
    factor = growth ** (0.5 / taken)
    bounded = int(simulation.state.clock["stability_bound_steps"][0])
    if bounded and growth <= _ROUNDING:
        message = f"{bounded} of {taken} steps were bounded by stability, to {step * STEPS / taken:.3g} s at most"
        return Cell(Kind.LIMITED, factor, Said.FIGURE, message)
    return Cell(Kind.GROWING if growth > _ROUNDING else Kind.FINE, factor)


BEAM_STEP = StabilityMap(
    name="beam-step",
    title="Explicit Runge-Kutta on the axial vibration of a panel",
    x=Axis("step_s", "largest step [s]", log_range(1e-5, 1e-3, 8), log_range(1e-6, 1e-3, 25)),
    y=Axis("elements", "elements of the panel", (1, 2, 6, 12), (1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48)),
    panels=(LIBRARY, UNBOUNDED),
    quantity="amplitude from step to step",
    advice="Leave the step to the library, which keeps 5 % below the limit, and take as few elements as the question "
    "allows: a step beyond the limit multiplies the vibration every time, whatever the tolerance.",
    measure=measure_vibration,
    limit=lambda panel, elements: stable_step(elements),
    limit_label="theory: 2.83 over the highest natural frequency",
    bare=(UNBOUNDED,),
)
