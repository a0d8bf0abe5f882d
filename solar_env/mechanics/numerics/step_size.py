"""Step-size control by the error of the previous step, for all methods that adapt their steps.

Errors are in units of the tolerance, and grow with a power of the step. A step whose error is above one is tried again
with a smaller size; an accepted step sets the size of the next step (E. Hairer and G. Wanner, Solving Ordinary
Differential Equations II, 1996, section IV.2, doi:10.1007/978-3-642-05221-7).
"""

import math
from typing import NamedTuple

from solar_env.mechanics.numerics.jit import kernel

_SAFETY = 0.9
UNSOLVED = 0.25  # factor on a step to try again if the step's equations were not solved


class StepController(NamedTuple):
    """Parameters of the rule that sets the size of steps by their errors.

    Attributes:
        order: power of the step size with which the error grows.
        proportional: weight of the step's own error; with 1 the next step aims at the tolerance.
        integral: weight of the previous step's error; 0 ignores it.
        least_error: lower bound of the step's own error in the rule.
        least_share: least ratio of the next trial step to a rejected step.
        most_growth: greatest factor from one step to the next.
        least_growth: factor below which the step size is kept, for methods in which a change costs much.
        memory: an error counts as at least this fraction of the previous error, as estimates may pass through zero.
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
    """Return the size [s] for a new try of a step `h` [s], whose error is above one or not finite."""
    if not error < math.inf:
        return h * control.least_share
    return h * max(_SAFETY * error ** (-1.0 / control.order), control.least_share)


@kernel
def growth(control, error, last_error):
    """Return the ratio of the next step's size to this one's, by a `StepController`; errors are in tolerance units."""
    wanted = _SAFETY * max(error, control.least_error) ** (-control.proportional / control.order)
    wanted = min(wanted * last_error ** (control.integral / control.order), control.most_growth)
    return 1.0 if wanted < control.least_growth else wanted
