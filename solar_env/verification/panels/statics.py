"""Case of a panel that is held at one end and bent far by a load at the other."""

import cmath
import warnings
from collections.abc import Iterator
from dataclasses import replace

from solar_env.mechanics.arrays import columns
from solar_env.mechanics.mechanism.beams import PANEL
from solar_env.mechanics.mechanism.description import Mechanism
from solar_env.mechanics.running.diagnosis import SimulationWarning
from solar_env.verification.beams.theory import deflected_tip
from solar_env.verification.checks import Check
from solar_env.verification.panels.mechanisms import clamp, dead_force, loose, modal, moved, start

RANGE = "range of the second order: squared slope over 4 below 1 %"
# Damped critically: at rest after some seconds.
BEAM = replace(PANEL, damping=0.2)
_SETTLED = 4.0  # s
_SPRING = 100.0  # of the clamp, over E I / L
EXTENSIBLE = "extensible elastica by shooting, SciPy's DOP853 at rtol 1e-12"


def bent(load: float, moment: float, max_steps: int = 1_000_000) -> tuple[float, float, float]:
    """Largest slope against the frame [rad], and relative errors of the tip's deflection and turn.

    Args:
        load: P L^2 / (E I), across the undeformed panel.
        moment: M L / (E I).
        max_steps: bound on the steps of the run that comes to rest.

    Raises:
        SimulationError: if it does not come to rest in so many steps.
    """
    length, stiffness = BEAM.length, BEAM.bending_stiffness
    tip, force = (length, 0.0), 1j * load * stiffness / length**2
    forces = (dead_force(tip, force),) if load else ()
    joints = (clamp(_SPRING * stiffness / length), loose(tip), *forces)
    simulation = start(Mechanism((modal(BEAM),), joints), rtol=1e-4, max_steps=max_steps)
    simulation.set_motor_torque(1, moment * stiffness / length)
    simulation.advance(_SETTLED)
    simulation.check()
    place, turn = moved(simulation, 1)
    # The clamp gives way a little: of that the elastica is told.
    root = float(simulation.joint_loads()[0, columns.ANGLE])
    way = cmath.exp(1j * root)
    exact, exact_turn = deflected_tip(BEAM, force / way, tip_moment=moment * stiffness / length)
    deflection = (exact * way).imag
    slope, _ = simulation.formulation.modal_range(simulation.model, simulation.state)
    return slope, place.imag / deflection - 1.0, turn / (exact_turn + root) - 1.0


def large_deflections() -> Iterator[Check]:
    """Tip loads and moments that bend a panel by up to 0.5 rad: errors, and whether the run tells of them."""
    for name, load, moment in (
        *((f"P L^2 / (E I) = {load:g}", load, 0.0) for load in (0.1, 0.2, 0.4, 0.8)),
        *((f"M L / (E I) = {moment:g}", 0.0, moment) for moment in (0.1, 0.5)),
    ):
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always", SimulationWarning)
            slope, deflection, turn = bent(load, moment)
        for quantity, error in (("deflection", deflection), ("turn", turn)):
            # Second order leaves out 0.0512 of the squared slope, however many modes foreshortening takes along.
            yield Check(
                f"{name}: relative error of the tip's {quantity}", 0.0, error, 0.052 * slope**2 + 1e-6, EXTENSIBLE
            )
        yield Check(f"{name}: 1 if the run warns, at a slope of {slope:.2g} rad", slope > 0.2, len(told), 0.0, RANGE)
