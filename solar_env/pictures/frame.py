"""Frames of a deployment, drawn without a display: the array, its magnified bearings, and the contact forces."""

import math
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray
from PIL import Image, ImageDraw, ImageFont

from solar_env.pictures.style import COLOURS, FORCE_DECADES

Array = NDArray[np.float64]

WIDTH, HEIGHT = 960, 540  # pixels of a frame
MAX_BEARINGS = 3  # most bearings in a frame, which has room for no more
SUPERSAMPLING = 2
LARGE, NORMAL, SMALL = 23.0, 15.0, 12.5  # sizes of type [pixels]
INK, QUIET, GRID, CARD, PAPER = "#1d2733", "#66717f", "#e3e8ee", "#ffffff", "#e9edf2"
BODY, BODY_EDGE, PANEL, PANEL_SHINE = "#d8b365", "#a67c2d", "#1f3f77", "#7fa6d9"
BEARING, BOLT, JOURNAL, JOURNAL_MARK, FORCE = "#aeb9c6", "#7c8896", "#3d4a5c", "#75839a", "#e01e37"
LATCHED = "#1a7f37"
CARDS = ((12, 12, 616, 326), (12, 338, 616, 528), (628, 12, 948, 528))
ARRAY_BOX, FORCE_BOX, BEARING_BOX = (18, 58, 610, 306), (62, 370, 602, 500), (640, 50, 814, 520)

JOURNAL_SHARE = 0.72  # drawn journal radius / drawn bearing radius; the rest stands for the clearance
# The spacecraft turns against the unfolding panels, by 2 degrees with one panel and 20 with eight.
TILT, SWAY = math.radians(22.0), math.radians(3.0)  # room in the view for this turn, and for a turn with the panels


@dataclass(frozen=True, eq=False)
class Scene:
    """One instant of a deployment in plain numbers. Vectors are in one fixed frame; each of nj joints has a panel.

    Attributes:
        time: time since release [s].
        main_body: corners of the main body, in order round it, (4, 2) [m].
        panels: one polyline per panel, from its inner hinge to its tip, each (k, 2) with k >= 2 [m].
        hinges: centres of the bearings, (nj, 2) [m].
        eccentricity: journal centre minus bearing centre, (nj, 2) [m].
        clearance: radial clearance, (nj,) [m]; 0 for an ideal joint.
        in_contact: whether the journal presses on the bearing, (nj,) bool.
        normal_force: contact force, or joint force of an ideal joint, (nj,) [N].
        latched: whether the joint has latched, (nj,) bool.
        motor_torques: torque of every motor [N m].
        force_times: instants of the force history, ascending, (n,) [s].
        force_history: forces at those instants, (n, nj) [N].
        wings: number of wings; all panels of a wing precede the panels of the next wing.
    """

    time: float
    main_body: Array
    panels: tuple[Array, ...]
    hinges: Array
    eccentricity: Array
    clearance: Array
    in_contact: NDArray[np.bool_]
    normal_force: Array
    latched: NDArray[np.bool_]
    motor_torques: tuple[float, ...]
    force_times: Array
    force_history: Array
    wings: int = 1


