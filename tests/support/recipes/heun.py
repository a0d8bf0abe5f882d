"""Explicit method of order two of K. Heun, Z. Math. Phys. 45 (1900) 23."""

from solar_env.mechanics.arrays.model import EXACT, Model, State
from solar_env.mechanics.equations.system import accelerations, make_workspace
from solar_env.mechanics.integrators.methods.stages import StageArrays, StageSettings, make_stage_arrays, refresh
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.linear import copy_into, greater

# Weights of the first two stages in the second one, Euler's step, and in the end of the step.
_COUPLING = ((0.0, 0.0), (1.0, 0.0), (0.5, 0.5))


class HeunSettings(StageSettings):
    """Settings of this method."""


def make_heun_arrays(model: Model, state: State) -> StageArrays:
    """Allocate the arrays for a mechanism."""
    return make_stage_arrays(model, state, len(_COUPLING), make_workspace(model, state), ())


@kernel(inner=True)
def choose_heun(model, state, settings, arrays, wanted, remaining):
    """Step to try [s]: the one ``wanted``, for the error estimate alone bounds it."""
    return wanted


@kernel(inner=True)
def attempt_heun(model, state, settings, arrays, h):
    """Fill a step ``h``; its error in units of the tolerance, negative if constraints are singular."""
    work, stages, weights, rtol, worst = arrays.work, arrays.stages, model.error_weight, settings.rtol, 0.0
    q, v, velocity, acceleration, power = stages.q, stages.v, stages.velocity, stages.acceleration, stages.power
    if state.clock[0].acceleration_current != EXACT and not refresh(model, state, stages, work):
        return -1.0
    for s in range(1, 3):
        w0, w1 = _COUPLING[s]
        for i in range(q.size):
            q[i] = state.q[i] + h * (w0 * velocity[0, i] + w1 * velocity[1, i])
            v[i] = state.v[i] + h * (w0 * acceleration[0, i] + w1 * acceleration[1, i])
        copy_into(velocity[s], v)
        end = state.clock[0].time + h
        if not accelerations(model, state.joints, q, v, end, work, acceleration[s], state.multipliers):
            return -1.0
        copy_into(power[s], work.power)
    for k in range(stages.gain.size):
        stages.gain[k] = h * (0.5 * power[0, k] + 0.5 * power[1, k])
    # Euler's step differs by an error of order two.
    for i in range(q.size):
        dq, dv = velocity[1, i] - velocity[0, i], acceleration[1, i] - acceleration[0, i]
        scale = settings.velocity_scale + weights[i] * abs(v[i])
        worst = greater(worst, 0.5 * h * weights[i] / rtol * max(abs(dq) / model.length_scale, abs(dv) / scale))
    state.clock[0].evaluations += 2
    return worst
