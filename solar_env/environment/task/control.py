"""When an array has latched for good, and when its episode is over: for what observes, charges and ends."""

import math

from solar_env.mechanics.numerics.jit import kernel


@kernel
def last_latch(joint_states):
    """Time of the last latching [s], or nan while a joint is open."""
    latest = -math.inf
    for j in range(joint_states.size):
        if not joint_states[j].latched:
            return math.nan
        latest = max(latest, joint_states[j].latch_time)
    return latest


@kernel
def all_latched(joint_states):
    """Whether no joint is open."""
    return not math.isnan(last_latch(joint_states))


@kernel
def end_of_episode(state, task):
    """Time at which the episode ends if nothing more latches [s]."""
    latched_at = last_latch(state.joints)
    return latched_at + task.settling_window if latched_at == latched_at else task.last_chance


@kernel
def missed_deadline(state, task):
    """Whether a joint is still open when the time for it is up."""
    return not all_latched(state.joints) and state.clock[0].time >= task.last_chance
