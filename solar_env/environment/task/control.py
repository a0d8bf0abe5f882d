"""Time of the last latching and end of the episode, as observations, charges and termination take them."""

import math

from solar_env.mechanics.numerics.jit import kernel


@kernel
def last_latch(joint_states):
    """Return the time of the last latching [s], or nan while a joint is open."""
    latest = -math.inf
    for j in range(joint_states.size):
        if not joint_states[j].latched:
            return math.nan
        latest = max(latest, joint_states[j].latch_time)
    return latest


@kernel
def all_latched(joint_states):
    """Return whether no joint is open."""
    return not math.isnan(last_latch(joint_states))


@kernel
def end_of_episode(state, task):
    """Return the time at which the episode ends if nothing more latches [s]."""
    latched_at = last_latch(state.joints)
    return latched_at + task.settling_window if latched_at == latched_at else task.last_chance


@kernel
def missed_deadline(state, task):
    """Return whether a joint is still open when the time for its latching is up."""
    return not all_latched(state.joints) and state.clock[0].time >= task.last_chance
