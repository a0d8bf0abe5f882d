"""Parts of a frame: the array in its world, the contact force against time, a bearing magnified."""

import math

import numpy as np
from numpy.typing import ArrayLike
from PIL import Image

from solar_env.pictures.raster import CARD, GRID, INK, QUIET, Layout, Region, TextPen
from solar_env.pictures.scene import Array, Scene
from solar_env.pictures.style import COLOURS, FORCE_DECADES

BODY, BODY_EDGE, PANEL, PANEL_SHINE = "#d8b365", "#a67c2d", "#1f3f77", "#7fa6d9"
BEARING, BOLT, JOURNAL, JOURNAL_MARK, FORCE = "#aeb9c6", "#7c8896", "#3d4a5c", "#75839a", "#e01e37"
LATCHED = "#1a7f37"

JOURNAL_SHARE = 0.72  # drawn journal radius / drawn bearing radius; what is left stands for the clearance
# The spacecraft turns against the unfolding panels, by 2 degrees with one panel and 20 with eight.
TILT, SWAY = math.radians(22.0), math.radians(3.0)  # room in the view, with that turn and against it


class ArrayView:
    """Main body, panels and hinges to scale, with time, motor torque and latches in words."""

    def __init__(self, layout: Layout, initial: Scene) -> None:
        self._layout = layout
        self._region = Region(layout.box(18, 58, 610, 320))
        lowest, highest = extent(initial)
        room = np.array([self._region.right - self._region.left, self._region.bottom - self._region.top])
        self._scale = 0.93 * float(np.min(room / (highest - lowest)))
        self._middle = (lowest + highest) / 2
        self._origin = np.array([self._region.left, self._region.top]) + room / 2
        self._bar = round(layout.x(28)), round(layout.y(310))

    def place(self, points: ArrayLike) -> Array:
        """Pixels (..., 2) of points (..., 2) of the plane [m]."""
        return self._origin + (np.asarray(points) - self._middle) * (self._scale, -self._scale)

    def draw(self, scene: Scene, frame: Image.Image, pen: TextPen) -> None:
        """Draw the scene's array into the frame."""
        unit, region, layout = self._layout.unit, self._region, self._layout
        region.clear()
        x, y = self._bar
        region.line([(x, y), (x + self._scale, y)], QUIET, 2 * unit)
        corners = self.place(scene.main_body)
        region.polygon(corners, BODY)
        region.line([*corners, corners[0], corners[1]], BODY_EDGE, 2 * unit)
        for panel in scene.panels:
            region.line(self.place(panel), PANEL, 6 * unit)
            region.line(self.place(panel), PANEL_SHINE, 1.5 * unit)
        for joint, hinge in enumerate(self.place(scene.hinges)):
            region.disc(hinge, 6.5 * unit, COLOURS[joint % len(COLOURS)])
            if not scene.latched[joint]:
                region.disc(hinge, 3.5 * unit, CARD)
        region.paste_into(frame)
        pen.write((x + self._scale + 6 * unit, y + 4 * unit), "1 m", "small", QUIET)
        pen.write((layout.x(28), layout.y(44)), f"{scene.time:.2f} s", "large")
        pen.write((layout.x(320), layout.y(43)), f"motor {scene.motor_torque:+.3f} N m", "normal", INK, anchor="ms")
        latched = f"{int(np.sum(scene.latched))} of {len(scene.panels)} latched"
        pen.write((layout.x(600), layout.y(43)), latched, "normal", INK, anchor="rs")


def extent(folded: Scene) -> tuple[Array, Array]:
    """Lower left and upper right corner (2,) [m] of a view that holds the array from folded to deployed."""
    body = np.asarray(folded.main_body)
    centre, hinge = body.mean(axis=0), np.asarray(folded.hinges[0])
    along_panel = folded.panels[0][-1] - folded.panels[0][0]
    edges = np.array([body[1] - body[0], body[2] - body[1]])
    outward = edges[np.argmin(np.abs(edges @ along_panel))]  # folded panels lie along the side they hinge on
    outward = outward / math.hypot(*outward)
    if outward @ (hinge - centre) < 0.0:
        outward = -outward
    reach = sum(float(np.sum(np.hypot(*np.diff(panel, axis=0).T))) for panel in folded.panels)
    arm = hinge + reach * outward - centre
    swing = np.sign(along_panel[0] * outward[1] - along_panel[1] * outward[0])
    points = [body, *folded.panels]
    for tilt in (-swing * TILT, swing * SWAY):
        turn = np.array([[math.cos(tilt), -math.sin(tilt)], [math.sin(tilt), math.cos(tilt)]])
        points.append(centre + (np.array([*(body - centre), arm]) @ turn.T))
    every = np.concatenate(points)
    return every.min(axis=0), every.max(axis=0)


