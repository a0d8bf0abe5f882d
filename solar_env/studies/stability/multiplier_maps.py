"""Map of step-size changes on index-3 multipliers: what generalized-alpha answers when the step changes.

A pendulum swings for a second; then the step changes. The library solves accelerations and multiplier afresh after
every change; the textbook's method carries its accelerations over. Both are judged by the tension that their own
position and velocity ask for: m (v^2 - g . r) / L^2 is the multiplier of the length constraint.

The mode that grows with rho_inf = 1: A. Cardona and M. Geradin, Comput. Struct. 33 (1989) 801,
doi:10.1016/0045-7949(89)90255-6.
"""

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.integrators.settings import GeneralizedAlpha, alpha_coefficients
from solar_env.mechanics.mechanism.textbook import STANDARD_GRAVITY, pendulum
from solar_env.mechanics.running.diagnosis import LARGEST_FORCE_SHARE
from solar_env.mechanics.running.simulation import Simulation
from solar_env.studies.stability.maps import Axis, Cell, Heard, Kind, StabilityMap, listen

LIBRARY, CARRIED_OVER = "library: restarts after a change", "textbook: carries accelerations over"
TOLERANCE = 2.0 * LARGEST_FORCE_SHARE
FIRST_STEP, CHANGE_TIME, STEPS = 1e-2, 1.0, 200  # s, s, after the change

Vector = NDArray[np.float64]


def library_errors(ratio: float, rho_inf: float) -> Vector:
    """(STEPS,) errors of the library's multipliers after a change, over the greatest force."""
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


def textbook_errors(ratio: float, rho_inf: float) -> Vector:
    """(STEPS,) the same for the equations r'' + r lambda = g, (r . r - 1) / 2 = 0, without any restart.

    M. Arnold and O. Bruls, Multibody Syst. Dyn. 18 (2007) 185, doi:10.1007/s11044-007-9084-0.
    """
    alpha_m, alpha_f, beta, gamma = alpha_coefficients(rho_inf)
    weight = np.array([0.0, -STANDARD_GRAVITY])
    position, velocity, multiplier = np.array([1.0, 0.0]), np.zeros(2), 0.0
    acceleration, auxiliary = weight.copy(), weight.copy()
    first = round(CHANGE_TIME / FIRST_STEP)
    errors = np.zeros(STEPS)
    for k in range(first + STEPS):
        h = FIRST_STEP if k < first else ratio * FIRST_STEP
        mass = (1.0 - alpha_m) / (beta * h * h * (1.0 - alpha_f))
        # Prediction with accelerations of zero at the end.
        past = (alpha_f * acceleration - alpha_m * auxiliary) / (1.0 - alpha_m)
        start = position + h * velocity + h * h * ((0.5 - beta) * auxiliary + beta * past)
        start_velocity = velocity + h * ((1.0 - gamma) * auxiliary + gamma * past)
        position = start.copy()
        for _ in range(30):
            ahead = mass * (position - start)
            residual = np.append(ahead + multiplier * position - weight, 0.5 * (position @ position - 1.0))
            matrix = np.zeros((3, 3))
            matrix[:2, :2] = (mass + multiplier) * np.eye(2)
            matrix[:2, 2] = matrix[2, :2] = position
            change = np.linalg.solve(matrix, -residual)
            position = position + change[:2]
            multiplier += float(change[2])
            if np.abs(change[:2]).max() < 1e-13:
                break
        acceleration = mass * (position - start)
        auxiliary = past + (1.0 - alpha_f) / (1.0 - alpha_m) * acceleration
        velocity = start_velocity + gamma * h * (auxiliary - past)
        if k >= first:
            held = float(velocity @ velocity + weight @ position)
            errors[k - first] = abs(multiplier - held) / max(abs(held), STANDARD_GRAVITY)
    return errors


def classify_errors(errors: Vector) -> Kind:
    """Fine up to a fifth of the force; else spikes if the last quarter is below that, growing if it is not."""
    if errors.max() <= TOLERANCE:
        return Kind.FINE
    return Kind.SPIKES if errors[-STEPS // 4 :].max() <= TOLERANCE else Kind.GROWING


def measure_multipliers(panel: str, ratio: float, rho_inf: float) -> Cell:
    """Greatest error of the multiplier in the 200 steps after a change."""
    run = library_errors if panel == LIBRARY else textbook_errors
    heard: Heard[Vector] = listen(lambda: run(ratio, rho_inf))
    return heard.cell(lambda errors: Cell(classify_errors(errors), float(errors.max())))


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
    panels=(LIBRARY, CARRIED_OVER),
    quantity="greatest error of the multiplier over the force",
    advice="Take rho_inf of 0.9 or less and solve accelerations and multipliers afresh after every change of the step, "
    "as the library does; with rho_inf = 1 constraint forces alternate ever more, at a constant step too.",
    measure=measure_multipliers,
    bare=(CARRIED_OVER,),
)
