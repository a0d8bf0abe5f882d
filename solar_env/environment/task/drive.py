"""The hinge drive: an action sets a rate setpoint, a rate loop holds the setpoint, and a motor exerts the torque.

In this module `motor` is a record of `motor_type`, and `memory` (MEMORY,) holds the state of that motor's drive.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solar_env.array import ArrayParameters
from solar_env.environment.hardware import Hardware, response
from solar_env.environment.task.task import ACTIONS, TORQUE, Task
from solar_env.mechanics.integrators.formulations import view_joint_of
from solar_env.mechanics.numerics.jit import kernel

# A "log_rate" action asks for exp(u) times the cruise rate, which opens the hinge in CRUISE times the deadline; if u is
# positive, the action asks for 1 + HASTE u times the cruise rate. u follows REACH times the action with a time constant
# LAG, which damps an agent's noise; the noise averages to zero.
CRUISE, REACH, LAG, HASTE = 0.8, 4.5, 5.0, 0.05  # -, -, [s], -
GENTLE = 0.4  # greatest change of a panel's rate by a sample per rate error (chosen: beyond it yokes rattle)

# Entries of a drive's memory: the rate loop's torque at the last sample [N m], the rate setpoint [rad/s], and u.
LOOP_TORQUE, SETPOINT, LOG_RATIO = range(3)
MEMORY = 3

# Fields of a motor: the index of its joint, its greatest torque [N m], its response, and the greatest change of its
# torque [N m]; the gain of its rate loop [N m s/rad], and the response of the loop's filter; the rate for an action of
# 0 [rad/s], the response of u, and the greatest change of the setpoint [rad/s]; the load that the loop compensates, at
# the folded joint [N m], and the decrease of that load per joint angle [N m/rad]. A response is the fraction of a step
# that a lag follows between two samples; changes are between two samples, too.
_MOTOR = (
    *("torque_limit", "response", "largest_change", "rate_gain", "rate_response"),
    *("cruise", "lag_response", "setpoint_change", "load", "load_slope"),
)
motor_type = np.dtype((np.record, np.dtype([("joint", "i8"), *((name, "f8") for name in _MOTOR)], align=True)))


class TaskNumbers(NamedTuple):
    """The numbers of a `Task` for kernels: times [s], code of the kind of action, and a `motor_type` record per motor.

    For a batch of environments (lanes), `sample_period` and `motors` have a leading axis with an entry for every lane.
    """

    control_period: float
    deadline: float
    last_chance: float
    settling_window: float
    sample_period: float | NDArray[np.float64]
    action: int
    drive_settles: bool
    motors: NDArray[np.void]


def spring_load(array: ArrayParameters, joint: int) -> tuple[float, float]:
    """Compute the torque of springs and harness on a folded joint [N m], and the torque's decrease per angle [N m/rad].

    Torques of the wing's other joints are included, as if cable loops kept all angles in the ratio of the lock angles.
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


def refinement(hardware: Hardware, array: ArrayParameters, joints: Sequence[int], period: float) -> int:
    """Return into how many parts, at most 100, to divide the sampling period `period` [s] of the drives' rate loops.

    A loop must change its panel's rate in each part by at most `GENTLE` times the rate error, or the panel
    oscillates. The lightest panel on `joints`, the indices of the driven joints, decides.
    """
    panels = [array.panel(joint) for joint in joints]
    lightest = min(panel.inertia + panel.mass * panel.centroid**2 for panel in panels)
    torques = ((n, hardware.rate_loop_gain * response(hardware.rate_loop_lag, period / n)) for n in range(1, 100))
    return next((n for n, torque in torques if torque * period / n <= GENTLE * lightest), 100)


