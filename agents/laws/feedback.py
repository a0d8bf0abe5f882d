"""The simplest torque laws: no torque, a damper, and a spring and damper on the driven joint."""

from dataclasses import dataclass

import numpy as np

from agents.torque_laws import Entries, LawParameters, TorqueLaw, TunableLaw, bounded


class Passive(TorqueLaw):
    """Zero torque: the springs deploy the array alone."""

    def _torque(self, entries: Entries, all_latched: np.ndarray) -> np.ndarray:
        return np.zeros(len(all_latched))


@dataclass(frozen=True)
class DamperParameters(LawParameters):
    """Parameters of `ViscousDamper`.

    Attributes:
        damping: Torque per rate of the driven joint until the last joint has latched [N m s/rad].
        settling_damping: Torque per rate of the driven joint after the last joint has latched [N m s/rad].
    """

    damping: float = bounded(1.0, 0.0, 6.0)
    settling_damping: float = bounded(1.0, 0.0, 10.0)


class ViscousDamper(TunableLaw[DamperParameters]):
    """A torque against the rate of the driven joint, like the torque of rotary dampers in spring-driven hinges."""

    reads = ("rate_driven",)
    defaults = DamperParameters()

    def _torque(self, entries: Entries, all_latched: np.ndarray) -> np.ndarray:
        p = self.parameters
        return -np.where(all_latched, p.settling_damping, p.damping) * entries["rate_driven"]


@dataclass(frozen=True)
class ProportionalDerivativeParameters(LawParameters):
    """Parameters of `ProportionalDerivative`.

    Attributes:
        proportional_gain: Torque per angle that the driven joint still lacks to its lock angle [N m/rad].
        derivative_gain: Opposing torque per rate of the driven joint [N m s/rad].
        saturation: Greatest torque in either direction [N m].
    """

    proportional_gain: float = bounded(0.2, 0.0, 5.0)
    derivative_gain: float = bounded(2.0, 0.0, 10.0)
    saturation: float = bounded(0.3, 0.0, 0.5)


class ProportionalDerivative(TunableLaw[ProportionalDerivativeParameters]):
    """A saturated spring and damper between the driven joint and its lock angle, before and after latching.

    K. J. Åström and R. M. Murray, Feedback Systems, 2nd ed., Princeton University Press, 2021, chapter 11.
    """

    reads = ("theta_driven", "rate_driven")
    defaults = ProportionalDerivativeParameters()

    def _torque(self, entries: Entries, all_latched: np.ndarray) -> np.ndarray:
        p = self.parameters
        short = self._signals.driven_lock_angle * (1.0 - entries["theta_driven"])
        return np.clip(
            p.proportional_gain * short - p.derivative_gain * entries["rate_driven"], -p.saturation, p.saturation
        )
