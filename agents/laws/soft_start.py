"""A torque over time that hands over to the servo."""

from dataclasses import dataclass

import numpy as np

from agents.laws.servo import ServoParameters, VelocityProfileServo
from agents.torque_laws import Entries, bounded


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
    """A servo that lands the array, after a torque over time that starts it gently.

    The servo alone accelerates the array at once, to have time for the landing, and nearly all wear of a soft
    deployment comes from that start. The last latch ends the torque over time.
    """

    parameters: SoftStartParameters
    defaults = SoftStartParameters()

    def _torque(self, entries: Entries, all_latched: np.ndarray) -> np.ndarray:
        p = self.parameters
        time = (1.0 - entries["time_to_deadline"]) * self._signals.deadline
        of_time = np.interp(time, np.arange(len(p.torques)) * 4.0 / 3.0, p.torques)
        of_servo = np.where(all_latched, 1.0, np.clip((time - p.handover) / p.blending, 0.0, 1.0))
        return (1.0 - of_servo) * of_time + of_servo * super()._torque(entries, all_latched)
