"""Kernels of the integration method `ModalRadau` for the run loop: try a step, interpolate in it, accept it.

A step is a pure function of accepted state and step size. A step with an event inside is solved again up to the event.
"""

import math
from typing import Any

import numpy as np

from solar_env.mechanics.arrays.columns import ANGLE, ECCENTRICITY_X, ECCENTRICITY_Y, RATE
from solar_env.mechanics.arrays.model import CLEARANCE, EXACT, IDEAL, NEWTON_STALLED, SINGULAR_CONSTRAINTS
from solar_env.mechanics.joints.contact import friction_share, normal_force
from solar_env.mechanics.modal.acceptance import commit_step, keep_loads, note_extremes, step_error
from solar_env.mechanics.modal.arrays import (
    CABLE_LOADS,
    DEPTH,
    DEPTH_RATE,
    NORMAL_X,
    NORMAL_Y,
    RIGID_BODY,
    SLIDING_SPEED,
    VELOCITY_X,
    VELOCITY_Y,
)
from solar_env.mechanics.modal.books import add_integrals, cubic
from solar_env.mechanics.modal.equations import torque_laws
from solar_env.mechanics.modal.motion import force_of, look_at, start_from_end
from solar_env.mechanics.modal.solve import ModalSettings, solve_step
from solar_env.mechanics.modal.tables import (
    AXIAL_EVEN,
    GROUPS,
    LAST,
    LEVELS,
    fill_level,
    level_below,
    level_size,
)
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.linear import copy_into
from solar_env.mechanics.numerics.step_size import UNSOLVED, StepController
from solar_env.mechanics.numerics.vectors import splat4, store4
from solar_env.mechanics.records.history import step_limit

CONTROL = StepController(5.0, most_growth=4.0, memory=0.25)
_FIRST_STEP = 1e-4  # s, first step of a run
# Level in tables of a single step size. Its type is the type of other levels: another type would recompile kernels.
_CUT = np.int64(0)
_OFF_TABLE = np.int64(-1)  # value of `trial.level` for a step size that is not tabled
_DEPTH_TOLERANCE = 0.1  # depth tolerance of a step, relative to the depth, divided by rtol


def convert_settings(chosen: Any) -> ModalSettings:
    """Convert settings of the integration method `ModalRadau` to the types that kernels take."""
    return ModalSettings(
        float(chosen.rtol),
        float(chosen.velocity_scale),
        float(chosen.rtol * _DEPTH_TOLERANCE),
        float(chosen.max_step),
        float(chosen.impact_resolution),
    )


@kernel
def set_load(state, k, load):
    """Fill row `k` of `state.course`, the values of a load at the last step's stages, with the constant `load`."""
    store4(state.course[k], 0, splat4(load))


@kernel(inlined=False)
def start_loads(model, state, work):
    """Compute joint angles, contact depths and loads from coordinates and velocities, and write them to `state`."""
    look_at(model, state.q, state.v, work)
    start_from_end(model, state, state.q, work)
    note_extremes(model, state, work, state.v)
    torque_laws(model, state, work)
    for k in range(model.joints.size + CABLE_LOADS * model.cables.size):
        set_load(state, k, work.loads[k].law[LAST])
    take_motion(model, state, work)


@kernel
def take_motion(model, state, work):
    """Copy contact depths, joint angles and rates to `work.motion`, and motion for controllers to `state.views`."""
    for j in range(model.joints.size):
        motion, place, view = work.motion[j], state.motion[j], state.views[j]
        motion.depth, motion.depth_rate = place[DEPTH], place[DEPTH_RATE]
        motion.angle, motion.rate = place[ANGLE], place[RATE]
        inboard = state.placements[model.joints[j].inboard].direction
        view[0], view[1], view[2], view[3] = place[ANGLE], place[RATE], inboard[0], inboard[1]
        view[4], view[5] = place[ECCENTRICITY_X], place[ECCENTRICITY_Y]


@kernel
def begin_modal(model, state, settings, work):
    """Copy motion and loads of `state` to `work` before time stepping, set a first step size if unset; return True."""
    clock = state.clock[0]
    start_at_state(state, work)
    for k in range(work.loads.size):
        store4(work.loads[k].stage, 0, splat4(state.course[k, LAST]))
    take_motion(model, state, work)
    if clock.step_size <= 0.0:
        clock.step_size = _FIRST_STEP
        clock.last_error = 1.0
    return True


@kernel
def start_at_state(state, work):
    """Copy coordinates, velocities, and time integrals of powers and forces, from `state` to `work`."""
    copy_into(work.q, state.q)
    copy_into(work.v, state.v)
    copy_into(work.integrals, state.integrals)


@kernel
def choose_modal(model, state, settings, work, remaining):
    """Return the step to try [s]: the greatest tabled size that accuracy, impacts and settings allow.

    Tables hold panels' responses by step size. If the step would take (nearly) all of the `remaining` time [s], return
    at least that time; the run loop cuts the step to it. Store the size's index in `work.trial`, or -1 if not tabled.
    """
    wanted = step_limit(state, settings)
    level = level_below(wanted)
    h = level_size(level) if level < LEVELS else wanted
    # Take the remaining time at once if a step would leave only a sliver of it.
    last = remaining <= max(wanted, 1.05 * h)
    work.trial[0].level = _OFF_TABLE if last or level == LEVELS else level
    return max(wanted, remaining) if last else h


@kernel
def tables_of(model, work):
    """Return the tables with the modes' responses for the trial step's size, and the index of this size in them."""
    if work.trial[0].level == _OFF_TABLE:
        return work.tables, _CUT
    return model.tables, work.trial[0].level


