"""Run-loop kernels of the Runge-Kutta and Rosenbrock methods, which choose explicit or linearly implicit steps.

With flexible bodies an explicit step (`runge_kutta.py`) is unstable beyond a known size. Where accuracy would allow a
step several times as long, Rosenbrock's method tries a linearly implicit step (`rosenbrock_step.py`). With rigid bodies
alone both methods are the same. The methods share their kernels, which are compiled once.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.arrays.model import EXACT, Model, State
from solar_env.mechanics.arrays.trial import joint_motion_type, trial_type
from solar_env.mechanics.equations.newton import fill_mass
from solar_env.mechanics.equations.system import Workspace, make_workspace
from solar_env.mechanics.integrators.methods.rosenbrock_step import (
    NEVER,
    LinearStep,
    attempt_implicit,
    make_linear_step,
)
from solar_env.mechanics.integrators.methods.runge_kutta import (
    STAGES,
    StiffForces,
    error_norm,
    make_stiff_forces,
    take_stages,
)
from solar_env.mechanics.integrators.methods.stage_steps import begin_stages
from solar_env.mechanics.integrators.methods.stages import Stages, make_stages, refresh
from solar_env.mechanics.integrators.settings import Rosenbrock, RungeKutta
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.linear import copy_into
from solar_env.mechanics.numerics.profile import clear
from solar_env.mechanics.numerics.step_size import StepController, growth
from solar_env.mechanics.records.history import step_limit

ORDER = 4  # order of convergence of both kinds of step
# Fraction of the flexible bodies' stable step that is used: exactly at the limit the highest mode would not decay.
_STABILITY_MARGIN = 0.95
# Least ratio of a linearly implicit step to the stable explicit step. An implicit step costs five times as much, but
# the explicit error estimate includes stiff vibrations and suggests shorter steps than an implicit step can take.
_WORTH = 2.5
# Factor on the error of a linearly implicit step, which dissipates unresolved vibrations unseen by the energy balance.
_STRICTER = 2.0
# Most explicit steps before the next implicit try: after a failed try the number of steps is doubled.
_LONGEST_WAIT = 256
# Controller of the step size that accuracy alone, without the stability limit, would allow.
_CONTROL = StepController(4.0)

# Below the speed velocity_scale / _SLOW, a flexible mechanism's velocity scale shrinks with the square of the speed,
# down to its fraction _LEAST_SCALE: impacts amplify errors, and the errors of the first, slow impacts longest.
_SLOW = 0.5
_LEAST_SCALE = 1e-3


class StageSettings(NamedTuple):
    """Settings of the integration methods with stages (Runge-Kutta, Rosenbrock), in the types that the kernels take."""

    rtol: float  # local error of velocities relative to (velocity_scale + |velocity|), of positions to the length scale
    velocity_scale: float  # [m/s]
    max_step: float  # [s]
    impact_resolution: float  # steps per predicted impact duration
    implicit: bool  # whether steps may be linearly implicit


class StageArrays(NamedTuple):
    """Work arrays of integration methods with stages for one thread, which uses them for all mechanisms of a batch."""

    trial: NDArray[np.void]  # (1,) rows of `trial.trial_type`
    motion: NDArray[np.void]  # (joints,) rows of `trial.joint_motion_type`
    work: Workspace
    scratch: Workspace  # for evaluations that must not change `work`
    stages: Stages
    stiff: StiffForces
    step: LinearStep


def convert_settings(chosen: RungeKutta) -> StageSettings:
    """Convert a user's settings to the kernels' types; other types would compile the kernels anew."""
    return StageSettings(
        float(chosen.rtol),
        float(chosen.velocity_scale),
        float(chosen.max_step),
        float(chosen.impact_resolution),
        isinstance(chosen, Rosenbrock),
    )


def make_stage_arrays(model: Model, state: State) -> StageArrays:
    """Allocate one thread's work arrays for a mechanism and an integration method with stages."""
    work, scratch = make_workspace(model, state), make_workspace(model, state)
    stages, stiff, step = make_stages(state, STAGES), make_stiff_forces(state), make_linear_step(model, state, work)
    trial, motion = np.zeros(1, trial_type), np.zeros(state.joints.size, joint_motion_type)
    return StageArrays(trial, motion, work, scratch, stages, stiff, step)


