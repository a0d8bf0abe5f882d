"""Adaptive steps that land on events: the control of steps that all adaptive methods share.

Events are roots of a step's own interpolant (`events.py`). Constraints are enforced on the acceleration level and by
projection of every accepted step.

During a step the contact mode of each joint is frozen, so that a step that runs into a bearing wall sees a smooth
vector field. The wall is then found as a root of the interpolant, the step is cut there at no further cost, and the
contact starts with its exact approach speed. Latchings are found in the same way. The steps of an impact are bounded
by a share of its duration, which impact speed and stiffness give beforehand.
"""

import math

from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.equations.constraints import fill_columns
from solar_env.mechanics.integrators.acceptance import accept, measure_depths, record_until
from solar_env.mechanics.integrators.events import first_event
from solar_env.mechanics.integrators.methods.table import adapt_of, attempt_of, begin_of, choose_of, complete_of
from solar_env.mechanics.integrators.step import refresh, set_impact_speeds
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.linear import copy_into
from solar_env.mechanics.numerics.step_size import StepController, growth, shortened
from solar_env.mechanics.records.history import check_state, fail, impact_step_limit

_SMALLEST_STEP = 1e-13  # s, relative to max(time, 1 s)
# Events may follow each other without time between them, but not for ever.
_MOST_EVENTS_AT_ONCE = 1000


@kernel(single_caller=True)
def prepare_arrays(model, settings, arrays):
    """Fill what the scratch arrays hold of a model.

    Stages are cleared too: those that a step has not come to yet enter with the weight zero, which does not take away
    what is not finite.
    """
    stages = arrays.stages
    for array in (stages.velocity, stages.acceleration, stages.power):
        for s in range(array.shape[0]):
            for i in range(array.shape[1]):
                array[s, i] = 0.0
    for work in (arrays.work, arrays.scratch):
        for r in range(work.row_value.shape[0]):
            copy_into(work.row_value[r], model.constraints.value[r])
        fill_columns(model, work, False)
    stages.trial[0].at_once = 0
    stages.trial[0].stiff_contacts = 0
    begin_of(settings)(model, arrays.own)


@kernel(inner=True)
def begin_adaptive(model, state, settings, recorder, arrays):
    """Prepare a call, from the accelerations of the last one where they hold, and record its start; a status code."""
    prepare_arrays(model, settings, arrays)
    work, scratch, stages = arrays.work, arrays.scratch, arrays.stages
    clock = state.clock[0]
    set_impact_speeds(state.joints, work.impact_speeds)
    if clock.acceleration_current == m.EXACT or clock.acceleration_current == m.APPROXIMATE:
        copy_into(stages.acceleration[0], state.a)
        copy_into(stages.power[0], state.power)
    elif not refresh(model, state, stages, work):
        return fail(state, m.SINGULAR_CONSTRAINTS, -1, 0.0)
    copy_into(stages.velocity[0], state.v)
    measure_depths(model, state, stages)
    if recorder.times.size > 0:
        copy_into(scratch.impact_speeds, work.impact_speeds)
        record_until(model, state, settings, stages, scratch, recorder, 0.0, clock.time)
    if clock.step_size <= 0.0:
        clock.step_size = 1e-6
        clock.last_error = 1.0
    return m.DONE


@kernel(single_caller=True)
def choose_step(model, state, settings, stages, end_time):
    """Fill the trial with the step to take: what accuracy, impacts, the method and the end of the call allow."""
    clock, trial = state.clock[0], stages.trial[0]
    trial.bound = trial.implicit = trial.stiff_contacts = 0
    limit = min(settings.max_step, impact_step_limit(state, clock.time, settings.impact_resolution))
    wanted = choose_of(settings)(model, state, stages, min(clock.step_size, limit))
    trial.wanted = wanted
    trial.last = clock.time + wanted >= end_time
    trial.step = end_time - clock.time if trial.last else wanted


@kernel(inner=True)
def controller_of(settings):
    """The controller of the step size, by proportional and integral control of the error."""
    return StepController(settings.order, 0.72, 0.4, 1e-10, 0.1, 10.0)


@kernel(single_caller=True)
def reject(model, state, settings, stages):
    """Shorten the next step after one whose error is too large; a status code."""
    clock, trial = state.clock[0], stages.trial[0]
    error = trial.error
    clock.rejected_steps += 1
    clock.step_size = shortened(controller_of(settings), trial.step, error)
    adapt_of(settings)(model, state, stages, False)
    if not clock.step_size > _SMALLEST_STEP * max(1.0, abs(clock.time)):
        return fail(state, m.STEP_TOO_SMALL if math.isfinite(error) else m.NOT_FINITE, -1, error)
    return m.DONE


@kernel(single_caller=True)
def choose_next(model, state, settings, stages):
    """Set the next step's size after an accepted one."""
    clock, trial = state.clock[0], stages.trial[0]
    grow = growth(controller_of(settings), trial.error, clock.last_error)
    clock.last_error = max(trial.error, 1e-4)
    # A step that was cut short by the end of the call or by an event says little about the next one.
    if not trial.last:
        clock.step_size = trial.wanted * max(grow, 0.2)
    else:
        clock.step_size = max(trial.wanted, trial.step * grow)
    clock.stability_bound_steps += trial.bound
    adapt_of(settings)(model, state, stages, True)


@kernel(inner=True)
def take_adaptive_step(model, state, settings, recorder, end_time, arrays):
    """Try a step towards `end_time` [s], and take it if its error allows, up to its first event; a status code."""
    stages, clock, trial = arrays.stages, state.clock[0], arrays.stages.trial[0]
    choose_step(model, state, settings, stages, end_time)
    h = trial.step
    trial.error = attempt_of(settings)(model, state, settings, arrays, h)
    if trial.error < 0.0:
        return fail(state, m.SINGULAR_CONSTRAINTS, -1, 0.0)
    if not trial.error <= 1.0:
        return reject(model, state, settings, stages)
    if not complete_of(settings)(model, state, arrays, recorder, h):
        return fail(state, m.SINGULAR_CONSTRAINTS, -1, 0.0)
    share, event_joint, kind = first_event(model, state, settings, stages, arrays.work, h)
    end = clock.time + share * h
    trial.at_once = 0 if end > clock.time else trial.at_once + 1
    if trial.at_once > _MOST_EVENTS_AT_ONCE:
        return fail(state, m.EVENTS_PILE_UP, event_joint, float(trial.at_once))
    if not accept(model, state, settings, arrays, recorder, share, end, event_joint, kind):
        return fail(state, m.SINGULAR_CONSTRAINTS, -1, 0.0)
    if trial.last and share == 1.0:
        clock.time = end_time
    choose_next(model, state, settings, stages)
    return check_state(model, state, arrays.work.loads)
