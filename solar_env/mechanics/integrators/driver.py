"""The driver of a run: one loop for all methods, and lanes that advance one after the other."""

from solar_env.mechanics.arrays.lanes import lane_view, take_ticket
from solar_env.mechanics.arrays.model import DONE, PAUSED, TOO_MANY_STEPS
from solar_env.mechanics.integrators.adaptive import begin_adaptive, take_adaptive_step
from solar_env.mechanics.integrators.methods.table import kernel_of
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.records.recording import pause_due

_begin_call = kernel_of(lambda kernels: getattr(kernels, "begin_call", begin_adaptive))
_take_step = kernel_of(lambda kernels: getattr(kernels, "take_step", take_adaptive_step))


@kernel(single_caller=True)
def advance(model, state, settings, recorder, end_time, arrays):
    """Advance `state` in place to `end_time` [s], by at most `settings.max_steps` steps; returns a status code.

    A call that stops for the number of its steps lands on nothing: the next one goes on to the same bits.
    """
    clock = state.clock[0]
    status = _begin_call(settings)(model, state, settings, recorder, arrays)
    taken = 0
    while status == DONE and clock.time < end_time:
        if pause_due(recorder, clock.time, model.joints.size):
            return PAUSED
        if taken >= settings.max_steps:
            return TOO_MANY_STEPS
        taken += 1
        status = _take_step(settings)(model, state, settings, recorder, end_time, arrays)
    return status


@kernel
def advance_lanes(models, states, settings, recorder, queue, counter, end_times, statuses, arrays):
    """Advance lanes one after the other, next to other threads that do the same.

    Args:
        models, states: of all lanes (`lanes.py`).
        settings: of the method as the kernels take them; their type chooses the method.
        recorder: takes samples and contacts of every lane.
        queue: (k,) indices of the lanes to advance, in this order.
        counter: (1,) number of lanes in the queue that some thread has begun with.
        end_times: (lanes,) [s].
        statuses: (lanes,) status codes; written.
        arrays: the thread's own.
    """
    while True:
        ticket = take_ticket(counter)
        if ticket >= queue.size:
            break
        lane = queue[ticket]
        model, state = lane_view(models, lane), lane_view(states, lane)
        statuses[lane] = advance(model, state, settings, recorder, end_times[lane], arrays)