class ForceView:
    """Contact force of every joint against time; logarithmic, so that impacts and quiet contact both show."""

    def __init__(self, layout: Layout, initial: Scene, duration: float) -> None:
        self._layout, self._duration = layout, duration
        self._title = "Contact force [N]" if np.any(initial.clearance) else "Joint force [N]"
        self._region = region = Region(layout.box(62, 370, 602, 500))
        for decade in range(FORCE_DECADES[0], FORCE_DECADES[1] + 1):
            y = float(self._heights(10.0**decade))
            region.line([(region.left, y), (region.right, y)], GRID, layout.unit)
        self._ticks = np.arange(0.0, duration * (1.0 + 1e-9), tick_spacing(duration))
        for tick in self._ticks:
            x = float(self._across(tick))
            region.line([(x, region.top), (x, region.bottom)], GRID, layout.unit)
        region.keep_as_background()

    def _across(self, times: ArrayLike) -> Array:
        share = np.asarray(times) / self._duration
        return self._region.left + 0.5 + share * (self._region.right - self._region.left - 1.0)

    def _heights(self, forces: ArrayLike) -> Array:
        return self._region.bottom - 1.5 - force_share(forces) * (self._region.bottom - self._region.top - 3.0)

    def label(self, pen: TextPen) -> None:
        """Write the title and the scales."""
        layout, region = self._layout, self._region
        pen.write((layout.x(28), layout.y(359)), self._title)
        for decade in range(FORCE_DECADES[0], FORCE_DECADES[1] + 1):
            at = (region.left - 7 * layout.unit, float(self._heights(10.0**decade)))
            pen.write(at, f"{10.0**decade:g}", "small", QUIET, anchor="rm")
        for tick in self._ticks:
            last = tick == self._ticks[-1]
            at = (float(self._across(tick)), region.bottom + 6 * layout.unit)
            pen.write(at, f"{tick:g} s" if last else f"{tick:g}", "small", QUIET, anchor="mt")

    def draw(self, scene: Scene, frame: Image.Image, pen: TextPen) -> None:
        """Draw the forces up to the scene's time into the frame."""
        unit, region = self._layout.unit, self._region
        region.clear()
        now = float(self._across(scene.time))
        region.line([(now, region.top), (now, region.bottom)], QUIET, unit)
        columns = self._across(scene.force_times)
        starts = np.flatnonzero(np.diff(np.floor(columns), prepend=-np.inf))
        for joint in range(len(scene.panels)):
            colour = COLOURS[joint % len(COLOURS)]
            if len(starts) > 0:
                # One point a pixel column, its largest force: impacts last less than a pixel.
                peaks = np.maximum.reduceat(scene.force_history[:, joint], starts)
                region.line(np.column_stack([columns[starts], self._heights(peaks)]), colour, 1.5 * unit)
            if scene.in_contact[joint]:
                region.disc((now, float(self._heights(scene.normal_force[joint]))), 3.5 * unit, colour)
        region.paste_into(frame)


def force_share(forces: ArrayLike) -> Array:
    """Place of forces [N] on the logarithmic scale, from 0 to 1; a little below for those that it does not reach."""
    low, high = FORCE_DECADES
    return (np.log10(np.maximum(forces, 10.0 ** (low - 0.2))) - low) / (high - low)


def tick_spacing(duration: float) -> float:
    """Spacing [s] of four to ten round ticks."""
    rough = duration / 8.0
    power = 10.0 ** math.floor(math.log10(rough))
    return next(step * power for step in (1.0, 2.0, 5.0, 10.0) if step * power >= rough)


