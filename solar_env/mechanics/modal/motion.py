"""Motion of bodies, joints and cable loops at the stages of a step, computed from the loads on the bodies.

Vectors have a lane for each stage, or equal lanes for one configuration. A cable loop runs over the inner wheel at a
body's inboard joint and the outer wheel at its outboard joint. The wheels' angles are measured from its chord, the line
between these joints (`joints/cable_loop.py`). A loop's load is its torque on the outer wheel. If the loop conserves
energy, its power is minus this torque times the rate of the wheels' mismatch, ratio * (inner angle) - (outer angle).
"""

import math

import numpy as np

from solar_env.mechanics.arrays.columns import ANGLE, ECCENTRICITY_X, ECCENTRICITY_Y, INBOARD_SPIN, OUTBOARD_SPIN, RATE
from solar_env.mechanics.arrays.model import CLEARANCE, IDEAL
from solar_env.mechanics.joints.contact import contact_motion
from solar_env.mechanics.modal.arrays import (
    ACROSS_X,
    ACROSS_Y,
    CABLE_LOADS,
    DEPTH,
    DEPTH_RATE,
    FACES,
    LENGTH,
    LEVER,
    NORMAL_X,
    NORMAL_Y,
    RIGID_BODY,
    SLIDING_SPEED,
    SLIP,
    STRETCH,
    VELOCITY_X,
    VELOCITY_Y,
    WHEEL_RATE,
)
from solar_env.mechanics.modal.ends import shorten_pose, sum_ends
from solar_env.mechanics.modal.tables import (
    AXIAL_EVEN,
    AXIAL_ODD,
    BENDING_EVEN,
    BENDING_ODD,
    GROUPS,
    LANES,
    LAST,
    NODES,
    STAGES,
    VALUES,
    A,
    B,
    side,
)
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.vectors import load4, load8, lower_half, splat4, square_roots, store4, upper_half

# Radau coefficients of velocity and position: a row for the stage of the load, a lane for the stage that it moves.
VELOCITY_BY_LOAD = np.array([[A[min(s, LAST)][k] for s in range(LANES)] for k in range(STAGES)])
PLACE_BY_LOAD = np.array([[B[min(s, LAST)][k] for s in range(LANES)] for k in range(STAGES)])
NODES_IN_LANES = np.array([NODES[min(s, LAST)] for s in range(LANES)])
_SMALL_TURN = 0.02  # rad, greatest angle at which the series of sine and cosine in `turn_body` hold all digits
_SMALL_SLOPE = 0.05  # greatest slope at which the arctangent's series in `chord_angle` holds all digits


@kernel
def add(target, vector):
    """Add a vector to the four numbers of the array `target`, in place."""
    store4(target, 0, load4(target, 0) + vector)


@kernel
def add_load(model, work, number, fx, fy, torque):
    """Add force (fx, fy) [N], torque [N m], vectors over stages, on attachment `number` to a body's loads in `work`."""
    attachment = model.attachments[number]
    body, arm = work.bodies[attachment.body], work.attachments[number].arm
    add(body.load[0], fx)
    add(body.load[1], fy)
    add(body.load[2], torque + load4(arm[0], 0) * fy - load4(arm[1], 0) * fx)
    p = model.bodies[attachment.body].panel
    if p != RIGID_BODY:
        load, odd = work.panels[p].load, side(attachment.end)
        c, s = load4(body.turn[0], 0), load4(body.turn[1], 0)
        along, across = c * fx + s * fy, c * fy - s * fx
        add(load[BENDING_EVEN, 0], across)
        add(load[BENDING_EVEN, 1], odd * torque)
        add(load[BENDING_ODD, 0], odd * across)
        add(load[BENDING_ODD, 1], torque)
        add(load[AXIAL_EVEN, 0], along)
        add(load[AXIAL_ODD, 0], odd * along)