@kernel
def present_velocity_scale(velocity_scale, weights, v0, v):
    """Return the error norm's velocity scale [m/s], smaller in slow motion, at least _LEAST_SCALE * velocity_scale.

    The `weights` (n,) turn rates of beams' slopes [1/s] into speeds [m/s]. If no weighted velocity at the step's start
    (`v0`) or end (`v`) exceeds velocity_scale / _SLOW, the scale shrinks with the square of the greatest.
    """
    top = 0.0
    for i in range(v.size):
        top = max(top, weights[i] * max(abs(v0[i]), abs(v[i])))
    return velocity_scale * min(1.0, max((_SLOW * top / velocity_scale) ** 2, _LEAST_SCALE))


@kernel
def begin_rosenbrock(model, state, settings, arrays):
    """Prepare arrays for a call of `advance`, clear earlier calls' values; return False if constraints are singular."""
    step = arrays.step
    arrays.stiff.active[0] = 0
    step.linearized[0] = NEVER
    if settings.implicit:
        clear(model.elimination, step.newton.mass)
        fill_mass(model, step.newton.mass)
    return begin_stages(model, state, settings, arrays)


@kernel
def choose_rosenbrock(model, state, settings, arrays, remaining):
    """Return the step [s] that accuracy, impacts and, if explicit, stability allow; set `arrays.trial.implicit`."""
    clock, trial, stable = state.clock[0], arrays.trial[0], _STABILITY_MARGIN * model.stable_step
    wanted = step_limit(state, settings)
    trial.implicit = settings.implicit and clock.explicit_wait <= 0 and wanted > _WORTH * stable
    trial.bound = not trial.implicit and stable < wanted
    return stable if trial.bound else wanted


@kernel
def attempt_rosenbrock(model, state, settings, arrays, h):
    """Compute a step `h` [s] and its end in `arrays.stages`; return error / tolerance, < 0 for singular constraints."""
    work, stages = arrays.work, arrays.stages
    if arrays.trial[0].implicit:
        error = _STRICTER * attempt_implicit(model, state, stages, arrays.step, work, settings, h)
        if 0.0 <= error <= 1.0:
            copy_into(state.multipliers, stages.multipliers)
        return error
    # Explicit steps need accelerations that solve the equations of motion exactly.
    if state.clock[0].acceleration_current != EXACT and not refresh(model, state, stages, work):
        return -1.0
    if not take_stages(model, state, arrays, h):
        return -1.0
    velocity_scale = settings.velocity_scale
    if settings.implicit and model.flexible:
        velocity_scale = present_velocity_scale(velocity_scale, model.error_weight, state.v, stages.v)
    return error_norm(model, state, arrays, settings.rtol, velocity_scale, h)


@kernel
def adapt_rosenbrock(model, state, settings, arrays, accepted):
    """Update, in `state.clock`, the number of explicit steps before the next try of a linearly implicit step.

    An `accepted` explicit step lowers the number by one. A rejected linearly implicit step sets it to 4, and after
    repeated failures to 8, 16, up to 256, unless a shorter such step is still worth a try. If only the stability limit
    has shortened an accepted explicit step, `state.clock` also gets the step size that accuracy would allow.
    """
    clock, trial = state.clock[0], arrays.trial[0]
    if accepted and settings.implicit:
        clock.explicit_wait -= not trial.implicit
        if trial.implicit:
            clock.explicit_patience = 0
        if trial.bound and not trial.last:
            clock.step_size = max(clock.step_size, trial.wanted * growth(_CONTROL, trial.error, 1.0))
    elif trial.implicit and clock.step_size <= _WORTH * (_STABILITY_MARGIN * model.stable_step):
        clock.explicit_patience = min(max(2 * clock.explicit_patience, 4), _LONGEST_WAIT)
        clock.explicit_wait = clock.explicit_patience
