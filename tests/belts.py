"""A bent beam between two rigid bodies with a cable loop along it, for tests of its forces and their slopes."""

from __future__ import annotations

import numpy as np
from helpers import Forces
from mechanisms import ROUND_BEARING

from solar_env.mechanics.mechanism.description import Body, CableLoop, FlexibleBody, Joint, Mechanism

LOOP = CableLoop("inner", "outer", 1.7, 2.0, 2.0)
PULLING = CableLoop("inner", "outer", 1.7, 2.0, 2.0, preload_torque=0.4, wheel_radius=0.1)


def belt(seed: int, *, reverse: bool = False, cable: CableLoop = LOOP) -> Forces:
    """A bent beam between two rigid bodies, in a random motion, with a loop along it; its axis may run back."""
    rng = np.random.default_rng(seed)
    beam = FlexibleBody("beam", 1.2, 2, 0.8, axial_stiffness=4.0, bending_stiffness=0.6, angle=0.3)
    ends = ((1.2, 0.0), (0.0, 0.0)) if reverse else ((0.0, 0.0), (1.2, 0.0))
    bodies = (
        Body("base", 1.5, 0.3, 0.9, (0.4, 0.1), angle=-0.4),
        beam,
        Body("last", 0.7, 0.1, 0.8, (0.3, -0.1), angle=0.9),
    )
    joints = (
        Joint("inner", "base", "beam", (0.9, 0.1), ends[0], folded_angle=0.2, bearing=ROUND_BEARING),
        Joint("outer", "beam", "last", ends[1], (0.1, 0.2), sign=-1, folded_angle=-0.3, bearing=ROUND_BEARING),
    )
    forces = Forces(Mechanism(bodies, joints, (cable,)))
    state, first = forces.state, forces.model.bodies[1]["offset"]
    state.q[first : first + 12] += 0.15 * rng.normal(size=12)
    state.v[:] = rng.normal(size=state.v.size)
    return forces