@kernel
def outboard_load(joint, nx, ny, lever, first, second, torque):
    """Return a joint's force (x, y) [N] and torque [N m] on its outboard body, and its torque on the inboard body.

    The outboard body has the journal, the inboard body the bearing; returned torques are about these parts' centres. A
    positive argument `torque` raises the joint angle. `first` and `second` are components of the force on the journal:
    x and y in an ideal joint; with clearance, along -(nx, ny) and (-ny, nx). (nx, ny) is the unit vector from the
    bearing's to the journal's centre, and `lever` [m] the contact's distance from the bearing's centre. Arguments after
    `joint` are numbers, or vectors with a number for each stage of a step.
    """
    torque = joint.sign * torque
    if joint.kind == IDEAL:
        return first, second, torque, -torque
    return (
        -first * nx - second * ny,
        -first * ny + second * nx,
        torque + joint.journal_radius * second,
        -torque - lever * second,
    )


@kernel
def force_of(model, j):
    """Return the index in `work.loads` of the first component of joint `j`'s force; the second component follows."""
    return model.joints.size + CABLE_LOADS * model.cables.size + 2 * j


@kernel
def cable_attachment(model, cable, face):
    """Return the index in `model.attachments` of one of the four points on which a cable loop acts.

    `face` is 0 or 1 for the outer or inner wheel, 2 or 3 for the inner or outer end of the line between the joints.
    """
    if face == 0:
        return model.joints[cable.joint_b].outboard
    if face == 1:
        return model.joints[cable.joint_a].inboard
    return cable.first if face == 2 else cable.last


@kernel
def face_load(model, cable, across_x, across_y, length, face, torque, pull, ratio):
    """Return the force (x, y) [N] and torque [N m] that a cable loop exerts on one of its four attachments.

    `face` is 0 for the outer wheel, 1 for the inner wheel, 2 for the inner and 3 for the outer end of the chord, the
    line between the loop's joints. `torque` [N m] acts on the outer joint's angle, and -`ratio` * `torque` on the inner
    joint's angle. `pull` [N] draws the chord's ends together. (`across_x`, `across_y`) [1/m] is the unit vector across
    the chord, divided by its `length` [m]. Torque, pull, length and components may be vectors over the stages.
    """
    inner, outer = -ratio * torque * model.joints[cable.joint_a].sign, torque * model.joints[cable.joint_b].sign
    nothing, moment = 0.0 * torque, inner - outer
    if face == 0:
        return nothing, nothing, outer
    if face == 1:
        return nothing, nothing, -inner
    if cable.chord_sense == 0:
        return nothing, nothing, moment if face == 2 else nothing
    # The unit vector along the chord is (across_y, -across_x) times the length.
    along = pull * length
    fx, fy = moment * across_x - along * across_y, moment * across_y + along * across_x
    return (fx, fy, nothing) if face == 3 else (-fx, -fy, nothing)


@kernel
def distribute_loads(model, state, work):
    """Write the sums of joint and cable loads at the stages to `load` in records of `work.bodies`, `work.panels`."""
    nothing = splat4(0.0)
    for b in range(model.bodies.size):
        for i in range(3):
            store4(work.bodies[b].load[i], 0, nothing)
    for p in range(work.panels.size):
        panel = work.panels[p]
        for group in range(GROUPS):
            for i in range(VALUES):
                # Foreshortening's forces on the end values of the other modes load the ends.
                rest = panel.coupling[group, model.panels.coupled[group] + i]
                store4(panel.load[group, i], 0, load4(rest, 0) if group < AXIAL_EVEN else nothing)
    for j in range(model.joints.size):
        joint, first, motion = model.joints[j], force_of(model, j), work.joints[j].motion
        torque = load4(work.loads[j].stage, 0) + state.joints[j].motor_torque
        forces = load4(work.loads[first].stage, 0), load4(work.loads[first + 1].stage, 0)
        nx, ny, lever = load4(motion[NORMAL_X], 0), load4(motion[NORMAL_Y], 0), load4(motion[LEVER], 0)
        fx, fy, outboard, inboard = outboard_load(joint, nx, ny, lever, forces[0], forces[1], torque)
        add_load(model, work, joint.outboard, fx, fy, outboard)
        add_load(model, work, joint.inboard, -fx, -fy, inboard)
    for c in range(model.cables.size):
        cable, motion, k = model.cables[c], work.cables[c].motion, model.joints.size + c
        torque, pull = load4(work.loads[k].stage, 0), load4(work.loads[k + model.cables.size].stage, 0)
        x, y, length = load4(motion[ACROSS_X], 0), load4(motion[ACROSS_Y], 0), load4(motion[LENGTH], 0)
        for face in range(FACES):
            fx, fy, moment = face_load(model, cable, x, y, length, face, torque, pull, cable.torque_ratio)
            add_load(model, work, cable_attachment(model, cable, face), fx, fy, moment)


