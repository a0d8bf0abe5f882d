"""The hinge drive: the rate that an action asks for, the loop that holds it, and the torque that the motor reaches.

Below, `motor` is a row of `motor_type`, and `memory` (MEMORY,) is what a motor's drive remembers.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solar_env.array import ArrayParameters
from solar_env.environment.hardware import Hardware, response
from solar_env.environment.task.task import ACTIONS, TORQUE, Task
from solar_env.mechanics.integrators.formulations import view_joint_of
from solar_env.mechanics.numerics.jit import kernel

# An action of "log_rate" asks for exp(u) times the rate that opens the hinge in CRUISE of the deadline, or, where u is
# positive, for little more than that rate. u follows REACH times the action with a lag, so that the array feels little
# of an agent's noise, and nothing of it in the mean.
CRUISE, REACH, LAG, HASTE = 0.8, 4.5, 5.0, 0.05  # -, -, [s], -

# What a drive remembers: the torque that its loop asked for at the last sample [N m], the setpoint [rad/s], and u.
LOOP_TORQUE, SETPOINT, LOG_RATIO = range(3)
MEMORY = 3

# A motor: the index of its joint, its greatest torque [N m], the share of the way to a new torque that it goes between
# two samples and the greatest change of its torque in that time [N m]; the gain of its rate loop [N m s/rad], the share
# of the way that the loop's filter goes; the rate that an action of 0 asks for [rad/s], the share of the way that u
# goes, the greatest change of the setpoint [rad/s]; and the load that the loop compensates, at the folded joint [N m]
# and by how much it falls with the angle [N m/rad].
_MOTOR = (
    *("torque_limit", "response", "largest_change", "rate_gain", "rate_response"),
    *("cruise", "lag_response", "setpoint_change", "load", "load_slope"),
)
motor_type = np.dtype((np.record, np.dtype([("joint", "i8"), *((name, "f8") for name in _MOTOR)], align=True)))


class TaskNumbers(NamedTuple):
    """A `Task` for kernels: times [s], samples of the drives in a control period, a row of `motor_type` by motor.

    For many lanes, which may differ in their motors alone, `motors` has a leading axis.
    """

    control_period: float
    deadline: float
    last_chance: float
    settling_window: float
    sample_period: float
    samples: int
    action: int
    drive_settles: bool
    motors: NDArray[np.void]


def spring_load(array: ArrayParameters, joint: int) -> tuple[float, float]:
    """Compute the torque [N m] of springs and harness on a folded joint, and its decrease per joint angle [N m/rad].

    Other joints' torques count through the cable loops, which keep the joints' angles in the ratio of the lock angles.
    """
    wing = [row for row in array.joints if row.side == array.joints[joint].side]
    ratios = np.array([row.lock_angle for row in wing]) / array.joints[joint].lock_angle
    names = ("spring_stiffness", "spring_preload_angle")
    springs, relaxed = (np.array([array.by_joint(name, row.index) for row in wing]) for name in names)
    stiffness = ratios**2 * springs
    load, slope = stiffness @ (relaxed / ratios), stiffness.sum()
    for row, ratio in zip(wing, ratios, strict=True):
        for name in ("spring_torque", "harness_torque"):
            if table := array.table(name, row.index):
                folded, deployed = np.interp((0.0, row.lock_angle), *np.array(table).T)
                load, slope = load + ratio * folded, slope + ratio**2 * (folded - deployed) / row.lock_angle
    return float(load), float(slope)


def motor_row(
    joint: int, torque_limit: float, deadline: float, hardware: Hardware, array: ArrayParameters, period: float
) -> tuple[float, ...]:
    """Return the row of `motor_type` of a motor on a joint, whose drive takes a sample in every period [s]."""
    load, slope = spring_load(array, joint) if hardware.load_compensation else (0.0, 0.0)
    return (
        joint,
        torque_limit,
        response(hardware.motor_lag, period),
        hardware.torque_rate_limit * period,
        hardware.rate_loop_gain,
        response(hardware.rate_loop_lag, period),
        array.joints[joint].lock_angle / (CRUISE * deadline),
        response(LAG, period),
        hardware.setpoint_rate_limit * period,
        load,
        slope,
    )


def task_numbers(task: Task, hardware: Hardware, array: ArrayParameters) -> TaskNumbers:
    """Return the task and its drives as the kernels take them; the drives know the load of the array's springs."""
    samples = task.samples(hardware)
    period = task.control_period / samples
    about = float(task.torque_limit), float(task.deadline), hardware, array, period
    motors = [motor_row(joint, *about) for joint in task.driven_joints]
    return TaskNumbers(
        float(task.control_period),
        float(task.deadline),
        float(task.deadline * (1.0 + task.overtime)),
        float(task.settling_window),
        period,
        samples,
        ACTIONS[task.action],
        bool(task.drive_settles),
        np.array(motors, dtype=motor_type),
    )


@kernel
def numbers_of(lanes, lane):
    """Return the numbers of one lane."""
    return TaskNumbers(
        lanes.control_period,
        lanes.deadline,
        lanes.last_chance,
        lanes.settling_window,
        lanes.sample_period,
        lanes.samples,
        lanes.action,
        lanes.drive_settles,
        lanes.motors[lane],
    )


@kernel
def asked_rate(motor, memory, action):
    """Advance u by a sample under an action of "log_rate" in [-1, 1]; return the joint rate [rad/s] asked for."""
    memory[LOG_RATIO] += motor.lag_response * (REACH * action - memory[LOG_RATIO])
    u = memory[LOG_RATIO]
    return motor.cruise * (math.exp(u) if u < 0.0 else 1.0 + HASTE * u)


@kernel
def loop_torque(motor, memory, asked, angle, rate):
    """Advance the drive's rate loop by a sample, towards the rate `asked` [rad/s]; return the limited, filtered torque.

    The loop measures `angle` [rad] and `rate` [rad/s].
    """
    change = motor.setpoint_change
    memory[SETPOINT] = min(max(asked, memory[SETPOINT] - change), memory[SETPOINT] + change)
    torque = motor.rate_gain * (memory[SETPOINT] - rate) - (motor.load - motor.load_slope * angle)
    torque = min(max(torque, -motor.torque_limit), motor.torque_limit)
    memory[LOOP_TORQUE] += motor.rate_response * (torque - memory[LOOP_TORQUE])
    return memory[LOOP_TORQUE]


@kernel
def asked_torque(model, state, task, motor, memory, action, rate_error, settling):
    """Return the torque [N m] that a drive asks of its motor until the next sample; a settling drive asks for rest."""
    view = view_joint_of(model)(model, state, motor.joint)
    rate = view.rate + rate_error
    if task.action == TORQUE and not settling:
        # From here the loop takes over after the last latching.
        memory[LOOP_TORQUE], memory[SETPOINT] = motor.torque_limit * action, rate
        return memory[LOOP_TORQUE]
    asked = 0.0 if settling else asked_rate(motor, memory, action)
    return loop_torque(motor, memory, asked, view.angle, rate)


@kernel
def set_torque(state, motor, torque):
    """Set the motor's torque until the next sample: the torque asked for, within the motor's lag and rate limit."""
    driven = state.joints[motor.joint]
    if motor.response < 1.0:
        torque = driven.motor_torque + motor.response * (torque - driven.motor_torque)
    change = motor.largest_change
    torque = min(max(torque, driven.motor_torque - change), driven.motor_torque + change)
    if driven.motor_torque != torque:
        driven.motor_torque = torque
        state.clock[0].acceleration_current = 0
