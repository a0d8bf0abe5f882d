"""When an array has latched for good, and when its deadline is missed: for what observes, charges and ends."""

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
def missed_deadline(state, task):
    """Whether a joint is still open at the deadline."""
    latched_at = last_latch(state.joints)
    return latched_at != latched_at and state.clock[0].time >= task.deadline
