"""Map of step-size changes on index-3 multipliers: what generalized-alpha answers when the step changes.

A pendulum swings for a second; then the step changes, and the library solves accelerations and multiplier afresh. It is
judged by the tension that its own position and velocity ask for: m (v^2 - g . r) / L^2 is the multiplier of the length
constraint.

The mode that grows with rho_inf = 1: A. Cardona and M. Geradin, Comput. Struct. 33 (1989) 801,
doi:10.1016/0045-7949(89)90255-6.
"""

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.integrators.settings import GeneralizedAlpha
from solar_env.mechanics.mechanism.textbook import pendulum
from solar_env.mechanics.running.diagnosis import LARGEST_FORCE_SHARE
from solar_env.mechanics.running.simulation import Simulation
from solar_env.studies.stability.maps import Axis, Cell, Kind, StabilityMap, listen

TOLERANCE = 2.0 * LARGEST_FORCE_SHARE
FIRST_STEP, CHANGE_TIME, STEPS = 1e-2, 1.0, 200  # s, s, after the change

Vector = NDArray[np.float64]


def multiplier_errors(ratio: float, rho_inf: float) -> Vector:
    """(STEPS,) errors of the multipliers after a change, over the greatest force."""
    simulation = Simulation(pendulum(), GeneralizedAlpha(step=FIRST_STEP, rho_inf=rho_inf))
    simulation.advance(CHANGE_TIME)
    simulation.integrator = GeneralizedAlpha(step=ratio * FIRST_STEP, rho_inf=rho_inf)
    errors = np.zeros(STEPS)
    for k in range(STEPS):
        simulation.advance(CHANGE_TIME + (k + 1) * ratio * FIRST_STEP)
        defect, largest = simulation.constraint_force_defect()
        errors[k] = defect / largest
    simulation.check()
    return errors


def classify_errors(errors: Vector) -> Kind:
    """Fine up to a fifth of the force; else spikes if the last quarter is below that, growing if it is not."""
    if errors.max() <= TOLERANCE:
        return Kind.FINE
    return Kind.SPIKES if errors[-STEPS // 4 :].max() <= TOLERANCE else Kind.GROWING


def measure_multipliers(panel: str, ratio: float, rho_inf: float) -> Cell:
    """Greatest error of the multiplier in the 200 steps after a change."""

    def judge(errors: Vector) -> Cell:
        return Cell(classify_errors(errors), float(errors.max()))

    return listen(lambda: multiplier_errors(ratio, rho_inf), judge)


STEP_CHANGE = StabilityMap(
    name="step-change",
    title="Multipliers of generalized-alpha after a change of the step (pendulum, first step 0.01 s)",
    x=Axis(
        "step_ratio",
        "new step / old step",
        (0.01, 0.1, 0.5, 1.0, 2.0),
        (0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 0.8, 1.0, 1.25, 2.0, 4.0),
    ),
    y=Axis(
        "rho_inf",
        "rho_inf (1: the paper's beta = 1/4, gamma = 1/2)",
        (0.0, 0.5, 0.8, 1.0),
        (0.0, 0.2, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.99, 1.0),
    ),
    panels=("generalized-alpha",),
    quantity="greatest error of the multiplier over the force",
    advice="Take rho_inf of 0.9 or less: with rho_inf = 1 constraint forces alternate ever more, at a constant step "
    "too.",
    measure=measure_multipliers,
)
