"""Verification cases of a single hinge: damper, dry friction, tabulated torque, stop without a latch, and hold-down."""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
from scipy.interpolate import PchipInterpolator
from scipy.optimize import brentq

from solar_env.mechanics.bodies.description import GROUND
from solar_env.mechanics.integrators.settings import Integrator, ModalRadau, RungeKutta
from solar_env.mechanics.mechanism import Body, Joint, Mechanism, Spring, Stop
from solar_env.mechanics.running.simulation import simulate
from solar_env.mechanics.running.trajectory import Trajectory
from solar_env.verification.checks import Check, compare

MASS, LENGTH, STIFFNESS = 2.0, 1.0, 4.0
INERTIA = MASS * LENGTH**2 / 3.0
METHODS: tuple[Integrator, ...] = (RungeKutta(rtol=1e-9), ModalRadau(rtol=1e-6))
OSCILLATOR = "linear oscillator with a damper, closed form"
COULOMB = "between two turning points dry friction takes 2 T / k of the amplitude"
TABLE = "kinetic energy is the integral of SciPy's PCHIP over the angle"
STOP = "energy is conserved: a stop without damping returns the hinge at the rate of its arrival"
HELD = "a joint held for some time opens as one that is released later"
_FREE = Spring(STIFFNESS, 1.0)


def swing(duration: float, method: Integrator, spin: float = 0.0, **joint: Any) -> Trajectory:
    """Return the simulated motion of a hinged bar from angle 0 at rate `spin` [rad/s]; `joint`: keywords of `Joint`."""
    bar = Body("bar", MASS, MASS * LENGTH**2 / 12.0, LENGTH, (LENGTH / 2, 0.0), spin=spin)
    hinge = Joint("hinge", GROUND, "bar", (0.0, 0.0), (0.0, 0.0), **joint)
    return simulate(Mechanism((bar,), (hinge,)), duration, integrator=method, output_step=0.01)


def damped_pendulum(damping: float, time: float) -> float:
    """Return the angle [rad] of a sprung bar with a damper `damping` [N m s/rad], `time` [s] after release from rest.

    The bar starts at 0; its spring, of stiffness STIFFNESS, is relaxed at 1 rad. The inertia is INERTIA.
    """
    decay, square = 0.5 * damping / INERTIA, STIFFNESS / INERTIA - (0.5 * damping / INERTIA) ** 2
    root = math.sqrt(abs(square))
    cosine, sine = (math.cos, math.sin) if square > 0.0 else (math.cosh, math.sinh)
    return 1.0 - math.exp(-decay * time) * (cosine(root * time) + decay / root * sine(root * time))


def hinge_elements() -> Iterator[Check]:
    """Check the motion of a hinged bar with one part at a time: damper, friction, torque table, stop, hold-down."""
    for method in METHODS:
        angles = []
        for damping in (0.5, 2.0, 12.0):
            motion = swing(3.0, method, spring=_FREE, damping=damping)
            angles.append((f"{damping:g} N m s/rad", damped_pendulum(damping, 3.0), motion.angles[-1, 0]))
        yield from compare(angles, f"angle after 3 s, damper of {{}} [rad], {method.name}", 2e-5, OSCILLATOR)
        motion = swing(9.0, method, spring=_FREE, friction_torque=0.2, friction_ramp_rate=1e-6)
        turns = motion.angles[np.flatnonzero(np.diff(np.sign(motion.rates[1:, 0]))) + 1, 0]
        expected = 1.0 + (-1.0) ** np.arange(4) * (1.0 - 0.1 * np.arange(1, 5))
        figures = ((str(k + 1), expected[k], turns[k]) for k in range(4))
        yield from compare(figures, f"turning point {{}} under dry friction [rad], {method.name}", 2e-4, COULOMB)
        points = ((0.0, 0.3), (0.4, 0.1), (0.9, 0.12), (1.2, -0.2), (2.0, 0.05))
        motion = swing(2.0, method, spin=0.3, harness=points)
        work = PchipInterpolator(*np.array(points).T).integrate(0.0, motion.angles[-1, 0])
        rate = math.sqrt(0.3**2 + 2.0 * float(work) / INERTIA)
        yield Check(f"rate after 2 s by a table [rad/s], {method.name}", rate, motion.rates[-1, 0], 1e-5, TABLE)
        stop = Stop(gap=0.01, stiffness=2e3, exponent=1.0, ramp_depth=1e-3, damping=0.0)
        motion = swing(1.5, method, spin=1.0, stop=stop, lock_angle=0.99, latches=False)
        yield Check(f"rate after a stop [rad/s], {method.name}", -1.0, motion.rates[-1, 0], 1e-5, STOP)
        stop = Stop(gap=0.01, stiffness=1e5, exponent=1.0, ramp_depth=1e-6, damping=100.0)
        held = swing(4.0, method, spring=_FREE, stop=stop, lock_angle=0.99, stow_angle=0.0, release_time=2.0)
        latch = brentq(lambda t: damped_pendulum(0.0, t) - 0.99, 0.1, 1.6)
        yield Check(f"latch time [s], held for 2 s, {method.name}", 2.0 + latch, held.latch_times[0], 1e-4, HELD)