class BearingView:
    """One bearing with its journal, the clearance enlarged; contact point, force, and the state in words.

    Args:
        layout: of the frame.
        joint: its index.
        shown: number of bearings in the frame, which share the height.
    """

    def __init__(self, layout: Layout, joint: int, shown: int) -> None:
        self._layout, self._joint = layout, joint
        left, top, _, bottom = layout.box(640, 50, 940, 520)
        height = (bottom - top) / max(shown, 2)
        side = min(height - 10 * layout.unit, layout.x(174))
        middle = (top + bottom) / 2 + (joint - (shown - 1) / 2) * height
        self._region = Region((left, round(middle - side / 2), left + round(side), round(middle + side / 2)))
        self.centre = np.array([left + round(side) / 2, middle])
        self._outer = side / 2 - 1.0
        self.bearing_radius = 0.84 * self._outer
        self._text = left + side + 14 * layout.unit, middle

    def label(self, pen: TextPen) -> None:
        """Write the joint's name."""
        x, y = self._text
        unit = self._layout.unit
        colour = COLOURS[self._joint % len(COLOURS)]
        pen.write((x, y - 46 * unit), f"Joint {self._joint + 1}", "normal", colour)
        if self._joint == 0:
            pen.write((self._layout.x(644), self._layout.y(37)), "Bearings, clearance enlarged")

    def draw(self, scene: Scene, frame: Image.Image, pen: TextPen) -> None:
        """Draw the scene's bearing into the frame."""
        unit, region, joint = self._layout.unit, self._region, self._joint
        radius = self.bearing_radius
        carrier = scene.main_body[:2] if joint == 0 else scene.panels[joint - 1][-2:]
        offset = journal_offset(scene.eccentricity[joint], float(scene.clearance[joint]), radius)
        journal = self.centre + offset * (1.0, -1.0)
        region.clear()
        region.disc(self.centre, self._outer, BEARING)
        for bolt in crosswise(carrier):
            region.disc(self.centre + (self._outer + radius) / 2 * bolt, 2.5 * unit, BOLT)
        region.disc(self.centre, radius, CARD)
        region.disc(journal, JOURNAL_SHARE * radius, JOURNAL)
        for mark in crosswise(scene.panels[joint][:2]):
            region.line([journal, journal + 0.6 * JOURNAL_SHARE * radius * mark], JOURNAL_MARK, 2 * unit)
        if scene.in_contact[joint] and np.any(offset):
            self._draw_contact(offset * (1.0, -1.0), float(scene.normal_force[joint]))
        region.paste_into(frame)
        self._write(scene, pen)

    def _draw_contact(self, offset: Array, force: float) -> None:
        outward = offset / math.hypot(*offset)
        contact = self.centre + self.bearing_radius * outward
        length = max(0.0, float(force_share(force))) * 2.0 * JOURNAL_SHARE * self.bearing_radius
        self._region.arrow(contact, contact - length * outward, FORCE, 4 * self._layout.unit)
        self._region.disc(contact, 5 * self._layout.unit, FORCE)

    def _write(self, scene: Scene, pen: TextPen) -> None:
        x, y = self._text
        unit, joint = self._layout.unit, self._joint
        clearance = float(scene.clearance[joint])
        gap = clearance - math.hypot(*scene.eccentricity[joint])
        pen.write((x, y - 14 * unit), force_in_words(float(scene.normal_force[joint])), "large")
        if clearance == 0.0:
            pen.write((x, y + 11 * unit), "ideal joint", "small", QUIET)
        else:
            touching = bool(scene.in_contact[joint])
            state = "in contact" if touching else f"gap {1e3 * gap:.3f} mm"
            enlarged = (1.0 / JOURNAL_SHARE - 1.0) * float(scene.journal_radius[joint]) / clearance
            pen.write((x, y + 11 * unit), state, "small", FORCE if touching else QUIET)
            pen.write((x, y + 27 * unit), f"clearance {1e3 * clearance:.2f} mm", "small", QUIET)
            pen.write((x, y + 43 * unit), f"drawn x {enlarged:.0f}", "small", QUIET)
        latch, colour = ("latched", LATCHED) if scene.latched[joint] else ("free", QUIET)
        pen.write((x, y + 66 * unit), latch, "normal", colour)


def crosswise(segment: Array) -> Array:
    """Four unit vectors (4, 2), y down, along and across the first segment of a polyline (k, 2), y up."""
    dx, dy = segment[1] - segment[0]
    length = math.hypot(dx, dy)
    along = np.array([dx, -dy]) / length
    across = np.array([-along[1], along[0]])
    return np.array([along, across, -along, -across])


def force_in_words(force: float) -> str:
    """Three digits or so, in newtons."""
    if force == 0.0:
        return "0 N"
    return f"{force:.0f} N" if force >= 99.5 else f"{force:.1f} N" if force >= 0.95 else f"{force:.3f} N"


def journal_offset(eccentricity: Array, clearance: float, bearing_radius: float) -> Array:
    """Offset (2,) of the drawn journal from the centre of the drawn bearing, in the unit of `bearing_radius`.

    The drawn gap stands for the clearance [m], so the circles touch exactly when |eccentricity| [m] equals
    it. The journal of an ideal joint (clearance 0) is drawn centred.
    """
    if clearance == 0.0:
        return np.zeros(2)
    return np.asarray(eccentricity) / clearance * (1.0 - JOURNAL_SHARE) * bearing_radius