@kernel
def turn_body(start, angle, turn):
    """Write the unit vector `start` (2,), rotated by each angle in the vector `angle` [rad] (4,), to `turn` (2, 4)."""
    square, small = angle * angle, True
    store4(turn[0], 0, square)
    for s in range(STAGES):
        small = small and turn[0, s] < _SMALL_TURN * _SMALL_TURN
    if small:
        cosine = 1.0 - square * (0.5 - square * (1.0 / 24.0 - square * (1.0 / 720.0 - square * (1.0 / 40320.0))))
        sine = angle * (1.0 - square * (1.0 / 6.0 - square * (1.0 / 120.0 - square * (1.0 / 5040.0))))
    else:
        store4(turn[1], 0, angle)
        for s in range(LANES):
            turn[0, s], turn[1, s] = math.cos(turn[1, s]), math.sin(turn[1, s])
        cosine, sine = load4(turn[0], 0), load4(turn[1], 0)
    store4(turn[0], 0, start[0] * cosine - start[1] * sine)
    store4(turn[1], 0, start[1] * cosine + start[0] * sine)


@kernel
def stage_frames(model, state, work, h):
    """Compute bodies' positions, angles and rates at the stages of a step `h` [s] from the loads in `work.bodies`."""
    times = h * load4(NODES_IN_LANES, 0)
    for b in range(model.bodies.size):
        body, scratch = model.bodies[b], work.bodies[b]
        for i in range(3):
            inverse = body.inverse_mass if i < 2 else body.inverse_inertia
            pull = model.gravity[i] if i < 2 and inverse > 0.0 else 0.0
            speed = splat4(state.v[body.offset + i])
            place = times * speed + state.q[body.offset + i]
            for k in range(STAGES):
                gain = h * (scratch.load[i, k] * inverse + pull)
                place = place + (h * gain) * load4(PLACE_BY_LOAD[k], 0)
                speed = speed + gain * load4(VELOCITY_BY_LOAD[k], 0)
            store4(scratch.place[i], 0, place)
            store4(scratch.speed[i], 0, speed)
        turn_body(state.turns[b], load4(scratch.place[2], 0) - state.q[body.offset + 2], scratch.turn)


@kernel
def move_attachments(model, work):
    """Write the motion of the joints' points on bodies, at the stages of a time step, to `work.attachments`.

    A point's record gets its position and velocity, and the angle and angular velocity of the body at this point.
    """
    for number in range(model.attachments.size):
        attachment, scratch = model.attachments[number], work.attachments[number]
        body, panel = work.bodies[attachment.body], model.bodies[attachment.body].panel
        turn, spin = load4(body.place[2], 0), load4(body.speed[2], 0)
        x, y, x_rate, y_rate = splat4(attachment.x), splat4(attachment.y), splat4(0.0), splat4(0.0)
        if panel != RIGID_BODY:
            odd, ends = side(attachment.end), work.panels[panel].ends
            along = load8(ends[AXIAL_EVEN, 0], 0) + odd * load8(ends[AXIAL_ODD, 0], 0)
            across = load8(ends[BENDING_EVEN, 0], 0) + odd * load8(ends[BENDING_ODD, 0], 0)
            turning = odd * load8(ends[BENDING_EVEN, 1], 0) + load8(ends[BENDING_ODD, 1], 0)
            x, y, turn = x + lower_half(along), y + lower_half(across), turn + lower_half(turning)
            x_rate, y_rate, spin = upper_half(along), upper_half(across), spin + upper_half(turning)
        c, s, body_spin = load4(body.turn[0], 0), load4(body.turn[1], 0), load4(body.speed[2], 0)
        ax, ay = c * x - s * y, s * x + c * y
        store4(scratch.local[0], 0, x)
        store4(scratch.local[1], 0, y)
        store4(scratch.arm[0], 0, ax)
        store4(scratch.arm[1], 0, ay)
        store4(scratch.point[0], 0, load4(body.place[0], 0) + ax)
        store4(scratch.point[1], 0, load4(body.place[1], 0) + ay)
        store4(scratch.point_rate[0], 0, load4(body.speed[0], 0) - body_spin * ay + c * x_rate - s * y_rate)
        store4(scratch.point_rate[1], 0, load4(body.speed[1], 0) + body_spin * ax + s * x_rate + c * y_rate)
        store4(scratch.direction[0], 0, turn)
        store4(scratch.direction[1], 0, spin)


