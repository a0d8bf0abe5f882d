"""Time of the last latching, and end of the episode, for observations, rewards and termination."""

import math

from solar_env.mechanics.numerics.jit import kernel


@kernel
def last_latch(joint_states):
    """Return the time [s] at which the last joint latched, or nan while a joint is open."""
    latest = -math.inf
    for j in range(joint_states.size):
        if not joint_states[j].latched:
            return math.nan
        latest = max(latest, joint_states[j].latch_time)
    return latest


@kernel
def all_latched(joint_states):
    """Return whether every joint has latched."""
    return not math.isnan(last_latch(joint_states))


@kernel
def end_of_episode(state, task):
    """Return the time [s] at which the episode ends if no further joint latches."""
    latched_at = last_latch(state.joints)
    return latched_at + task.settling_window if latched_at == latched_at else task.last_chance


@kernel
def missed_deadline(state, task):
    """Return whether a joint is open although the time has reached `task.last_chance`, the time limit for latching."""
    return not all_latched(state.joints) and state.clock[0].time >= task.last_chance
