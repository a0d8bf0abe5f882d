"""Motion of the main body ("hub"), and the force and torque on it, from samples of a deployment.

The hub is rigid. If it is free, all momentum that it gains between two samples comes from the hinges. The mean loads
between the samples are then known exactly, however short the impacts between them are.
"""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from solar_env.array import ArrayParameters
from solar_env.array.data_files import write_columns
from solar_env.array.deployment import hub_place
from solar_env.array.parameters.parameters import MAIN_BODY
from solar_env.mechanics.equations.formulation import ModelArrays
from solar_env.mechanics.running.trajectory import Trajectory

Array = NDArray[np.float64]

_SHIFT = 1e-6  # s; time shift to either side of a sample; the coordinates of a rigid body are smooth


def hub_velocity(parameters: ArrayParameters, model: ModelArrays, q: Array, v: Array) -> Array:
    """Return the hub's (nt, 3) centroid velocity x, y [m/s] and spin [rad/s], from coordinates `q` and rates `v`."""
    ahead, behind = (hub_place(parameters, model, q + sign * _SHIFT * v) for sign in (1.0, -1.0))
    change = ahead - behind
    change[:, 2] = (change[:, 2] + np.pi) % (2.0 * np.pi) - np.pi
    return np.asarray(change / (2.0 * _SHIFT))


def sampled_hinge_loads(parameters: ArrayParameters, trajectory: Trajectory, place: Array) -> Array:
    """Return the (nt, 3) force x, y [N] and torque about the hub's centroid [N m] that root hinges exert on the hub.

    `place` holds the (nt, 3) position of the hub's centroid [m] and angle of the hub [rad], constant for a fixed hub.
    """
    total, (c, s) = np.zeros((len(place), 3)), (np.cos(place[:, 2]), np.sin(place[:, 2]))
    for root in (joint for joint in parameters.joints if joint.inboard == MAIN_BODY):
        k, x, y = root.index, root.side * parameters.hinge_x, parameters.hinge_y
        lever = trajectory.journal_radius[k] + trajectory.clearance[k] + trajectory.penetration[:, k]
        # Friction torque about the bearing's centre.
        friction = lever * trajectory.tangential_force[:, k] * (trajectory.clearance[k] > 0.0)
        arm, force = np.column_stack([c * x - s * y, s * x + c * y]), -trajectory.joint_force[:, k]
        turning = arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0] - root.sign * trajectory.joint_torque[:, k]
        total += np.column_stack([force, turning - friction])
    return total


def mean_loads(parameters: ArrayParameters, time: Array, velocity: Array) -> Array:
    """Return the (nt - 1, 3) mean force [N] and torque [N m] on a free hub between samples of its velocity (nt, 3)."""
    inertia = np.array([parameters.body_mass, parameters.body_mass, parameters.body_inertia])
    return np.asarray(inertia * np.diff(velocity, axis=0) / np.diff(time)[:, None])


def write_hub_loads(parameters: ArrayParameters, time: Array, loads: Array, path: Path) -> None:
    """Write a CSV file of the hub's mean loads from each sample to the next, with its mass and inertia in every row.

    Applied as constants over each row's interval, the loads reproduce the hub's momentum at every sample. `loads` has
    (nt - 1, 3) forces in inertial axes [N] and torques about the centroid [N m] between the (nt,) times [s].
    """
    columns = {"start_s": time[:-1], "end_s": time[1:], "force_x_N": loads[:, 0], "force_y_N": loads[:, 1]}
    hub = {"hub_mass_kg": parameters.body_mass, "hub_inertia_kgm2": parameters.body_inertia}
    same = {name: np.full(len(loads), value) for name, value in hub.items()}
    write_columns(path, columns | {"torque_z_Nm": loads[:, 2]} | same)
