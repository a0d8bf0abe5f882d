"""One instant of a deployment as plain numbers, from which a frame is drawn."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Scene:
    """One instant of a deployment. Vectors are in one fixed frame; nj is the number of joints, one per panel.

    Attributes:
        time: time since release [s].
        main_body: corners of the main body, in order round it, (4, 2) [m].
        panels: one polyline per panel, from its inner hinge to its tip, each (k, 2) with k >= 2 [m].
        hinges: centres of the bearings, (nj, 2) [m].
        eccentricity: journal centre minus bearing centre, (nj, 2) [m].
        clearance: radial clearance, (nj,) [m]; 0 for an ideal joint.
        journal_radius: (nj,) [m].
        in_contact: whether the journal presses on the bearing, (nj,) bool.
        normal_force: contact force; of an ideal joint the joint force, (nj,) [N].
        latched: (nj,) bool.
        motor_torque: torque of the root-hinge motor [N m].
        force_times: instants of the force history, ascending, (n,) [s].
        force_history: forces at those instants, (n, nj) [N].

    Raises:
        ValueError: an array has the wrong shape; the message names it.
    """

    time: float
    main_body: Array
    panels: tuple[Array, ...]
    hinges: Array
    eccentricity: Array
    clearance: Array
    journal_radius: Array
    in_contact: NDArray[np.bool_]
    normal_force: Array
    latched: NDArray[np.bool_]
    motor_torque: float
    force_times: Array
    force_history: Array

    def __post_init__(self) -> None:
        joints, samples = len(self.panels), len(self.force_times)
        shapes: dict[str, tuple[int, ...]] = {
            "main_body": (4, 2),
            **dict.fromkeys(("hinges", "eccentricity"), (joints, 2)),
        }
        shapes |= dict.fromkeys(("clearance", "journal_radius", "in_contact", "normal_force", "latched"), (joints,))
        shapes |= {"force_times": (samples,), "force_history": (samples, joints)}
        for name, expected in shapes.items():
            if (given := np.shape(getattr(self, name))) != expected:
                raise ValueError(f"{name} has shape {given}, expected {expected} for {joints} panels")
        if joints == 0 or any(np.ndim(p) != 2 or len(p) < 2 or np.shape(p)[1] != 2 for p in self.panels):
            raise ValueError("panels needs at least one polyline, each of shape (k, 2) with k >= 2")
