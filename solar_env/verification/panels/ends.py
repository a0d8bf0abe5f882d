"""Cases of a panel loaded at an end: suddenly while it is free, and bent far while its other end is held."""

import cmath
import math
import warnings
from collections.abc import Iterator
from dataclasses import replace

from solar_env.mechanics.arrays import columns
from solar_env.mechanics.mechanism import PANEL, Mechanism
from solar_env.mechanics.running.diagnosis import SimulationWarning
from solar_env.verification.beams.theory import FineBeam, deflected_tip
from solar_env.verification.checks import Check
from solar_env.verification.panels.mechanisms import clamp, dead_force, loose, modal, moved, start

SERIES = "4000 exact modes as functions of time, and the static flexibility of the others"
RANGE = "range of the second order: squared slope over 4 below 1 %"
EXTENSIBLE = "extensible elastica, SciPy's solve_bvp"


def step_responses() -> Iterator[Check]:
    """Motion of the end under 1 N or 1 N m from t = 0 on."""
    # The retardation time of the array's panels [s].
    beam, end = replace(PANEL, damping=1e-5), (0.0, 0.0)
    theory = FineBeam(beam)
    for load, (name, quantity) in enumerate((("force", "deflection [m]"), ("moment", "slope [rad]"))):
        for modes in (24, 48):
            joints = (loose(end), dead_force(end, 1j)) if load == 0 else (loose(end),)
            simulation = start(Mechanism((modal(beam, modes),), joints), rtol=1e-8)
            simulation.set_motor_torque(0, float(load))
            for time in (1e-4, 1e-3, 1e-2, 5e-2):
                simulation.advance(time)
                place, turn = moved(simulation, 0)
                expected = float(theory.step_response(load, time)[load])
                # Modes that are left out ring by no more than their flexibility, as the pseudo-modes for them do. The
                # panel turns by up to 1e-3 rad, of which theory knows nothing; steps have their tolerance.
                omega = theory.frequencies[modes]
                ringing = 2.0 * theory.left_out(modes)[load] * math.exp(-0.5 * beam.damping * omega**2 * time)
                tolerance = float(ringing) + 1e-5 * expected
                label = f"{name}, modes = {modes}: {quantity} at t = {time:g} s"
                yield Check(label, expected, (place.imag, turn)[load], tolerance, SERIES)


def bent(load: float, moment: float) -> tuple[float, float, float]:
    """Largest slope against the frame [rad], and relative errors of the tip's deflection and turn, of a held panel.

    Args:
        load: P L^2 / (E I), across the undeformed panel.
        moment: M L / (E I).
    """
    # Damped critically: at rest after some seconds.
    beam = replace(PANEL, damping=0.2)
    length, stiffness = beam.length, beam.bending_stiffness
    tip, force = (length, 0.0), 1j * load * stiffness / length**2
    forces = (dead_force(tip, force),) if load else ()
    simulation = start(Mechanism((modal(beam),), (clamp(100.0 * stiffness / length), loose(tip), *forces)), rtol=1e-4)
    simulation.set_motor_torque(1, moment * stiffness / length)
    simulation.advance(4.0)
    simulation.check()
    place, turn = moved(simulation, 1)
    # The clamp gives way a little: of that the elastica is told.
    root = float(simulation.joint_loads()[0, columns.ANGLE])
    way = cmath.exp(1j * root)
    exact, exact_turn = deflected_tip(beam, force / way, moment * stiffness / length)
    slope, _ = simulation.formulation.modal_range(simulation.model, simulation.state)
    return slope, place.imag / (exact * way).imag - 1.0, turn / (exact_turn + root) - 1.0


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
            label = f"{name}: relative error of the tip's {quantity}"
            yield Check(label, 0.0, error, 0.052 * slope**2 + 1e-6, EXTENSIBLE)
        yield Check(f"{name}: 1 if the run warns, at a slope of {slope:.2g} rad", slope > 0.2, len(told), 0.0, RANGE)
