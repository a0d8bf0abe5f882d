"""Frames of a deployment, drawn without a display: the array, its bearings magnified, and the contact force.

A frame is drawn from a `Scene`, plain numbers that say nothing of how they were computed. Pillow is
imported when the first `Renderer` is made, not with this module.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

MAX_BEARINGS = 3  # a frame has room for no more


@dataclass(frozen=True, eq=False)
class Scene:
    """One instant of a deployment. Vectors are in one fixed frame; nj is the number of joints, one a panel.

    Attributes:
        time: time since release [s].
        main_body: corners of the main body, in order round it, (4, 2) [m].
        panels: one polyline a panel, from its inner hinge to its tip, each (k, 2) with k >= 2 [m].
        hinges: centres of the bearings, (nj, 2) [m].
        eccentricity: journal centre minus bearing centre, (nj, 2) [m].
        clearance: radial clearance, (nj,) [m]; 0 for an ideal joint.
        journal_radius: (nj,) [m].
        in_contact: whether the journal presses on the bearing, (nj,) bool.
        normal_force: contact force; of an ideal joint the joint force, (nj,) [N].
        latched: (nj,) bool.
        motor_torque: torque of the motor [N m].
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
        shapes = {
            "main_body": (4, 2),
            "hinges": (joints, 2),
            "eccentricity": (joints, 2),
            "clearance": (joints,),
            "journal_radius": (joints,),
            "in_contact": (joints,),
            "normal_force": (joints,),
            "latched": (joints,),
            "force_times": (samples,),
            "force_history": (samples, joints),
        }
        for field in fields(self):
            if field.name in shapes and np.shape(getattr(self, field.name)) != shapes[field.name]:
                raise ValueError(
                    f"{field.name} has shape {np.shape(getattr(self, field.name))}, "
                    f"expected {shapes[field.name]} for {joints} panels"
                )
        if joints == 0 or any(np.ndim(p) != 2 or len(p) < 2 or np.shape(p)[1] != 2 for p in self.panels):
            raise ValueError("panels needs at least one polyline, each of shape (k, 2) with k >= 2")


class Renderer:
    """Draws the scenes of one deployment into frames of one size, with one fixed view.

    Args:
        initial: the folded array. The view is chosen so that it and the deployed array fit in, with room
            for the spacecraft's turn under the reaction.
        duration: right end of the time axis [s].
        size: width and height of a frame [pixels], at least 320 x 180.

    Raises:
        ValueError: the size is too small to be read or the duration is not positive.
    """

    def __init__(self, initial: Scene, duration: float = 30.0, size: tuple[int, int] = (960, 540)) -> None:
        from solar_env.pictures.views import ArrayView, BearingView, ForceView, Layout

        if size[0] < 320 or size[1] < 180:
            raise ValueError(f"size is {size[0]} x {size[1]} pixels; give at least 320 x 180")
        if not duration > 0.0:
            raise ValueError(f"duration is {duration} s; give a positive one")
        layout = Layout(size)
        shown = min(len(initial.panels), MAX_BEARINGS)
        graphs: list[ForceView | BearingView] = [ForceView(layout, initial, duration)]
        graphs += [BearingView(layout, joint, shown) for joint in range(shown)]
        self._views = [ArrayView(layout, initial), *graphs]
        self._frame = layout.cards()
        for graph in graphs:
            graph.label(layout.pen(self._frame))
        self._layout = layout

    def draw(self, scene: Scene) -> NDArray[np.uint8]:
        """The frame of a scene, uint8 (height, width, 3). The same scene gives the same pixels."""
        frame = self._frame.copy()
        pen = self._layout.pen(frame)
        for view in self._views:
            view.draw(scene, frame, pen)
        return np.array(frame)
