"""Tangents of closed cable loops, for `tangent.fill_tangents`.

With the gradients a and b of the angles of a loop's inner and outer wheel, the ratios r of the wheels and t of the
torques, and the torque T(r angle_a - angle_b), the generalized force is T (b - t a), so that

dQ/dq = T' (b - t a) (r a - b)^T + T (Hessian of angle_b - t times that of angle_a).
"""

from solar_env.mechanics.bodies.linear_marker import angle_hessian
from solar_env.mechanics.bodies.markers import fill_slopes, subtract_hessian
from solar_env.mechanics.joints.cable_loop import cable_torque, chord, end_torques, wheel_angles
from solar_env.mechanics.joints.joint import ANGLE
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.profile import add_entry


@kernel(inner=True)
def add_cable_slopes(model, cable, q, v, tangent, by_q):
    """Subtract a loop's dQ/dq from the stiffness, whose part by torques on the joints' slopes is there already."""
    joints, markers, elimination, loads = model.joints, model.markers, model.elimination, tangent.loads
    a, o = cable.joint_a, cable.joint_b
    index, gradient = tangent.cable_coordinates, tangent.wheel_gradient
    for c in range(8):
        index[c], index[8 + c] = tangent.coordinates[a, c], tangent.coordinates[o, c]
        gradient[0, c], gradient[0, 8 + c] = tangent.angle_gradient[a, c], 0.0
        gradient[1, c], gradient[1, 8 + c] = 0.0, tangent.angle_gradient[o, c]
    inner, outer = wheel_angles(cable, joints, markers, q, loads[a, ANGLE], loads[o, ANGLE])
    torque, slope, _ = cable_torque(cable, cable.wheel_ratio * inner - outer)
    if cable.chord_sense != 0:
        add_chord_slopes(model, cable, q, v, torque, tangent, by_q)
    for r in range(16):
        push = slope * (gradient[1, r] - cable.torque_ratio * gradient[0, r])
        if push != 0.0:
            for c in range(16):
                value = push * (cable.wheel_ratio * gradient[0, c] - gradient[1, c])
                if value != 0.0:
                    add_entry(elimination, by_q, index[r], index[c], -value)


@kernel(inner=True)
def add_chord_slopes(model, cable, q, v, torque, tangent, by_q):
    """Let the wheels' gradients count from the chord of a carrier that bends, and take the Hessians there."""
    joints, markers, elimination = model.joints, model.markers, model.elimination
    inner, outer = joints[cable.joint_a], joints[cable.joint_b]
    first, last = markers[inner.outboard], markers[outer.inboard]
    places, index, gradient = tangent.b, tangent.cable_coordinates, tangent.wheel_gradient
    places[:] = 0.0
    # Its coordinates are the first four and the last four of the loop's sixteen.
    fill_slopes(first, q, v, 0, tangent.coordinates[cable.joint_a], places, tangent.rate_slope)
    fill_slopes(last, q, v, 1, tangent.coordinates[cable.joint_b], places, tangent.rate_slope)
    x, y = chord(cable, joints, markers, q)
    square = x * x + y * y
    for c in range(8):
        sense = cable.chord_sense if c >= 4 else -cable.chord_sense
        places[0, c] *= sense
        places[1, c] *= sense
        turn = (x * places[1, c] - y * places[0, c]) / square
        k = c if c < 4 else 8 + c
        gradient[0, k], gradient[1, k] = inner.sign * turn, -outer.sign * turn
    inner_torque, outer_torque = end_torques(cable, joints, torque)
    subtract_hessian(first, q, 0.0, 0.0, -inner_torque, elimination, by_q)
    subtract_hessian(last, q, 0.0, 0.0, -outer_torque, elimination, by_q)
    # Places of bodies that bend are linear in their coordinates.
    hxx, hxy = angle_hessian(x, y)
    moment = inner_torque + outer_torque
    for r in range(8):
        along, across = hxx * places[0, r] + hxy * places[1, r], hxy * places[0, r] - hxx * places[1, r]
        for c in range(8):
            value = moment * (along * places[0, c] + across * places[1, c])
            if value != 0.0:
                row, column = r if r < 4 else 8 + r, c if c < 4 else 8 + c
                add_entry(elimination, by_q, index[row], index[column], -value)
