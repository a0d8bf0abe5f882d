"""The physical figures of an episode, for `info["deployment"]`."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.running.simulation import Simulation


def episode_figures(simulation: Simulation, driven_joints: Sequence[int]) -> dict[str, Any]:
    """The physical figures of an episode so far, after a look at its accuracy.

    Args:
        simulation: of the episode.
        driven_joints: indices of the joints that motors work on.

    Warns:
        SimulationWarning: if it was less accurate than it looks, see `Simulation.check`.
    """
    simulation.check()
    state, joints = simulation.state, simulation.state.joints
    by_joint = m.joint_integrals(state.integrals)
    locked = float(state.clock["latched_joints"][0] > 0)
    latches = zip(joints["latch_time"], joints["latched"], strict=True)
    return {
        "latched": bool(joints["latched"].all()),
        "latch_times_s": [float(time) if latched else None for time, latched in latches],
        "peak_prelatch_force_N": joints["lock_peak_force" if locked else "peak_force"].tolist(),
        "peak_postlock_force_N": joints["postlock_peak_force"].tolist(),
        "sliding_work_J": by_joint[:, m.SLIDING_WORK].tolist(),
        "postlock_impulse_Ns": ((by_joint[:, m.IMPULSE] - joints["lock_impulse"]) * locked).tolist(),
        "postlock_sliding_work_J": ((by_joint[:, m.SLIDING_WORK] - joints["lock_sliding_work"]) * locked).tolist(),
        "wear_depth_max_m": np.maximum(state.wear_journal.max(axis=1), state.wear_bearing.max(axis=1)).tolist(),
        "contact_starts": joints["contact_starts"].tolist(),
        "motor_work_J": float(by_joint[list(driven_joints), m.MOTOR_WORK].sum()),
        "energy_residual_J": simulation.energy_residual(),
        "duration_s": simulation.time,
    }