class Canvas:
    """An image that is drawn enlarged, and later reduced for smooth edges. Coordinates are the final pixels, y down."""

    def __init__(self, image: Image.Image) -> None:
        self.image = image
        self._pen = ImageDraw.Draw(image)

    def line(self, points: ArrayLike, colour: str, width: float) -> None:
        """Draw a polyline through points (k, 2)."""
        self._pen.line(_enlarged(points), fill=colour, width=max(1, round(width * SUPERSAMPLING)), joint="curve")

    def polygon(self, points: ArrayLike, colour: str) -> None:
        """Fill a polygon whose corners are `points` (k, 2)."""
        self._pen.polygon(_enlarged(points), fill=colour)

    def card(self, box: tuple[int, int, int, int]) -> None:
        """Fill a rectangle (left, top, right, bottom) with rounded corners."""
        self._pen.rounded_rectangle([SUPERSAMPLING * side for side in box], radius=8 * SUPERSAMPLING, fill=CARD)

    def disc(self, centre: ArrayLike, radius: float, colour: str) -> None:
        """Fill a circle of a radius [pixels] round its centre."""
        self._pen.circle(_enlarged(np.reshape(centre, (1, 2)))[0], radius * SUPERSAMPLING, fill=colour)

    def arrow(self, tail: Array, tip: Array, colour: str, width: float) -> None:
        """Draw an arrow with a filled head; draw nothing for an arrow without length."""
        length = math.hypot(*(tip - tail))
        if length == 0.0:
            return
        along = (tip - tail) / length
        head = min(3.5 * width, length)
        neck, across = tip - head * along, 0.6 * head * np.array([-along[1], along[0]])
        self.line([tail, neck + 0.2 * head * along], colour, width)
        self.polygon([tip, neck + across, neck - across], colour)

    def write(self, x: float, y: float, text: str, size: float = NORMAL, colour: str = INK, anchor: str = "ls") -> None:
        """Write a text at a point; `anchor` is in Pillow's notation ("ls": the baseline begins at the point)."""
        at = (x * SUPERSAMPLING, y * SUPERSAMPLING)
        self._pen.text(at, text, fill=colour, font=_font(size * SUPERSAMPLING), anchor=anchor)


def _enlarged(points: ArrayLike) -> list[tuple[float, float]]:
    return [(x, y) for x, y in (SUPERSAMPLING * np.asarray(points, dtype=float)).tolist()]


@cache
def _font(size: float) -> ImageFont.FreeTypeFont | ImageFont.ImageFont:
    """Return Pillow's typeface, which has ASCII and little more, but is the same on every machine."""
    return ImageFont.load_default(size)


