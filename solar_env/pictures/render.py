"""Frames of a deployment, drawn without a display: the array, its bearings magnified, and the contact force.

A frame is drawn from a `Scene`, plain numbers that say nothing of how they were computed. Pillow is
imported when the first `Renderer` is made, not with this module.
"""

import numpy as np
from numpy.typing import NDArray

from solar_env.pictures.scene import Scene

MAX_BEARINGS = 3  # a frame has room for no more


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
