"""Mechanisms of one modal panel under end loads, and their simulations.

A mechanism with modal panels accepts no dead loads. A force comes instead from a contact that is so deep and soft that
the panel's motion hardly changes it. A moment is the motor torque of a joint whose surfaces are too far apart to meet.
"""

from solar_env.mechanics.arrays import columns
from solar_env.mechanics.integrators.settings import ModalRadau
from solar_env.mechanics.joints.laws import PowerLaw
from solar_env.mechanics.mechanism import GROUND, Bearing, Joint, Mechanism, ModalPanel, Point, Spring
from solar_env.mechanics.mechanism.beams import BEAM, Beam
from solar_env.mechanics.running.simulation import Simulation

_FAR = 1e6  # m


def start(mechanism: Mechanism, rtol: float = 1e-6, max_steps: int = 20_000_000) -> Simulation:
    """Return a simulation of a mechanism by modal-radau, the integration method for modal panels."""
    return Simulation(mechanism, ModalRadau(rtol=rtol, max_steps=max_steps))


def modal(beam: Beam, modes: int = 24, **placed: float | Point) -> ModalPanel:
    """Return a beam as a modal panel with `modes` modes; `placed` holds further keywords of `ModalPanel`."""
    stiffness = (beam.axial_stiffness, beam.bending_stiffness, beam.damping)
    return ModalPanel(BEAM, beam.length, beam.mass, *stiffness, modes=modes, **placed)  # type: ignore[arg-type]


def dead_force(end: Point, force: complex) -> Joint:
    """Return a joint that exerts a nearly constant force x + i y [N] on a beam's end, at (0, 0) or (length, 0)."""
    size = abs(force)
    place = complex(*end) + force / size * _FAR
    bearing = Bearing(0.5 * _FAR, _FAR, PowerLaw(2.0 * size / _FAR, exponent=1.0))
    return Joint(f"force at {end[0]:g}", GROUND, BEAM, (place.real, place.imag), end, bearing=bearing)


def loose(end: Point) -> Joint:
    """Return a joint whose motor exerts a moment on a beam's end; the joint's surfaces are too far apart to meet."""
    return Joint(f"moment at {end[0]:g}", GROUND, BEAM, end, end, bearing=Bearing(_FAR, _FAR, PowerLaw(1.0)))


def clamp(stiffness: float) -> Joint:
    """Return a joint that pins a beam's first end to the origin, and holds its direction by a spring [N m/rad]."""
    return Joint("clamp", GROUND, BEAM, (0.0, 0.0), (0.0, 0.0), spring=Spring(stiffness, 0.0))


def moved(simulation: Simulation, joint: int) -> tuple[complex, float]:
    """Return displacement x + i y [m] and rotation [rad], since t = 0, of the beam's end at joint index `joint`."""
    row = simulation.joint_loads()[joint]
    return complex(row[columns.ECCENTRICITY_X], row[columns.ECCENTRICITY_Y]), float(row[columns.ANGLE])
