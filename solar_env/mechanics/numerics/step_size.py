"""Size of a step from the error of the one before: the controller of all methods that adapt their steps.

Errors are in units of the tolerance, and grow with a power of the step. A step whose error is above one is tried again,
shorter; one that is taken sets the size of the next (E. Hairer and G. Wanner, Solving Ordinary Differential Equations
II, 1996, section IV.2, doi:10.1007/978-3-642-05221-7).
"""

import math
from typing import NamedTuple

from solar_env.mechanics.numerics.jit import kernel

_SAFETY = 0.9
UNSOLVED = 0.25  # share of a step to try again if the step's equations were not solved


class StepController(NamedTuple):
    """Rule by which the size of steps follows their errors.

    Attributes:
        order: power of the step with which its error grows.
        proportional: how much the error of the step counts; 1 aims the next one at the tolerance.
        integral: how much the error of the step before counts; 0: not at all.
        least_error: smaller errors count as this.
        least_share: least share of a refused step with which it is tried again.
        most_growth: greatest growth from one step to the next.
        least_growth: growth below which a step is kept as it is, where a change costs much.
        memory: share of the error of the step before that counts at least, for errors that may pass through zero.
    """

    order: float
    proportional: float = 1.0
    integral: float = 0.0
    least_error: float = 1e-6
    least_share: float = 0.1
    most_growth: float = 10.0
    least_growth: float = 0.0
    memory: float = 0.0


@kernel
def shortened(control, h, error):
    """Return the size [s] with which a step of `h` [s] is tried again after an error above one or not finite."""
    if not error < math.inf:
        return h * control.least_share
    return h * max(_SAFETY * error ** (-1.0 / control.order), control.least_share)


@kernel
def growth(control, error, last_error):
    """Return the next step's size divided by the present one's, from the errors of the present and the last step."""
    wanted = _SAFETY * max(error, control.least_error) ** (-control.proportional / control.order)
    wanted = min(wanted * last_error ** (control.integral / control.order), control.most_growth)
    return 1.0 if wanted < control.least_growth else wanted
