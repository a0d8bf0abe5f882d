"""The control task as users define it: limits, times, action and driven joints; and the versions of the task."""

import math
import sys
from collections.abc import Mapping
from dataclasses import MISSING, dataclass
from typing import NamedTuple

from solar_env.array.parameters.checks import Rule, Usual, check_rows, number
from solar_env.environment.hardware import Hardware
from solar_env.support.values import check_name, is_whole_number

# Kinds of action by name, with their codes for kernels.
ACTIONS = {"torque": 0, "log_rate": 1}
TORQUE, LOG_RATE = ACTIONS.values()
_POSITIVE = Rule(math.ulp(0.0), sys.float_info.max, "must be a positive finite number")
_NOT_NEGATIVE = Rule(0.0, sys.float_info.max, "must be a finite number, not negative")
_TIME = Usual(1e-4, 5e3, "s", "ms")


@dataclass(frozen=True)
class Task:
    """The control task: its limits and times, the kind of action, and the joints with motors.

    Attributes:
        torque_limit: greatest motor torque [N m].
        control_period: time between two actions [s].
        deadline: time by which every joint should have latched [s].
        overtime: time for which an episode with an open joint continues after the deadline, divided by the deadline.
        settling_window: time after the last latching until the episode ends [s].
        drive_settles: whether the drive alone brings the array to rest after the last latching; the step of that
            latching then lasts until the episode ends.
        driven_joint: index of the joint with the motor, 0 for the root hinge; or several indices of joints, each with a
            motor, a drive and an entry of the action.
        action: "torque", a motor torque divided by the torque limit; or "log_rate", which sets the joint rate that a
            feedback loop holds: c exp(u) for u < 0, c (1 + 0.05 u) for u > 0. Here u follows 4.5 times the action with
            a lag of 5 s, and the rate c opens the joint in 0.8 times the deadline.
    """

    torque_limit: float = number(MISSING, _POSITIVE, Usual(1e-4, 200.0, "N m", "N mm"))
    control_period: float = number(MISSING, _POSITIVE, Usual(1e-4, 60.0, "s", "ms"))
    deadline: float = number(MISSING, _POSITIVE, _TIME)
    settling_window: float = number(MISSING, _POSITIVE, _TIME)
    overtime: float = number(0.0, _NOT_NEGATIVE)
    drive_settles: bool = False
    driven_joint: int | tuple[int, ...] = 0
    action: str = "torque"

    def __post_init__(self) -> None:
        check_name("the action", self.action, ACTIONS)
        check_rows(self)
        for name in ("settling_window", "deadline"):
            value, period = getattr(self, name), self.control_period
            if value < period:
                raise ValueError(f"{name} = {value!r} s is below control_period = {period!r} s")
        given = self.driven_joints
        if not given or not all(is_whole_number(joint, 0) for joint in given) or len(set(given)) < len(given):
            raise ValueError(
                f"driven_joint = {self.driven_joint!r} must be the index of a joint, or several different ones"
            )

    @property
    def driven_joints(self) -> tuple[int, ...]:
        """Index of each motor's joint; an action has one entry per motor."""
        return self.driven_joint if isinstance(self.driven_joint, tuple) else (self.driven_joint,)

    @property
    def has_loop(self) -> bool:
        """True if the drives have a rate loop, for "log_rate" actions or for settling."""
        return ACTIONS[self.action] != TORQUE or self.drive_settles

    def samples(self, hardware: Hardware) -> int:
        """Return the number of drive samples in a control period at `hardware.rate_loop_frequency`; 1 without a loop.

        Samples that `drive.refinement` adds for low inertia do not count. A fractional number raises a ValueError.
        """
        if not self.has_loop:
            return 1
        samples = self.control_period * hardware.rate_loop_frequency
        if round(samples) < 1 or not math.isclose(samples, round(samples), rel_tol=1e-9):
            raise ValueError(
                f"rate_loop_frequency = {hardware.rate_loop_frequency!r} Hz makes {samples:g} samples of a control "
                f"period of {self.control_period!r} s; give one that makes a whole number, at least 1"
            )
        return round(samples)


class Version(NamedTuple):
    """A version of the task, such as "v2" in an environment's id, with defaults for the environment's keywords.

    `hardware` changes the scenario's hardware; `rigid_hardware` changes it further for rigid panels. `observation` and
    `prices` are the defaults of the keywords `observation` and `reward`.
    """

    task: Task
    hardware: Mapping[str, object]
    rigid_hardware: Mapping[str, object]
    observation: str
    prices: Mapping[str, object]


VERSIONS = {
    "v1": Version(
        Task(torque_limit=0.5, control_period=0.1, deadline=20.0, settling_window=10.0),
        {},
        {},
        "drive",
        {"peak_impact": 1.0, "wear": 1.0, "missed_deadline": {"weight": 25.0, "bound": 2.0}},
    ),
    "v2": Version(
        Task(
            torque_limit=1.0,
            control_period=0.5,
            deadline=20.0,
            overtime=1.0,
            settling_window=10.0,
            drive_settles=True,
            action="log_rate",
        ),
        # A measured value that is late by one period of version 1, 0.1 s, arrives within a period of 0.5 s.
        {"setpoint_rate_limit": 0.05, "load_compensation": True, "sensor_delay": 0},
        # Only for rigid panels: a loop with this gain shakes flexible panels.
        {"rate_loop_gain": 25.0, "rate_loop_frequency": 20.0},
        "scaled",
        {
            "peak_impact": {"form": "decades", "scale": 1.0, "weight": 1.0, "bound": 1e4},
            "wear": {"form": "decades", "scale": 1e-3, "weight": 2.0, "bound": 1e3},
            "time": 0.2,
            "lateness": {"weight": 2.0, "bound": 100.0},
            "opening": 3.2,
            "missed_deadline": {"weight": 12.0, "bound": 2.0},
        },
    ),
}
CURRENT_VERSION = "v2"
PRESENT = VERSIONS[CURRENT_VERSION]
