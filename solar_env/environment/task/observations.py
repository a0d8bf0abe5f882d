"""The table of observables: how each quantity is computed from the state, and which sensor effects change its value."""

import itertools
import math
import re
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solar_env.environment.task.control import last_latch
from solar_env.environment.task.drive import LOG_RATIO, REACH
from solar_env.environment.task.features import FEATURES, Feature
from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.integrators.formulations import view_joint_of
from solar_env.mechanics.numerics.jit import kernel
from solar_env.support.markdown import markdown_table
from solar_env.support.values import check_name, unknown_name

# Codes of the quantities that `reading` computes.
THETA, RATE, LATCHED, MOTOR_TORQUE, TIME_TO_DEADLINE, TIME_SINCE_LATCH, ECCENTRICITY_X, ECCENTRICITY_Y = range(8)
IN_CONTACT, MAIN_BODY_SPIN, MAIN_BODY_ANGLE, RECENT_PEAK_FORCE, TIME, LOG_SETPOINT = range(8, 14)

LOCK_ANGLE = "lock angle"
GREATEST_AGE = 100


class Observable(NamedTuple):
    """A quantity that an observation lists by its name; the documentation prints its meaning.

    Attributes:
        low, high: bounds of the clipped quantity, in its unit.
        code: integer that selects the quantity in the kernel `reading`.
        by_joint: whether there is one entry per joint.
        by_motor: whether there is one entry per motor.
        noise: name of the field of `Hardware` with the noise's standard deviation; None without noise.
        encoder: whether the measured value is rounded to steps of `Hardware.encoder_resolution`.
        delayed: whether the measured value appears `Hardware.sensor_delay` control periods late.
    """

    name: str
    meaning: str
    unit: str
    low: float
    high: float
    code: int
    by_joint: bool = False
    noise: str | None = None
    encoder: bool = False
    delayed: bool = False
    by_motor: bool = False


OBSERVABLES = (
    Observable("theta", "joint angle: 0 folded, 1 locked", LOCK_ANGLE, -2, 2, THETA, True, "angle_noise", True, True),
    Observable("rate", "rate of the joint angle", "rad/s", -5.0, 5.0, RATE, True, "rate_noise", False, True),
    Observable("latched", "latch switch", "0 or 1", 0.0, 1.0, LATCHED, True, delayed=True),
    Observable("motor_torque", "torque in the last period", "torque_limit", -1.0, 1.0, MOTOR_TORQUE, by_motor=True),
    Observable("time_to_deadline", "time left", "deadline", 0.0, 1.0, TIME_TO_DEADLINE),
    Observable(
        "time_since_latch", "time since the last latching", "settling_window", 0.0, 1.0, TIME_SINCE_LATCH, delayed=True
    ),
    Observable("eccentricity_x", "journal off its bearing's centre", "clearance", -2.0, 2.0, ECCENTRICITY_X, True),
    Observable("eccentricity_y", "the same, along the inertial y", "clearance", -2.0, 2.0, ECCENTRICITY_Y, True),
    Observable("in_contact", "journal and bearing touch", "0 or 1", 0.0, 1.0, IN_CONTACT, True),
    Observable("main_body_spin", "exact spin of the main body", "rad/s", -1.0, 1.0, MAIN_BODY_SPIN),
    Observable(
        *("main_body_angle", "main body's direction from that at release, of a star tracker", "rad", -math.pi, math.pi),
        *(MAIN_BODY_ANGLE, False, "attitude_noise", False, True),
    ),
    Observable("time", "time since release", "deadline", 0.0, 3.0, TIME),
    Observable(
        *("log_setpoint", 'of "log_rate": u, the logarithm of the setpoint', "4.5", -1.0, 1.0, LOG_SETPOINT),
        by_motor=True,
    ),
    Observable("recent_peak_force", "greatest force in the last period", "kN", 0.0, 10.0, RECENT_PEAK_FORCE, True),
)

_ROWS: tuple[Observable | Feature, ...] = (*OBSERVABLES, *FEATURES)
_BY_NAME = {row.name: row for row in _ROWS}

