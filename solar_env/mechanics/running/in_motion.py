"""Time, motor torques, saved states and initial stops of every kind of simulation."""

import math
from abc import ABC, abstractmethod
from typing import Any, Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.joints import joint as columns
from solar_env.mechanics.modal.arrays import ModalState

StateT = TypeVar("StateT", m.State, ModalState)


class InMotion(ABC, Generic[StateT]):
    """A mechanism in motion: arrays of a model and of a state, whose table of joint loads a subclass evaluates."""

    model: Any
    state: StateT

    @abstractmethod
    def joint_loads(self) -> NDArray[np.float64]:
        """(joints, columns) table of angles, rates, forces and torques now; columns are named in `joint.py`."""

    def _engage_stops(self) -> None:
        """Engage the stow stops that the initial angles lie in, lest their energy be missing from the book."""
        joints, angles = self.model.joints, self.joint_loads()[:, columns.ANGLE]
        inside = joints["stow_angle"] - joints["stop_gap"] - angles > 0.0
        self.state.joints["stop_engaged"] = inside & (joints["has_stow_stop"] != 0)

    @property
    def time(self) -> float:
        """Time [s]."""
        return float(self.state.clock["time"][0])

    def restore(self, snapshot: StateT) -> None:
        """Continue from a snapshot of this simulation or of one of the same mechanism.

        Raises:
            ValueError: if the snapshot's arrays do not fit the mechanism.
        """
        for name, mine, theirs in zip(self.state._fields, self.state, snapshot, strict=True):
            if mine.shape != theirs.shape:
                raise ValueError(f"snapshot.{name} has shape {theirs.shape}, this mechanism needs {mine.shape}")
        for mine, theirs in zip(self.state, snapshot, strict=True):
            mine[...] = theirs

    def set_motor_torque(self, joint: int, torque: float) -> None:
        """Set the motor torque on a joint's angle [N m], held until it is set again.

        Raises:
            ValueError: if the torque is not finite.
        """
        if not math.isfinite(torque):
            raise ValueError(f"motor torque = {torque!r} N m must be finite")
        if self.state.joints[joint]["motor_torque"] != torque:
            self.state.joints[joint]["motor_torque"] = torque
            self.state.clock["acceleration_current"] = 0

    def _check_end_time(self, end_time: float) -> None:
        if not self.time <= end_time < math.inf:
            raise ValueError(
                f"end_time = {end_time!r} s must be finite and not before the present time {self.time!r} s"
            )