@kernel
def move_joints(model, work):
    """Write the joints' angles, eccentricities, contact depths and rates at the stages to `work.joints[j].motion`."""
    for j in range(model.joints.size):
        joint, motion = model.joints[j], work.joints[j].motion
        outboard, inboard = work.attachments[joint.outboard], work.attachments[joint.inboard]
        ex = load4(outboard.point[0], 0) - load4(inboard.point[0], 0)
        ey = load4(outboard.point[1], 0) - load4(inboard.point[1], 0)
        ux = load4(outboard.point_rate[0], 0) - load4(inboard.point_rate[0], 0)
        uy = load4(outboard.point_rate[1], 0) - load4(inboard.point_rate[1], 0)
        store4(motion[ECCENTRICITY_X], 0, ex)
        store4(motion[ECCENTRICITY_Y], 0, ey)
        store4(motion[VELOCITY_X], 0, ux)
        store4(motion[VELOCITY_Y], 0, uy)
        outboard_spin, inboard_spin = load4(outboard.direction[1], 0), load4(inboard.direction[1], 0)
        turn = load4(outboard.direction[0], 0) - load4(inboard.direction[0], 0)
        store4(motion[ANGLE], 0, joint.sign * (turn - model.folded_angle[j]))
        store4(motion[RATE], 0, joint.sign * (outboard_spin - inboard_spin))
        store4(motion[OUTBOARD_SPIN], 0, outboard_spin)
        store4(motion[INBOARD_SPIN], 0, inboard_spin)
        if joint.kind == CLEARANCE:
            contact = contact_motion(joint, ex, ey, ux, uy, outboard_spin, inboard_spin)
            store4(motion[LEVER], 0, contact.lever)
            store4(motion[NORMAL_X], 0, contact.normal_x)
            store4(motion[NORMAL_Y], 0, contact.normal_y)
            store4(motion[DEPTH], 0, contact.depth)
            store4(motion[DEPTH_RATE], 0, contact.rate)
            store4(motion[SLIP], 0, contact.slip)
            store4(motion[SLIDING_SPEED], 0, contact.sliding_speed)


@kernel
def chord_angle(cable, x, y, turn):
    """Add the angle of a cable loop's chord (line between its joints) in a body's frame to `turn` (4,) [rad], in place.

    `x` and `y` (4,) are the chord's components at a step's stages. If `cable.chord_sense` is -1, the chord is reversed.
    """
    small = True
    for s in range(STAGES):
        small = small and cable.chord_sense * x[s] > 0.0 and abs(y[s]) < _SMALL_SLOPE * abs(x[s])
    if small:
        slope = load4(y, 0) / load4(x, 0)
        square = slope * slope
        series = 1.0 / 5.0 - square * (1.0 / 7.0 - square * (1.0 / 9.0 - square * (1.0 / 11.0)))
        store4(turn, 0, load4(turn, 0) + slope * (1.0 - square * (1.0 / 3.0 - square * series)))
    else:
        for s in range(LANES):
            turn[s] += math.atan2(cable.chord_sense * y[s], cable.chord_sense * x[s])


