"""Control of the step of generalized-alpha: the step to try, and whether to accept what it gave.

Fixed steps divide a call evenly. Adaptive steps follow the change of the accelerations, and are shortened to end near a
bearing wall when a contact begins that they would not resolve.
"""

import math

from solar_env.mechanics.arrays.columns import ECCENTRICITY_X, ECCENTRICITY_Y
from solar_env.mechanics.arrays.model import CLEARANCE
from solar_env.mechanics.equations.system import normal_inverse_mass
from solar_env.mechanics.joints.contact.normal_force import impact_scales
from solar_env.mechanics.joints.joint import penetration, relative
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.linear import greater
from solar_env.mechanics.numerics.step_size import UNSOLVED, StepController, growth, shortened
from solar_env.mechanics.records.history import impact_step_limit

_CONTROL = StepController(2.0, least_share=0.2, most_growth=2.0)


@kernel(single_caller=True)
def error_norm(state, it, settings, h):
    """Local error in units of the tolerance, from the change of the accelerations (Zienkiewicz and Xie 1991).

    O. C. Zienkiewicz and Y. M. Xie, Earthq. Eng. Struct. Dyn. 20 (1991) 871, doi:10.1002/eqe.4290200907.
    Multipliers are left out.
    """
    worst = 0.0
    factor = abs(settings.beta - 1.0 / 6.0) * h
    for i in range(state.q.size):
        estimate = factor * abs(it.auxiliary[i] - state.algorithmic_a[i])
        scale = settings.rtol * (settings.velocity_scale + max(abs(state.v[i]), abs(it.v[i])))
        worst = greater(worst, estimate / scale)
    return worst


@kernel(single_caller=True)
def landing_step(model, state, it, scratch, settings, h):
    """A step that ends near the wall if a contact begins inside this one and `h` does not resolve it, else `h`."""
    joints, joint_states, markers = model.joints, state.joints, model.markers
    shorter = h
    for j in range(joints.size):
        joint = joints[j]
        if joint.kind != CLEARANCE or joint_states[j].in_contact:
            continue
        depth, _ = penetration(joint, markers, it.q, it.v)
        if depth <= 0.0:
            continue
        scratch.loads[j, ECCENTRICITY_X], scratch.loads[j, ECCENTRICITY_Y] = relative(joint, markers, it.q)
        inverse_mass = normal_inverse_mass(model, it.q, it.v, j, scratch)
        speed = max(it.depth_rate[j], joint.minimum_impact_speed)
        _, duration = impact_scales(joint, inverse_mass, speed)
        flight = -it.depth[j] / speed
        wanted = max(min(flight, 0.5 * h), duration / settings.impact_resolution)
        shorter = min(shorter, wanted)
    return shorter


@kernel(single_caller=True)
def next_step(state, settings, remaining):
    """Step to try: the fixed one, divided so that a whole number of them ends the call, or the controller's."""
    if settings.rtol == 0.0:
        return remaining / math.ceil(remaining / settings.step - 1e-9)
    clock = state.clock[0]
    wanted = clock.step_size if clock.step_size > 0.0 else settings.step
    wanted = min(wanted, settings.max_step, impact_step_limit(state, clock.time, settings.impact_resolution))
    if wanted >= remaining:
        return remaining
    # Two even steps rather than one followed by a sliver.
    return 0.5 * remaining if 2.0 * wanted > remaining else wanted


@kernel(single_caller=True)
def judge(model, state, it, scratch, settings, h, convergence):
    """Step to retry with, or 0 to accept. Sets the controller's next step."""
    clock = state.clock[0]
    clock.failure_value = convergence
    if not convergence <= 1.0:
        return UNSOLVED * h
    shorter = landing_step(model, state, it, scratch, settings, h)
    if shorter < h:
        return shorter
    error = error_norm(state, it, settings, h)
    clock.failure_value = error
    if not error <= 1.0:
        return shortened(_CONTROL, h, error)
    grow = growth(_CONTROL, error, 1.0)
    # A change of step costs a restart: keep the step unless much is gained.
    clock.step_size = max(clock.step_size, h * grow) if grow > 1.5 else h
    return 0.0
