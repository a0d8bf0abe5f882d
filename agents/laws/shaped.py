"""Feedback that makes the opening follow an input-shaped motion over time."""

from dataclasses import dataclass

import numpy as np

from agents.torque_laws import OPENING, Entries, LawParameters, TunableLaw, bounded, weighted_opening


@dataclass(frozen=True)
class ShapedProfileParameters(LawParameters):
    """Parameters of `InputShapedProfile`.

    Opening is measured in units of the lock angle (0 folded, 1 locked), opening rates in 1/s.

    Attributes:
        duration: Time that the profile takes before it is shaped [s].
        latch_rate: Opening rate at its end [1/s].
        vibration_period: Period of the vibration to leave at rest [s]; 0: no shaping.
        gain: Torque per opening-rate error [N m s].
        stiffness: Torque per opening error [N m].
        joint_2_weight: Share of joint 2 in the opening that follows the profile; joint 1 has the rest.
        settling_damping: Torque per rate of the driven joint after the last latch [N m s/rad].
    """

    duration: float = bounded(15.0, 6.0, 19.5)
    latch_rate: float = bounded(0.01, 0.001, 0.06)
    vibration_period: float = bounded(1.0, 0.0, 4.0)
    gain: float = bounded(20.0, 1.0, 80.0)
    stiffness: float = bounded(2.0, 0.0, 20.0)
    joint_2_weight: float = bounded(0.5, 0.0, 1.0)
    settling_damping: float = bounded(1.0, 0.0, 10.0)


class InputShapedProfile(TunableLaw[ShapedProfileParameters]):
    """Feedback that makes the opening follow a motion over time, shaped to leave a vibration at rest.

    The motion is the cubic from rest to the latch rate. The shaper of zero vibration for an undamped mode averages it
    with itself half a period later (N. C. Singer and W. P. Seering, Preshaping Command Inputs to Reduce System
    Vibration, J. Dyn. Syst. Meas. Control 112 (1990) 76-82, doi:10.1115/1.2894142).
    """

    reads = (*OPENING, "rate_driven", "time_to_deadline")
    defaults = ShapedProfileParameters()

    def reference(self, time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the opening in units of the lock angle and its rate [1/s] at a time [s]; any shape."""
        first, later = self._unshaped(time), self._unshaped(time - 0.5 * self.parameters.vibration_period)
        return 0.5 * (first[0] + later[0]), 0.5 * (first[1] + later[1])

    def _unshaped(self, time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        p = self.parameters
        u = np.clip(time / p.duration, 0.0, 1.0)
        end = p.latch_rate * p.duration
        beyond = np.maximum(time - p.duration, 0.0)
        opening = u * u * (3.0 - 2.0 * u) + end * u * u * (u - 1.0) + p.latch_rate * beyond
        return opening, (6.0 * u * (1.0 - u) + end * u * (3.0 * u - 2.0)) / p.duration

    def _torque(self, entries: Entries, all_latched: np.ndarray) -> np.ndarray:
        p = self.parameters
        opening, rate, _ = weighted_opening(entries, p.joint_2_weight)
        wanted, wanted_rate = self.reference((1.0 - entries["time_to_deadline"]) * self._signals.deadline)
        deploying = p.gain * (wanted_rate - rate) + p.stiffness * (wanted - opening)
        return np.where(all_latched, -p.settling_damping * entries["rate_driven"], deploying)