@kernel
def move_cables(model, work):
    """Write the motion of each cable loop at a step's stages to `work.cables`.

    It is the mismatch of the wheels' angles, the inner wheel's rate, and the chord, the line between the joints.
    """
    for c in range(model.cables.size):
        cable, motion = model.cables[c], work.cables[c].motion
        inner, outer = work.joints[cable.joint_a].motion, work.joints[cable.joint_b].motion
        inner_angle, outer_angle, rate = load4(inner[ANGLE], 0), load4(outer[ANGLE], 0), load4(inner[RATE], 0)
        across_x = across_y = length = splat4(0.0)
        if cable.chord_sense != 0:
            a, b = model.joints[cable.joint_a], model.joints[cable.joint_b]
            near, far = work.attachments[a.outboard], work.attachments[b.inboard]
            first, last = work.attachments[cable.first], work.attachments[cable.last]
            x = load4(last.point[0], 0) - load4(first.point[0], 0)
            y = load4(last.point[1], 0) - load4(first.point[1], 0)
            carrier = work.bodies[model.attachments[a.outboard].body]
            c, s = load4(carrier.turn[0], 0), load4(carrier.turn[1], 0)
            store4(motion[ACROSS_X], 0, c * x + s * y)
            store4(motion[ACROSS_Y], 0, c * y - s * x)
            store4(motion[STRETCH], 0, load4(carrier.place[2], 0))
            chord_angle(cable, motion[ACROSS_X], motion[ACROSS_Y], motion[STRETCH])
            turn = load4(motion[STRETCH], 0)
            inner_angle = inner_angle + a.sign * (turn - load4(near.direction[0], 0))
            outer_angle = outer_angle - b.sign * (turn - load4(far.direction[0], 0))
            square = x * x + y * y
            across_x, across_y, length = -y / square, x / square, square_roots(square)
            spin = across_x * (load4(last.point_rate[0], 0) - load4(first.point_rate[0], 0))
            spin = spin + across_y * (load4(last.point_rate[1], 0) - load4(first.point_rate[1], 0))
            rate = rate + a.sign * (spin - load4(near.direction[1], 0))
        store4(motion[STRETCH], 0, cable.wheel_ratio * inner_angle - outer_angle)
        store4(motion[WHEEL_RATE], 0, rate)
        store4(motion[ACROSS_X], 0, across_x)
        store4(motion[ACROSS_Y], 0, across_y)
        store4(motion[LENGTH], 0, length)


@kernel(inlined=False)
def look_at(model, q, v, work):
    """Write the motion at coordinates `q` and velocities `v` to `work`, with equal numbers for all stages of a step."""
    for b in range(model.bodies.size):
        body, scratch, first = model.bodies[b], work.bodies[b], model.bodies[b].offset
        for i in range(3):
            store4(scratch.place[i], 0, splat4(q[first + i]))
            store4(scratch.speed[i], 0, splat4(v[first + i]))
        store4(scratch.turn[0], 0, splat4(math.cos(q[first + 2])))
        store4(scratch.turn[1], 0, splat4(math.sin(q[first + 2])))
        if body.panel != RIGID_BODY:
            panel = work.panels[body.panel]
            sum_ends(model.panels, panel, body.design, q[first + 3 :], v[first + 3 :])
            shorten_pose(model.panels, panel, body.design, q[first + 3 :], v[first + 3 :])
    move_attachments(model, work)
    move_joints(model, work)
    move_cables(model, work)


@kernel
def start_from_end(model, state, q, work):
    """Copy the motion at a step's end, whose coordinates are `q`, from `work` to `state`."""
    for b in range(model.bodies.size):
        angle = q[model.bodies[b].offset + 2]
        state.turns[b, 0], state.turns[b, 1] = math.cos(angle), math.sin(angle)
    for number in range(model.attachments.size):
        scratch, placement = work.attachments[number], state.placements[number]
        body = work.bodies[model.attachments[number].body]
        for i in range(2):
            placement.local[i], placement.arm[i] = scratch.local[i, LAST], scratch.arm[i, LAST]
            placement.arm_rate[i] = scratch.point_rate[i, LAST] - body.speed[i, LAST]
            placement.direction[i] = scratch.direction[i, LAST]
    for j in range(model.joints.size):
        for c in range(state.motion.shape[1]):
            state.motion[j, c] = work.joints[j].motion[c, LAST]
    for k in range(model.cables.size):
        for c in range(state.cable_motion.shape[1]):
            state.cable_motion[k, c] = work.cables[k].motion[c, LAST]
