"""Torque laws that make the opening follow a velocity profile, at once or after an open-loop torque history."""

from dataclasses import dataclass

import numpy as np

from agents.torque_laws import OPENING, Entries, LawParameters, TunableLaw, bounded, weighted_opening

RESERVE = 0.5  # time before the deadline by which the profile ends [s]
LEAST_TIME = 0.1  # shortest time in which the profile covers the rest of the opening [s]


@dataclass(frozen=True)
class ServoParameters(LawParameters):
    """Parameters of `VelocityProfileServo`.

    Opening is measured in units of the lock angle (0 folded, 1 locked), opening rates in 1/s.

    Attributes:
        cruise_rate: Opening rate of the profile far from latching [1/s].
        latch_rate: Opening rate of the profile at the lock angle [1/s].
        deceleration: Deceleration of the profile ahead of the lock angle [1/s^2].
        gain: Torque per opening-rate error [N m s].
        joint_2_weight: Weight of joint 2 in the opening that follows the profile; joint 1 has the rest.
        difference_damping: Torque on joint 1 against the opening-rate difference of the joints, which the
            cable loop makes oscillate [N m s].
        settling_damping: Torque per rate of the driven joint after the last latch [N m s/rad].
        settling_stiffness: Torque after the last latch per angle of the driven joint off its lock angle [N m/rad]: a
            latched joint still has play, and the array would swing across the play.
        smoothing: Fraction of the motor torque that carries over to the next control period. This low-pass filter
            suppresses vibrations in the rates, and makes the motor let go of the springs gradually at the last latch.
    """

    cruise_rate: float = bounded(0.08, 0.05, 0.2)
    latch_rate: float = bounded(0.015, 0.001, 0.06)
    deceleration: float = bounded(0.004, 0.0005, 0.02)
    gain: float = bounded(20.0, 1.0, 80.0)
    joint_2_weight: float = bounded(0.5, 0.0, 1.0)
    difference_damping: float = bounded(0.0, 0.0, 40.0)
    settling_damping: float = bounded(0.0, 0.0, 10.0)
    settling_stiffness: float = bounded(0.0, 0.0, 20.0)
    smoothing: float = bounded(0.0, 0.0, 0.95)


class VelocityProfileServo(TunableLaw[ServoParameters]):
    """Feedback that makes the opening follow a velocity profile which slows down towards latching.

    The opening `s` is a weighted mean of two joints' angles, each divided by its lock angle: 0 is folded, 1 is locked.
    The profile has the rate `min(cruise_rate, sqrt(latch_rate^2 + 2 deceleration (1 - s)))` [1/s], but is never too
    slow to reach the lock angle by the time `RESERVE` ahead of the deadline. The cable loop that couples joints 1 and 2
    is elastic, so that they latch apart in time; a profile for joint 1 alone does not lower the impact. The torque
    grows with the rate's error from the profile, and passes a low-pass filter.
    """

    reads = (*OPENING, "theta_driven", "rate_driven", "motor_torque", "time_to_deadline")
    defaults = ServoParameters()

    def reference_rate(self, opening: np.ndarray, time_left: np.ndarray | float = np.inf) -> np.ndarray:
        """Return the opening rate of the profile [1/s].

        Args:
            opening: Opening in units of the lock angle, any shape.
            time_left: Time before the deadline [s], of the same shape.
        """
        p = self.parameters
        to_go = np.maximum(1.0 - opening, 0.0)
        profile = np.minimum(p.cruise_rate, np.sqrt(p.latch_rate**2 + 2.0 * p.deceleration * to_go))
        return np.maximum(profile, to_go / np.maximum(time_left - RESERVE, LEAST_TIME))

    def _torque(self, entries: Entries, all_latched: np.ndarray) -> np.ndarray:
        p = self.parameters
        opening, rate, difference = weighted_opening(entries, p.joint_2_weight, self._signals.lock_angles)
        time_left = self._signals.deadline * entries["time_to_deadline"]
        deploying = p.gain * (self.reference_rate(opening, time_left) - rate) - p.difference_damping * difference
        off_lock = self._signals.driven_lock_angle * (entries["theta_driven"] - 1.0)
        holding = -p.settling_damping * entries["rate_driven"] - p.settling_stiffness * off_lock
        now = self._signals.torque_limit * entries["motor_torque"]
        return p.smoothing * now + (1.0 - p.smoothing) * np.where(all_latched, holding, deploying)


@dataclass(frozen=True)
class SoftStartParameters(ServoParameters):
    """Parameters of `SoftStartServo`.

    Attributes:
        torques: Torques at every 4/3 s from the start of the deployment [N m].
        handover: Time at which the servo begins to take over [s].
        blending: Duration of the transition to the servo [s].
    """

    torques: tuple[float, ...] = bounded((0.0,) * 12, -0.5, 0.5)
    handover: float = bounded(12.0, 8.0, 15.0)
    blending: float = bounded(2.0, 0.1, 5.0)


class SoftStartServo(VelocityProfileServo):
    """A servo that brings the array slowly to the latches, after an open-loop torque history for a gentle start.

    The servo takes over gradually from the time `handover` on, or without transition at the last latch, when it begins
    to damp the swing. Without the history it would accelerate the array abruptly, to have time for the slow arrival. An
    abrupt start causes nearly all wear of deployments with a slow arrival.
    """

    parameters: SoftStartParameters
    defaults = SoftStartParameters()

    def _torque(self, entries: Entries, all_latched: np.ndarray) -> np.ndarray:
        p = self.parameters
        time = (1.0 - entries["time_to_deadline"]) * self._signals.deadline
        of_time = np.interp(time, np.arange(len(p.torques)) * 4.0 / 3.0, p.torques)
        of_servo = np.where(all_latched, 1.0, np.clip((time - p.handover) / p.blending, 0.0, 1.0))
        return (1.0 - of_servo) * of_time + of_servo * super()._torque(entries, all_latched)