# Names of observables, in order. The names in a tuple alternate: all of them for joint 1, then for joint 2, ...
Names = Sequence[str | tuple[str, ...]]
_DRIVE: tuple[str, ...] = ("theta", "rate", "latched", "motor_torque", "time_to_deadline", "time_since_latch")
_PAST = tuple(f"{name}_{age}_ago" for age in (1, 2, 3) for name in ("theta", "rate", "motor_torque"))
OBSERVATIONS: dict[str, Names] = {
    "scaled": ("distance", "speed", "latched", "time", "log_setpoint"),
    "drive": _DRIVE,
    "history": (*_DRIVE, *_PAST),
    "privileged": (*_DRIVE, ("eccentricity_x", "eccentricity_y", "in_contact"), "main_body_spin"),
}


class Entry(NamedTuple):
    """One entry of the observation vector; `age` is how many control periods ago its value was measured.

    `joint` is the index of a joint if `observable.by_joint`, the index of a motor if `by_motor`, and otherwise 0.
    `number`, a part of the entry's name, is the number, from 1, of the joint or of the motor's joint. It is None for a
    quantity of the whole array or of the only motor.
    """

    observable: Observable | Feature
    joint: int
    age: int
    number: int | None

    @property
    def name(self) -> str:
        """Name of the entry, such as "theta_1_2_ago": the observable's name, the joint's number, and the age."""
        joint = f"_{self.number}" if self.number else ""
        return f"{self.observable.name}{joint}" + (f"_{self.age}_ago" if self.age else "")


def observation_entries(joints: int, observation: str | Names, driven: Sequence[int] = (0,)) -> tuple[Entry, ...]:
    """Return an `Entry` (observable, joint or motor, age) for every number in the observation vector, in order.

    There are `joints` joints. `driven` are the indices of joints with motors, the only ones with entries by motor.
    `observation` is a key of `OBSERVATIONS`, or a list of names from `OBSERVABLES` and `FEATURES`; a key in the list
    adds its names. "theta_2_ago" is the value of theta two control periods ago. A tuple of names in the list gives the
    entries of all its names for the first joint, then for the second joint, and so on.

    Raises:
        ValueError: for an unknown name, a name that is listed twice, or an empty list.
    """
    if isinstance(observation, str):
        if observation not in OBSERVATIONS:
            raise ValueError(unknown_name("observation", observation, OBSERVATIONS) + ", or list names of observables")
        observation = (observation,)
    if not isinstance(observation, Iterable):
        raise ValueError(f"observation = {observation!r} must be a name, or a list of names of observables")
    entries: list[Entry] = []
    listed = [OBSERVATIONS.get(name, (name,)) if isinstance(name, str) else (name,) for name in observation]
    for names in itertools.chain(*listed):
        rows = [_observable(name) for name in (names if isinstance(names, (tuple, list)) else (names,))]
        for joint in range(joints):
            for row, age in rows:
                if row.by_joint:
                    entries.append(Entry(row, joint, age, joint + 1))
                elif isinstance(row, Observable) and row.by_motor and joint in driven:
                    entries.append(Entry(row, driven.index(joint), age, joint + 1 if len(driven) > 1 else None))
                elif joint == 0 and not (isinstance(row, Observable) and row.by_motor):
                    entries.append(Entry(row, 0, age, None))
    if not entries or len(set(entries)) < len(entries):
        raise ValueError(f"observation = {observation!r} must list at least one name, and each only once")
    return tuple(entries)


def _observable(name: str) -> tuple[Observable | Feature, int]:
    """Return the `Observable` or `Feature` that a name stands for, and its age in periods: 2 for "rate_2_ago"."""
    past = re.fullmatch(r"(\w+)_([1-9]\d*)_ago", str(name))
    stem, age = (past[1], int(past[2])) if past else (name, 0)
    if (of_joint := re.fullmatch(r"(\w+)_\d+", str(stem))) and of_joint[1] in _BY_NAME:
        raise ValueError(f"the observable {name!r}: leave out the number, {of_joint[1]!r} observes all joints")
    check_name("the observable", stem, _BY_NAME)
    if age > GREATEST_AGE:
        raise ValueError(f"{name!r} is {age} control periods old; observe at most {GREATEST_AGE} periods back")
    return _BY_NAME[stem], age