def motor_row(
    joint: int, torque_limit: float, deadline: float, hardware: Hardware, array: ArrayParameters, period: float
) -> tuple[float, ...]:
    """Return the fields of a `motor_type` record for the motor on a joint, whose drive samples every `period` [s].

    The rate for an action of 0 opens the joint in CRUISE times the `deadline` [s]. `torque_limit` is in N m.
    """
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
    """Convert a task to numbers for compiled code (`TaskNumbers`): times, and motor data from hardware and array."""
    period = task.control_period / task.samples(hardware)
    if task.has_loop:
        period /= refinement(hardware, array, task.driven_joints, period)
    about = float(task.torque_limit), float(task.deadline), hardware, array, period
    motors = [motor_row(joint, *about) for joint in task.driven_joints]
    return TaskNumbers(
        float(task.control_period),
        float(task.deadline),
        float(task.deadline * (1.0 + task.overtime)),
        float(task.settling_window),
        period,
        ACTIONS[task.action],
        bool(task.drive_settles),
        np.array(motors, dtype=motor_type),
    )


@kernel
def numbers_of(lanes, lane):
    """Return the `TaskNumbers` of one lane (environment) from `lanes`, the `TaskNumbers` of all lanes."""
    return TaskNumbers(
        lanes.control_period,
        lanes.deadline,
        lanes.last_chance,
        lanes.settling_window,
        lanes.sample_period[lane],
        lanes.action,
        lanes.drive_settles,
        lanes.motors[lane],
    )


@kernel
def asked_rate(motor, memory, action):
    """Let u, `memory[LOG_RATIO]`, follow 4.5 times the action with a lag; return the requested rate [rad/s].

    It is `motor.cruise` times exp(u) if u is negative, or times 1 + 0.05 u if u is positive (REACH, HASTE).
    """
    memory[LOG_RATIO] += motor.lag_response * (REACH * action - memory[LOG_RATIO])
    u = memory[LOG_RATIO]
    return motor.cruise * (math.exp(u) if u < 0.0 else 1.0 + HASTE * u)


@kernel
def loop_torque(motor, memory, asked, angle, rate):
    """Advance the rate loop by one sample towards the rate `asked` [rad/s]; return its limited, filtered torque [N m].

    `angle` [rad] and `rate` [rad/s] are the measured angle and rate of the joint.
    """
    change = motor.setpoint_change
    memory[SETPOINT] = min(max(asked, memory[SETPOINT] - change), memory[SETPOINT] + change)
    torque = motor.rate_gain * (memory[SETPOINT] - rate) - (motor.load - motor.load_slope * angle)
    torque = min(max(torque, -motor.torque_limit), motor.torque_limit)
    memory[LOOP_TORQUE] += motor.rate_response * (torque - memory[LOOP_TORQUE])
    return memory[LOOP_TORQUE]


@kernel
def asked_torque(model, state, task, motor, memory, action, rate_error, settling):
    """Advance a drive's `memory` by one sample, and return the torque [N m] that the drive requests from its motor.

    `rate_error` [rad/s] is added to the true joint rate; `settling` replaces the action by a rate setpoint of 0.
    """
    view = view_joint_of(model)(model, state, motor.joint)
    rate = view.rate + rate_error
    if task.action == TORQUE and not settling:
        # After the last latching the rate loop starts from these values.
        memory[LOOP_TORQUE], memory[SETPOINT] = motor.torque_limit * action, rate
        return memory[LOOP_TORQUE]
    asked = 0.0 if settling else asked_rate(motor, memory, action)
    return loop_torque(motor, memory, asked, view.angle, rate)


@kernel
def set_torque(state, motor, torque):
    """Move a motor's torque, `motor_torque` of its joint in `state.joints`, towards the requested `torque` [N m].

    `motor` is a `motor_type` record: its joint, its lag, and the greatest change of its torque from sample to sample.
    """
    driven = state.joints[motor.joint]
    if motor.response < 1.0:
        torque = driven.motor_torque + motor.response * (torque - driven.motor_torque)
    change = motor.largest_change
    torque = min(max(torque, driven.motor_torque - change), driven.motor_torque + change)
    if driven.motor_torque != torque:
        driven.motor_torque = torque
        state.clock[0].acceleration_current = 0