@kernel
def attempt_modal(model, state, settings, work, h):
    """Solve a trial step `h` [s]; return error / tolerance: 0 if it was cut at an event, infinite if unsolved."""
    trial = work.trial[0]
    if trial.cuts > 0:
        trial.level = _OFF_TABLE
    if trial.level == _OFF_TABLE:
        fill_level(model.panels, work.tables, _CUT, h)
    tables, level = tables_of(model, work)
    if not solve_step(model, state, work, settings, tables, level, h):
        trial.retry, trial.reason = UNSOLVED * h, NEWTON_STALLED if trial.joint >= 0 else SINGULAR_CONSTRAINTS
        return math.inf
    return 0.0 if trial.cuts > 0 else step_error(model, state, work, settings, tables, level, h)


@kernel
def depth_of_modal(model, state, work, j, h, share):
    """Return joint `j`'s penetration [m] at a fraction `share` of the step, from cubics between the step's ends."""
    ex = along(state, work, j, ECCENTRICITY_X, VELOCITY_X, h, share)
    ey = along(state, work, j, ECCENTRICITY_Y, VELOCITY_Y, h, share)
    return math.sqrt(ex * ex + ey * ey) - model.joints[j].clearance


@kernel
def angle_of_modal(model, state, work, j, h, share):
    """Return joint `j`'s angle [rad] at a fraction `share` of the step, from a cubic between the step's ends."""
    return along(state, work, j, ANGLE, RATE, h, share)


@kernel
def along(state, work, j, value, rate, h, share):
    """Return a quantity of joint `j`'s motion at fraction `share` of a step `h` [s], from a cubic that fits both ends.

    Columns `value` and `rate` of the motion have the quantity and its rate, at the start in `state`, the end in `work`.
    """
    start, end = state.motion[j], work.joints[j].motion
    return cubic(share, start[value], h * start[rate], end[value, LAST], h * end[rate, LAST])


@kernel
def complete_modal(model, state, settings, work, h):
    """Write the solved step's end to `work` (coordinates, velocities, works, impulses) and `state` (joint motion)."""
    start_at_state(state, work)
    tables, level = tables_of(model, work)
    commit_step(model, state, work, tables, level, h)
    add_integrals(model, state, work, h)
    # Samples inside the step overwrite this scratch afterwards.
    start_from_end(model, state, work.q, work)


@kernel
def commit_modal(model, state, settings, work, h, share):
    """Move `state` to the end of the solved step `h` [s]; return True. Its accepted fraction, `share`, is always 1."""
    copy_into(state.q, work.q)
    copy_into(state.v, work.v)
    copy_into(state.integrals, work.integrals)
    keep_loads(state, work)
    state.clock[0].last_step = h
    state.clock[0].acceleration_current = EXACT
    take_motion(model, state, work)
    return True


@kernel
def evaluate_modal(model, state, work, changed):
    """Write normal contact forces and ideal joints' reactions [N] to `work.motion`; ignore `changed`; return True."""
    for j in range(model.joints.size):
        first, second = state.course[force_of(model, j), LAST], state.course[force_of(model, j) + 1, LAST]
        ideal = model.joints[j].kind == IDEAL
        work.motion[j].force = math.sqrt(first * first + second * second) if ideal else first
    return True


@kernel
def contact_arcs(model, state, work, j):
    """Return the arcs (middle, half angle) [rad] of journal and bearing along which joint `j` slid in the step."""
    journal, bearing = work.joints[j].arcs[0], work.joints[j].arcs[1]
    return (journal[0], journal[1]), (bearing[0], bearing[1])


@kernel
def instantaneous_inverse_mass(model, state, j):
    """Return joint `j`'s inverse effective mass [1/kg] along its line of centres at the first instant of an impact."""
    motion, joint = state.motion[j], model.joints[j]
    nx, ny, total = motion[NORMAL_X], motion[NORMAL_Y], 0.0
    for side in range(2):
        number = joint.outboard if side == 0 else joint.inboard
        attachment = model.attachments[number]
        b = attachment.body
        body = model.bodies[b]
        arm = state.placements[number].arm
        lever = arm[0] * ny - arm[1] * nx
        total += body.inverse_mass + lever * lever * body.inverse_inertia
        if body.panel != RIGID_BODY:
            c, s = state.turns[b, 0], state.turns[b, 1]
            along, across = c * nx + s * ny, c * ny - s * nx
            for group in range(GROUPS):
                share = across if group < AXIAL_EVEN else along
                for k in range(model.panels.first[group], model.panels.first[group + 1]):
                    total += (model.panels.shapes[body.design, 0, k] * share) ** 2
    return total


@kernel
def open_contact(model, state, work, j):
    """Write joint `j`'s new contact forces to `state.course`, and return the contact's inverse effective mass [1/kg].

    This array has loads at the last step's stages, from which the next step extrapolates; all stages get the same.
    """
    joint, motion = model.joints[j], state.motion[j]
    # The loads matter where a run starts with a journal that is pressed into its bearing.
    normal, _, _, _ = normal_force(joint, motion[DEPTH], motion[DEPTH_RATE], state.joints[j].impact_speed)
    share, _ = friction_share(joint, motion[SLIDING_SPEED])
    k = force_of(model, j)
    set_load(state, k, normal)
    set_load(state, k + 1, -joint.friction_coefficient * share * normal)
    return instantaneous_inverse_mass(model, state, j)


@kernel
def resume_modal(model, state, work):
    """Set the forces of clearance joints out of contact to zero in `state.course`, which the next step extrapolates."""
    for j in range(model.joints.size):
        if model.joints[j].kind == CLEARANCE and not state.joints[j].in_contact:
            for k in range(force_of(model, j), force_of(model, j) + 2):
                set_load(state, k, 0.0)