_CHANNEL = [("code", "i8"), ("joint", "i8"), ("low", "f4"), ("high", "f4")]
channel_type = np.dtype((np.record, np.dtype(_CHANNEL, align=True)))


def measured_for(entry: Entry) -> tuple[Observable, int]:
    """Return the `Observable` that an entry of the observation vector shows, and the index of its joint or motor.

    For an entry that shows a `Feature`, return the `Observable` from which this feature is computed.
    """
    of = entry.observable
    name = of.source if isinstance(of, Feature) else of.name
    return next(row for row in OBSERVABLES if row.name == name), entry.joint


def channels(measured: Sequence[tuple[Observable, int]]) -> NDArray[np.void]:
    """Return a record array (measured,) for kernels with the code, joint and bounds of every measured quantity."""
    return np.array([(row.code, joint, row.low, row.high) for row, joint in measured], dtype=channel_type)


@kernel
def reading(code, j, model, state, task, drives):
    """Return the exact value of the observable with this code at joint or motor `j`; `drives`: states of all drives."""
    joint, joint_state, view = model.joints[j], state.joints[j], view_joint_of(model)(model, state, j)
    if code == THETA:
        return view.angle / joint.lock_angle
    if code == RATE:
        return view.rate
    if code == MAIN_BODY_SPIN:
        return view.inboard_spin
    if code == MAIN_BODY_ANGLE:
        return view.inboard_angle
    if code in (ECCENTRICITY_X, ECCENTRICITY_Y):
        scale = 1.0 / joint.clearance if joint.kind == m.CLEARANCE else 0.0
        return scale * (view.eccentricity_x if code == ECCENTRICITY_X else view.eccentricity_y)
    if code == LATCHED:
        return float(joint_state.latched)
    if code == IN_CONTACT:
        return float(joint_state.in_contact)
    if code == MOTOR_TORQUE:
        motor = task.motors[j]
        return state.joints[motor.joint].motor_torque / motor.torque_limit
    if code == TIME_TO_DEADLINE:
        return (task.deadline - state.clock[0].time) / task.deadline
    if code == TIME:
        return state.clock[0].time / task.deadline
    if code == LOG_SETPOINT:
        return drives[j, LOG_RATIO] / REACH
    if code == TIME_SINCE_LATCH:
        latched_at = last_latch(state.joints)
        return (state.clock[0].time - latched_at) / task.settling_window if latched_at == latched_at else 0.0
    if code == RECENT_PEAK_FORCE:
        return 1e-3 * joint_state.recent_peak_force
    return math.nan


@kernel
def observe(model, state, task, channels, drives, out):
    """Write the exact values of observed quantities, clipped to their bounds, to `out` (measured,).

    `channels` (measured,) are the quantities' codes, joints and bounds, `drives` (motors, MEMORY) the drives' states.
    """
    for k in range(channels.size):
        channel = channels[k]
        out[k] = reading(channel.code, channel.joint, model, state, task, drives)
        out[k] = min(max(out[k], channel.low), channel.high)


def observation_table() -> str:
    """Return the Markdown table of observables and features for the environment's documentation."""
    cells = []
    for row in _ROWS:
        sensors = "as what it is made of"
        if isinstance(row, Observable):
            effects = row.noise, "encoder_resolution" if row.encoder else None, "sensor_delay" if row.delayed else None
            sensors = ", ".join(f"`{name}`" for name in effects if name) or "exact"
        name = f"`{row.name}_i`" if row.by_joint else f"`{row.name}`"
        cells.append((name, row.meaning, f"{row.low:.4g}", f"{row.high:.4g}", row.unit, sensors))
    return markdown_table(("Name", "Observation", "Min", "Max", "Unit", "Sensors"), cells)