class Renderer:
    """A renderer that draws instants of one deployment, each a `Scene`, into frames with one fixed view.

    Args:
        initial: the folded array. The view has room for the folded and the deployed array, and for the spacecraft's
            rotation in reaction to the deployment.
        duration: right end of the time axis [s].
    """

    def __init__(self, initial: Scene, duration: float) -> None:
        self._duration, self._shown = duration, min(len(initial.panels), MAX_BEARINGS)
        lowest, highest = _extent(initial)
        left, top, right, bottom = ARRAY_BOX
        self._scale = 0.95 * float(np.min([right - left, bottom - top] / (highest - lowest)))
        self._world_middle, self._middle = (lowest + highest) / 2, np.array([left + right, top + bottom]) / 2
        self._background = Image.new("RGB", (WIDTH * SUPERSAMPLING, HEIGHT * SUPERSAMPLING), PAPER)
        canvas = Canvas(self._background)
        for card in CARDS:
            canvas.card(card)
        self._label(canvas, "Contact force [N]" if np.any(initial.clearance) else "Joint force [N]")

    def draw(self, scene: Scene) -> NDArray[np.uint8]:
        """Return the frame of a scene as an image, uint8 (540, 960, 3). The same scene gives the same pixels."""
        canvas = Canvas(self._background.copy())
        self._draw_array(canvas, scene)
        self._draw_forces(canvas, scene)
        for joint in range(self._shown):
            self._draw_bearing(canvas, scene, joint)
        return np.array(canvas.image.reduce(SUPERSAMPLING))

    def place(self, points: ArrayLike) -> Array:
        """Convert points (..., 2) of the plane [m] to pixels (..., 2) of the frame."""
        return self._middle + (np.asarray(points) - self._world_middle) * (self._scale, -self._scale)

    def bearing(self, joint: int) -> tuple[Array, float]:
        """Return the centre (2,) and inner radius [pixels] of a joint's magnified bearing."""
        left, top, right, bottom = BEARING_BOX
        share = (bottom - top) / max(self._shown, 2)
        outer = min(share - 10.0, right - left) / 2
        return np.array([left + outer, (top + bottom) / 2 + (joint - (self._shown - 1) / 2) * share]), 0.84 * outer

    def force_place(self, times: ArrayLike, forces: ArrayLike) -> Array:
        """Convert forces [N] at times [s] to pixels (..., 2); forces beyond the scale lie at the ends of the scale."""
        left, top, right, bottom = FORCE_BOX
        x, y = np.broadcast_arrays(np.asarray(times) / self._duration, _force_share(forces))
        return np.stack([left + x * (right - left), bottom - y * (bottom - top)], axis=-1)

    def _label(self, canvas: Canvas, title: str) -> None:
        """Write the force chart's `title`, the bearings' names and the scales, and draw the chart's grid."""
        canvas.write(28, 359, title)
        canvas.write(644, 37, "Bearings, clearance enlarged")
        for joint in range(self._shown):
            y = self.bearing(joint)[0][1]
            canvas.write(828, y - 46, f"Joint {joint + 1}", NORMAL, COLOURS[joint])
        for force in 10.0 ** np.arange(FORCE_DECADES[0], FORCE_DECADES[1] + 1):
            ends = self.force_place([0.0, self._duration], force)
            canvas.line(ends, GRID, 1)
            canvas.write(ends[0, 0] - 7, ends[0, 1], f"{force:g}", SMALL, QUIET, anchor="rm")
        ticks = np.arange(0.0, self._duration * (1.0 + 1e-9), _tick_spacing(self._duration))
        for tick in ticks:
            ends = self.force_place(tick, 10.0 ** np.array(FORCE_DECADES, dtype=float))
            canvas.line(ends, GRID, 1)
            text = f"{tick:g} s" if tick == ticks[-1] else f"{tick:g}"
            canvas.write(ends[0, 0], ends[0, 1] + 6, text, SMALL, QUIET, anchor="mt")

    def _draw_array(self, canvas: Canvas, scene: Scene) -> None:
        """Draw main body, panels and hinges to scale, and write time, motor torque and latches."""
        canvas.line([(28, 315), (28 + self._scale, 315)], QUIET, 2)
        canvas.write(34 + self._scale, 319, "1 m", SMALL, QUIET)
        corners = self.place(scene.main_body)
        canvas.polygon(corners, BODY)
        canvas.line([*corners, corners[0], corners[1]], BODY_EDGE, 2)
        for panel in scene.panels:
            canvas.line(self.place(panel), PANEL, 6)
            canvas.line(self.place(panel), PANEL_SHINE, 1.5)
        for joint, hinge in enumerate(self.place(scene.hinges)):
            canvas.disc(hinge, 6.5, COLOURS[joint % len(COLOURS)])
            if not scene.latched[joint]:
                canvas.disc(hinge, 3.5, CARD)
        canvas.write(28, 44, f"{scene.time:.2f} s", LARGE)
        canvas.write(320, 43, f"motor {', '.join(f'{torque:+.3f}' for torque in scene.motor_torques)} N m", anchor="ms")
        canvas.write(600, 43, f"{int(np.sum(scene.latched))} of {len(scene.panels)} latched", anchor="rs")

    def _draw_forces(self, canvas: Canvas, scene: Scene) -> None:
        """Draw every joint's force up to now on a logarithmic scale, where both impacts and quiet contact show."""
        canvas.line(self.force_place(scene.time, 10.0 ** np.array(FORCE_DECADES, dtype=float)), QUIET, 1)
        columns = self.force_place(scene.force_times, 1.0)[:, 0]
        starts = np.flatnonzero(np.diff(np.floor(columns), prepend=-np.inf))
        for joint, force in enumerate(scene.normal_force):
            colour = COLOURS[joint % len(COLOURS)]
            if len(starts) > 0:
                # Draw the largest force of each pixel column: impacts last less than a pixel.
                peaks = np.maximum.reduceat(scene.force_history[:, joint], starts)
                canvas.line(self.force_place(scene.force_times[starts], peaks), colour, 1.5)
            if scene.in_contact[joint]:
                canvas.disc(self.force_place(scene.time, force), 3.5, colour)

    def _draw_bearing(self, canvas: Canvas, scene: Scene, joint: int) -> None:
        """Draw a bearing and its journal with enlarged clearance, and the contact force; write the joint's state."""
        centre, radius = self.bearing(joint)
        clearance, force = float(scene.clearance[joint]), float(scene.normal_force[joint])
        offset = np.zeros(2)
        if clearance > 0.0:  # circles touch exactly when the eccentricity is as long as the clearance
            offset = scene.eccentricity[joint] / clearance * (1.0 - JOURNAL_SHARE) * radius * (1.0, -1.0)
        canvas.disc(centre, radius / 0.84, BEARING)
        root = joint % (len(scene.panels) // scene.wings) == 0
        carrier = scene.main_body[:2] if root else scene.panels[joint - 1][-2:]
        for bolt in _crosswise(carrier):
            canvas.disc(centre + 1.095 * radius * bolt, 2.5, BOLT)
        canvas.disc(centre, radius, CARD)
        canvas.disc(centre + offset, JOURNAL_SHARE * radius, JOURNAL)
        for mark in _crosswise(scene.panels[joint][:2]):
            canvas.line([centre + offset, centre + offset + 0.6 * JOURNAL_SHARE * radius * mark], JOURNAL_MARK, 2)
        if scene.in_contact[joint] and np.any(offset):
            outward = offset / math.hypot(*offset)
            contact = centre + radius * outward
            length = float(_force_share(force)) * 2.0 * JOURNAL_SHARE * radius
            canvas.arrow(contact, contact - length * outward, FORCE, 4)
            canvas.disc(contact, 5, FORCE)
        x, y = 828, centre[1]
        canvas.write(x, y - 14, f"{force:.0f} N" if force >= 99.5 else f"{round(force, 3):.3g} N", LARGE)
        if clearance == 0.0:
            canvas.write(x, y + 11, "ideal joint", SMALL, QUIET)
        elif scene.in_contact[joint]:
            canvas.write(x, y + 11, "in contact", SMALL, FORCE)
        else:
            gap = clearance - math.hypot(*scene.eccentricity[joint])
            canvas.write(x, y + 11, f"gap {1e3 * gap:.3f} mm", SMALL, QUIET)
        if clearance > 0.0:
            canvas.write(x, y + 27, f"clearance {1e3 * clearance:.2f} mm", SMALL, QUIET)
        latch, colour = ("latched", LATCHED) if scene.latched[joint] else ("free", QUIET)
        canvas.write(x, y + 50, latch, NORMAL, colour)


def _extent(folded: Scene) -> tuple[Array, Array]:
    """Return lower left and upper right corners (2,) [m] of a view that holds the array from folded to deployed."""
    centre, hinge = folded.main_body.mean(axis=0), folded.hinges[0]
    dx, dy = folded.panels[0][-1] - folded.panels[0][0]  # along the first folded panel and the body's side
    outward = np.array([-dy, dx]) / math.hypot(dx, dy)
    side = np.sign(outward @ (hinge - centre))
    reach = sum(float(np.sum(np.hypot(*np.diff(panel, axis=0).T))) for panel in folded.panels) / folded.wings
    points = [folded.main_body, *folded.panels]
    for tilt in (-side * TILT, side * SWAY):
        turn = np.array([[math.cos(tilt), -math.sin(tilt)], [math.sin(tilt), math.cos(tilt)]])
        for wing in (1.0, -1.0)[: folded.wings]:
            tip = centre + wing * (hinge + side * reach * outward - centre)
            points.append(centre + (np.array([*folded.main_body, tip]) - centre) @ turn.T)
    every = np.concatenate(points)
    return every.min(axis=0), every.max(axis=0)


def _force_share(forces: ArrayLike) -> Array:
    """Return the positions of forces [N] on the logarithmic scale, from 0 to 1."""
    low, high = FORCE_DECADES
    return (np.log10(np.clip(forces, 10.0**low, 10.0**high)) - low) / (high - low)


def _tick_spacing(duration: float) -> float:
    """Return the round spacing [s] that gives four to nine ticks in a duration [s]."""
    power = 10.0 ** math.floor(math.log10(duration / 8.0))
    return next(step * power for step in (1.0, 2.0, 5.0, 10.0) if step * power >= duration / 8.0)


def _crosswise(segment: Array) -> Array:
    """Return four unit vectors (4, 2) in pixel axes (y down): along a segment, to its right, and their opposites.

    The segment leads from point `segment[0]` to `segment[1]`, in axes with y up; further points are ignored.
    """
    dx, dy = segment[1] - segment[0]
    along, across = np.array([(dx, -dy), (dy, dx)]) / math.hypot(dx, dy)
    return np.array([along, across, -along, -across])
