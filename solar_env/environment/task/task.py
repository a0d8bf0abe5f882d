"""The control task: limits, times and motors, as users give them and as kernels take them; its versions."""

import math
import sys
from collections.abc import Mapping
from dataclasses import MISSING, dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solar_env.array.parameters.checks import Rule, check_rows, number
from solar_env.environment.hardware import Hardware, response
from solar_env.support.values import is_whole_number, unknown_name

ACTIONS = ("torque", "rate")
_POSITIVE = Rule(math.ulp(0.0), sys.float_info.max, "must be a positive finite number")
# An action a of "rate" asks for a rate of SLOWEST sinh(STEEPNESS a): evenly spaced in its logarithm, and signed. The
# fastest, 0.27 rad/s, is twice what a deployment in time takes; rates of a soft landing are a thousandth of it.
SLOWEST, STEEPNESS = 5e-4, 7.0  # [rad/s], -

# A motor: the index of its joint, its greatest torque [N m], the share of the way to a new torque that it goes between
# two samples and the greatest change of its torque in that time [N m]; the gain of its rate loop [N m s/rad], 0 where
# actions are torques, and the share of the way that the loop's filter goes.
_MOTOR = ("torque_limit", "response", "largest_change", "rate_gain", "rate_response")
motor_type = np.dtype((np.record, np.dtype([("joint", "i8"), *((name, "f8") for name in _MOTOR)], align=True)))


class TaskNumbers(NamedTuple):
    """A `Task` for kernels: times [s], samples of the drives in a control period, a row of `motor_type` by motor."""

    control_period: float
    deadline: float
    settling_window: float
    sample_period: float
    samples: int
    motors: NDArray[np.void]


@dataclass(frozen=True)
class Task:
    """Limits and times of the task, and the hinge that the motor sits on.

    Attributes:
        torque_limit: greatest motor torque [N m].
        control_period: time between two actions [s].
        deadline: time by which every joint must have latched [s].
        settling_window: time after the last latching during which the episode goes on [s].
        driven_joint: index of the joint that the motor works on; 0 is the root hinge.
        action: "torque", in units of the torque limit, or "rate": the setpoint 5e-4 sinh(7 a) rad/s, from -0.27 to
            0.27, of the rate loop of the hinge drive, whose torque is `Hardware.rate_loop_gain` times the error of the
            rate, at most the torque limit, anew `Hardware.rate_loop_frequency` times in a second, and filtered.
    """

    torque_limit: float = number(MISSING, _POSITIVE)
    control_period: float = number(MISSING, _POSITIVE)
    deadline: float = number(MISSING, _POSITIVE)
    settling_window: float = number(MISSING, _POSITIVE)
    driven_joint: int = 0
    action: str = "torque"

    def __post_init__(self) -> None:
        if self.action not in ACTIONS:
            raise ValueError(unknown_name("the action", self.action, ACTIONS))
        check_rows(self)
        for name in ("settling_window", "deadline"):
            value, period = getattr(self, name), self.control_period
            if value < period:
                raise ValueError(f"{name} = {value!r} s is below control_period = {period!r} s")
        if not is_whole_number(self.driven_joint, 0):
            raise ValueError(f"driven_joint = {self.driven_joint!r} must be the index of a joint, a whole number")

    @property
    def driven_joints(self) -> tuple[int, ...]:
        """Joint of each motor; an action has an entry for each."""
        return (self.driven_joint,)

    def samples(self, hardware: Hardware) -> int:
        """Samples of the drive in a control period, which they must fill: 1 where actions are torques."""
        samples = self.control_period * hardware.rate_loop_frequency if self.action == "rate" else 1.0
        if round(samples) < 1 or not math.isclose(samples, round(samples), rel_tol=1e-9):
            raise ValueError(
                f"rate_loop_frequency = {hardware.rate_loop_frequency!r} Hz makes {samples:g} samples of a control "
                f"period of {self.control_period!r} s; give one that makes a whole number, at least 1"
            )
        return round(samples)

    def numbers(self, hardware: Hardware) -> TaskNumbers:
        """The task, with the drives that it is done with, as the kernels take it."""
        samples = self.samples(hardware)
        period = self.control_period / samples
        motor = (
            self.torque_limit,
            response(hardware.motor_lag, period),
            hardware.torque_rate_limit * period,
            hardware.rate_loop_gain if self.action == "rate" else 0.0,
            response(hardware.rate_loop_lag, period),
        )
        motors = np.array([(joint, *motor) for joint in self.driven_joints], dtype=motor_type)
        deadline, window = float(self.deadline), float(self.settling_window)
        return TaskNumbers(float(self.control_period), deadline, window, period, samples, motors)


# Forms of a price, the codes of `reward.cost`: a figure costs `weight * min(figure / scale, bound)`.
BOUNDED = 0


class Version(NamedTuple):
    """A version of the task, the number of an environment's id: limits and times, the form of the prices, a code of
    `reward.cost`, and the prices of the terms that are charged, in the words of the keyword `reward`.
    """

    task: Task
    form: int
    prices: Mapping[str, object]


VERSIONS = {
    "v1": Version(
        Task(torque_limit=0.5, control_period=0.1, deadline=20.0, settling_window=10.0),
        BOUNDED,
        {"peak_impact": 1.0, "wear": 1.0, "missed_deadline": {"weight": 25.0, "bound": 2.0}},
    ),
}
CURRENT_VERSION = "v1"
PRESENT = VERSIONS[CURRENT_VERSION]
