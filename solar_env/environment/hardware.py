"""Sensors and motors of the hinge drives, which stand between the array and its controller.

A new imperfection is a field of `Hardware`, which `environment.task.sensors` or `environment.task.drive` uses.
"""

import math
import sys
from dataclasses import dataclass

from solar_env.array.parameters.checks import Rule, Usual, check_rows, number
from solar_env.support.values import is_whole_number

_NOT_NEGATIVE = Rule(0.0, sys.float_info.max, "must be a finite number, not negative")
_POSITIVE = Rule(math.ulp(0.0), sys.float_info.max, "must be a positive finite number")
_ANGLE, _RATE = Usual(0.0, 0.3, "rad", "degrees"), Usual(0.0, 1.0, "rad/s", "degrees per second")
_LAG = Usual(1e-6, 10.0, "s", "ms")

# Names of the `Hardware` fields that configure the drive's rate loop.
OF_THE_LOOP = ("rate_loop_gain", "rate_loop_frequency", "rate_loop_lag", "setpoint_rate_limit", "load_compensation")


@dataclass(frozen=True)
class Hardware:
    """Imperfections of a hinge drive's sensors and motor, by default ideal, and settings of the drive's rate loop.

    Attributes:
        angle_noise: standard deviation of the noise in a measured joint angle [rad].
        rate_noise: standard deviation of the noise in a measured joint rate [rad/s].
        encoder_resolution: step of a measured joint angle [rad]; 0 for a continuous angle.
        sensor_delay: number of control periods between a measurement and the observation that shows the measurement.
        motor_lag: time constant with which the motor torque follows the drive's torque command [s]; 0 for no lag.
        torque_rate_limit: greatest rate of change of the motor torque [N m/s].
        attitude_noise: standard deviation of the noise in the main body's measured direction [rad].
        rate_loop_gain: torque of the drive's rate loop per rate error [N m s/rad].
        rate_loop_frequency: number of rate-loop samples per second [Hz], multiplied by a whole number if the loop would
            otherwise shake a light driven panel. The loop reads the rate with `rate_noise` and without delay, and holds
            its torque from one sample to the next.
        rate_loop_lag: time constant of the low-pass filter on the rate loop's torque [s]; 0 for no filter. Without a
            filter the loop reacts to the journals' rattle in their bearings, and shakes flexible panels.
        setpoint_rate_limit: greatest rate of change of the rate loop's setpoint [rad/s^2].
        load_compensation: whether the rate loop subtracts the springs' torque from its own. The springs' torque follows
            from the parameters before random sampling, since the drive's maker knows only these.
    """

    angle_noise: float = number(0.0, _NOT_NEGATIVE, _ANGLE)
    rate_noise: float = number(0.0, _NOT_NEGATIVE, _RATE)
    encoder_resolution: float = number(0.0, _NOT_NEGATIVE, _ANGLE)
    sensor_delay: int = 0
    motor_lag: float = number(0.0, _NOT_NEGATIVE, _LAG)
    torque_rate_limit: float = number(math.inf, Rule(math.ulp(0.0), math.inf, "must be a positive number"))
    attitude_noise: float = number(0.0, _NOT_NEGATIVE, _ANGLE)
    rate_loop_gain: float = number(12.0, _POSITIVE, Usual(1e-4, 5e3, "N m s/rad", "N mm s/rad"))
    rate_loop_frequency: float = number(100.0, _POSITIVE, Usual(1e-2, 1e5, "Hz", "kHz"))
    rate_loop_lag: float = number(0.1, _NOT_NEGATIVE, _LAG)
    setpoint_rate_limit: float = number(math.inf, Rule(math.ulp(0.0), math.inf, "must be a positive number"))
    load_compensation: bool = False

    def __post_init__(self) -> None:
        check_rows(self)
        if not isinstance(self.load_compensation, bool):
            raise ValueError(f"load_compensation = {self.load_compensation!r} must be True or False")
        if not is_whole_number(self.sensor_delay, 0) or self.sensor_delay > 100:
            raise ValueError(f"sensor_delay = {self.sensor_delay!r} must be a whole number of periods from 0 to 100")

    @property
    def ideal_sensors(self) -> bool:
        """True if the sensors have neither noise nor encoder steps nor delay."""
        noise = self.angle_noise, self.rate_noise, self.attitude_noise
        return not any((*noise, self.encoder_resolution, self.sensor_delay))


def response(lag: float, period: float) -> float:
    """Return the fraction of a step change that a first-order lag follows in a period; `lag` [s]: time constant."""
    return -math.expm1(-period / lag) if lag > 0.0 else 1.0
