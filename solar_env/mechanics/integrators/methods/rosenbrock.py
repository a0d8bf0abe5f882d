"""Rosenbrock's method: linearly implicit steps (`rosenbrock_step.py`) where they are worth their price.

With flexible bodies the explicit method (`runge_kutta.py`) is unstable beyond a known step. Where accuracy would
allow several times as long a one, a linearly implicit step is tried; the others are explicit.
"""

from typing import NamedTuple

from solar_env.mechanics.arrays.model import Model, State
from solar_env.mechanics.equations.newton import fill_mass
from solar_env.mechanics.equations.system import make_workspace
from solar_env.mechanics.integrators.methods.rosenbrock_stages import NEVER, LinearStep, make_linear_step
from solar_env.mechanics.integrators.methods.rosenbrock_step import attempt_implicit
from solar_env.mechanics.integrators.methods.runge_kutta import (
    STABILITY_MARGIN,
    STAGES,
    StiffForces,
    attempt_explicit,
    error_norm,
    make_stiff_forces,
    stable_step,
)
from solar_env.mechanics.integrators.methods.stage_steps import begin_stages
from solar_env.mechanics.integrators.methods.stages import StageArrays, StageSettings, make_stage_arrays
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.linear import copy_into
from solar_env.mechanics.numerics.profile import clear
from solar_env.mechanics.numerics.step_size import StepController, growth

# A linearly implicit step is taken if it is so many times as long as the stable explicit one. It costs five times as
# much, but the explicit method's estimate sees the stiff vibrations too and promises less than can be had.
_WORTH = 2.5
# Its error is dissipation of vibrations that it does not resolve, which the energy book lacks: hence a stricter
# tolerance.
_STRICTER = 2.0
# After a try that has failed the next one waits for twice as many explicit steps, up to so many.
_LONGEST_WAIT = 256
# Of steps that accuracy alone would bound.
_CONTROL = StepController(4.0)

# While a flexible mechanism moves more slowly than its velocity scale over _SLOW, the scale shrinks with the square of
# its speed, to _LEAST_SCALE at most: impacts amplify errors, and those of the first, slow impacts grow for longest.
_SLOW = 0.5
_LEAST_SCALE = 1e-3


class RosenbrockSettings(StageSettings):
    """Settings of this method."""


class RosenbrockArrays(NamedTuple):
    """Scratch arrays of the method besides the stages."""

    stiff: StiffForces
    step: LinearStep


def make_rosenbrock_arrays(model: Model, state: State) -> StageArrays:
    """Allocate the arrays for a mechanism."""
    work = make_workspace(model, state)
    extra = RosenbrockArrays(make_stiff_forces(state), make_linear_step(model, state, work))
    return make_stage_arrays(model, state, STAGES, work, extra)


@kernel(single_caller=True)
def present_velocity_scale(velocity_scale, weights, v0, v):
    """Velocity scale [m/s] for the present speed of a flexible mechanism."""
    top = 0.0
    for i in range(v.size):
        top = max(top, weights[i] * max(abs(v0[i]), abs(v[i])))
    return velocity_scale * min(1.0, max((_SLOW * top / velocity_scale) ** 2, _LEAST_SCALE))


@kernel(inner=True)
def begin_rosenbrock(model, state, settings, arrays):
    """Prepare a call, without what other lanes and calls have left; False if constraints are singular."""
    extra = arrays.extra
    extra.stiff.active[0] = 0
    extra.step.linearized[0] = NEVER
    clear(model.elimination, extra.step.newton.mass)
    fill_mass(model, extra.step.newton.mass)
    return begin_stages(model, state, settings, arrays)


@kernel(inner=True)
def choose_rosenbrock(model, state, settings, arrays, wanted, remaining):
    """Step to try [s] if `wanted` is what accuracy, impacts and the settings allow, and whether linearly implicit."""
    trial = arrays.trial[0]
    implicit = state.clock[0].explicit_wait <= 0 and wanted > _WORTH * (STABILITY_MARGIN * model.stable_step)
    trial.implicit = implicit
    return wanted if implicit else stable_step(model, trial, wanted)


@kernel(inner=True)
def attempt_rosenbrock(model, state, settings, arrays, h):
    """Fill a step `h`, its end going to `stages`; its error in units of the tolerance, negative if singular."""
    work, stages, extra = arrays.work, arrays.stages, arrays.extra
    if arrays.trial[0].implicit:
        error = _STRICTER * attempt_implicit(model, state, stages, extra.step, work, settings, h)
        if 0.0 <= error <= 1.0:
            copy_into(state.multipliers, stages.multipliers)
        return error
    if not attempt_explicit(model, state, arrays, h):
        return -1.0
    velocity_scale = settings.velocity_scale
    if model.flexible:
        velocity_scale = present_velocity_scale(velocity_scale, model.error_weight, state.v, stages.v)
    return error_norm(model, state, arrays, settings.rtol, velocity_scale, h)


@kernel(inner=True)
def adapt_rosenbrock(model, state, arrays, accepted):
    """Choose when a linearly implicit step is tried next, once the next step's size is set."""
    clock, trial = state.clock[0], arrays.trial[0]
    if accepted:
        clock.explicit_wait -= not trial.implicit
        if trial.implicit:
            clock.explicit_patience = 0
        if trial.bound and not trial.last:
            # What accuracy alone would allow.
            clock.step_size = max(clock.step_size, trial.wanted * growth(_CONTROL, trial.error, 1.0))
    elif trial.implicit and clock.step_size <= _WORTH * (STABILITY_MARGIN * model.stable_step):
        clock.explicit_patience = min(max(2 * clock.explicit_patience, 4), _LONGEST_WAIT)
        clock.explicit_wait = clock.explicit_patience
