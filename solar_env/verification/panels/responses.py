"""Case of a free panel's end that is suddenly loaded: by a force, and by a moment."""

import math
from collections.abc import Iterator
from dataclasses import replace

from solar_env.mechanics.mechanism.beams import PANEL
from solar_env.mechanics.mechanism.description import Mechanism
from solar_env.verification.checks import Check
from solar_env.verification.panels.mechanisms import dead_force, loose, modal, moved, start
from solar_env.verification.panels.modes import end_values
from solar_env.verification.panels.theory import FineBeam

# Retardation time of the array's panels [s].
BEAM = replace(PANEL, damping=1e-5)
END = (0.0, 0.0)
# Turns of the panel by up to 1e-3 rad, of which theory knows nothing, and the tolerance of the steps.
_RELATIVE = 1e-5
SERIES = "4000 exact modes as functions of time, and the static flexibility of the others"


def step_responses() -> Iterator[Check]:
    """Motion of the end under 1 N or 1 N m from t = 0 on; its rate is the answer to a unit impulse."""
    theory = FineBeam(BEAM)
    for load, name in enumerate(("force", "moment")):
        for modes in (24, 48):
            joints = (loose(END), dead_force(END, 1j)) if load == 0 else (loose(END),)
            simulation = start(Mechanism((modal(BEAM, modes),), joints), rtol=1e-8)
            simulation.set_motor_torque(0, float(load))
            for time in (1e-4, 1e-3, 1e-2, 5e-2):
                simulation.advance(time)
                place, turn = moved(simulation, 0)
                value, rate = theory.step_response(load, time)
                # Modes that are left out ring by no more than their flexibility, as the pseudo-modes for them do.
                omega = theory.frequencies[modes]
                ringing = 2.0 * theory.left_out(modes)[load] * math.exp(-0.5 * BEAM.damping * omega**2 * time)
                obtained = (place.imag, turn)[load]
                quantity = f"{name}, modes = {modes}: {('deflection [m]', 'slope [rad]')[load]} at t = {time:g} s"
                yield Check(quantity, value[load], obtained, ringing + _RELATIVE * float(value[load]), SERIES)
                # By then what is left out has died.
                if ringing < 1e-3 * _RELATIVE * value[load]:
                    rows, v = end_values(simulation.model.panels)[load], simulation.state.v
                    elastic = rows @ v[3 : 3 + rows.size]
                    rigid = (v[1] - 0.5 * BEAM.length * v[2], v[2])[load]
                    obtained = float(rigid + elastic)
                    quantity = f"{name}, modes = {modes}: rate, an impulse's answer, at t = {time:g} s"
                    yield Check(quantity, rate[load], obtained, _RELATIVE, SERIES, relative=True)
