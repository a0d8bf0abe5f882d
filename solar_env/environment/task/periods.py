"""Beginning and end of a control period, lane by lane; a single environment is a batch of one lane."""

from solar_env.environment.task.control import begin_period, begin_sample, has_ended
from solar_env.environment.task.observations import observe
from solar_env.environment.task.reward import charge
from solar_env.mechanics.arrays.lanes import lane_view
from solar_env.mechanics.numerics.jit import kernel


@kernel
def begin_periods(states, task, lanes, end_times):
    """Begin a control period in the lanes (k,) named; its ends (lanes,) [s] are written."""
    for lane in lanes:
        end_times[lane] = begin_period(lane_view(states, lane), task)


@kernel
def begin_samples(models, states, task, lanes, actions, rate_errors, loop_torques, end_times, sample_ends):
    """Set the motor torques of the lanes (k,) named until the drives' next sample.

    Args:
        models, states: arrays of all lanes.
        task: TaskNumbers.
        lanes: (k,) indices.
        actions, rate_errors, loop_torques: (lanes, motors) as `control.begin_sample` has them; the last are updated.
        end_times: (lanes,) ends of the control period [s].
        sample_ends: (lanes,) times of the next samples [s]; written.
    """
    for lane in lanes:
        model, state = lane_view(models, lane), lane_view(states, lane)
        sample_ends[lane] = begin_sample(
            model, state, task, actions[lane], rate_errors[lane], loop_torques[lane], end_times[lane]
        )


@kernel
def end_periods(models, states, task, channels, prices, lanes, accounts, terms, rewards, observations, terminated):
    """Charge and observe a period that has ended in the lanes (k,) named.

    Args:
        models, states: arrays of all lanes.
        task: TaskNumbers.
        channels: (measured,) of `observations.channels`.
        prices: (terms,) of `reward.Reward`.
        lanes: (k,) indices.
        accounts: (lanes, terms, 2) of `reward.charge`; updated.
        terms: (lanes, terms) of the reward; written, as is all that follows.
        rewards: (lanes,) their sums.
        observations: (lanes, measured) float32.
        terminated: (lanes,) whether the episode has ended.
    """
    for lane in lanes:
        model, state = lane_view(models, lane), lane_view(states, lane)
        rewards[lane] = charge(model, state, task, prices, accounts[lane], terms[lane])
        observe(model, state, task, channels, observations[lane])
        terminated[lane] = has_ended(state, task)


@kernel
def observe_lanes(models, states, task, channels, lanes, observations):
    """Observe the present state of the lanes (k,) named; observations are by lane."""
    for lane in lanes:
        observe(lane_view(models, lane), lane_view(states, lane), task, channels, observations[lane])
