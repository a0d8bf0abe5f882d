"""Layout, and drawing with smooth edges: shapes are drawn enlarged and then reduced."""

import math
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike
from PIL import Image, ImageDraw, ImageFont

SUPERSAMPLING = 3
INK, QUIET, GRID, CARD, PAPER = "#1d2733", "#66717f", "#e3e8ee", "#ffffff", "#e9edf2"

Box = tuple[int, int, int, int]
Size = Literal["large", "normal", "small"]
Fonts = dict[Size, ImageFont.FreeTypeFont | ImageFont.ImageFont]
TYPE_SIZES: dict[Size, float] = {"large": 23.0, "normal": 15.0, "small": 12.5}


class Region:
    """A rectangle of the frame that is drawn anew in each frame. Coordinates are the frame's pixels, y down.

    Args:
        box: left, top, right, bottom [pixels].
        colour: of the empty region.
    """

    def __init__(self, box: Box, colour: str = CARD) -> None:
        self.left, self.top, self.right, self.bottom = box
        size = ((self.right - self.left) * SUPERSAMPLING, (self.bottom - self.top) * SUPERSAMPLING)
        self._background = Image.new("RGB", size, colour)
        self.clear()

    def clear(self) -> None:
        """Draw the background over everything."""
        self._image = self._background.copy()
        self._pen = ImageDraw.Draw(self._image)

    def keep_as_background(self) -> None:
        """Make what has been drawn so far part of every frame."""
        self._background = self._image.copy()

    def paste_into(self, frame: Image.Image) -> None:
        """Reduce to the frame's resolution, in place."""
        frame.paste(self._image.reduce(SUPERSAMPLING), (self.left, self.top))

    def _enlarge(self, points: ArrayLike) -> list[tuple[float, float]]:
        enlarged = (np.asarray(points, dtype=float) - (self.left, self.top)) * SUPERSAMPLING
        return [(x, y) for x, y in enlarged.tolist()]

    def line(self, points: ArrayLike, colour: str, width: float) -> None:
        """A polyline through points (k, 2)."""
        thickness = max(1, round(width * SUPERSAMPLING))
        self._pen.line(self._enlarge(points), fill=colour, width=thickness, joint="curve")

    def polygon(self, points: ArrayLike, colour: str) -> None:
        """A filled polygon with corners (k, 2)."""
        self._pen.polygon(self._enlarge(points), fill=colour)

    def rounded_box(self, box: Box, radius: float, colour: str) -> None:
        """A filled rectangle with rounded corners."""
        self._pen.rounded_rectangle(self._enlarge([box[:2], box[2:]]), radius=radius * SUPERSAMPLING, fill=colour)

    def disc(self, centre: ArrayLike, radius: float, colour: str) -> None:
        """A filled circle."""
        self._pen.circle(self._enlarge(np.reshape(centre, (1, 2)))[0], radius * SUPERSAMPLING, fill=colour)

    def arrow(self, tail: ArrayLike, tip: ArrayLike, colour: str, width: float) -> None:
        """An arrow with a filled head; nothing if it has no length."""
        tail, tip = np.asarray(tail, dtype=float), np.asarray(tip, dtype=float)
        length = math.hypot(*(tip - tail))
        if length == 0.0:
            return
        along = (tip - tail) / length
        across = np.array([-along[1], along[0]])
        head = min(3.5 * width, length)
        neck = tip - head * along
        self.line([tail, neck + 0.2 * head * along], colour, width)
        self.polygon([tip, neck + 0.6 * head * across, neck - 0.6 * head * across], colour)


class TextPen:
    """Writes on an image in the three sizes of type that a frame uses."""

    def __init__(self, image: Image.Image, fonts: Fonts) -> None:
        self._draw = ImageDraw.Draw(image)
        self._fonts = fonts

    def write(
        self, at: tuple[float, float], text: str, size: Size = "normal", colour: str = INK, anchor: str = "ls"
    ) -> None:
        """Text with its anchor (Pillow's notation; "ls" is left on the baseline) at a point [pixels]."""
        self._draw.text(at, text, fill=colour, font=self._fonts[size], anchor=anchor)


class Layout:
    """Where things are in a frame of a given size [pixels]; the numbers below are for 960 x 540."""

    ARRAY, FORCES, BEARINGS = (12, 12, 616, 326), (12, 338, 616, 528), (628, 12, 948, 528)

    def __init__(self, size: tuple[int, int]) -> None:
        self.size = size
        self.unit = min(size[0] / 960, size[1] / 540)
        # Pillow's own typeface: ASCII and little more, but the same on every machine.
        self._fonts: Fonts = {
            name: ImageFont.load_default(max(6.0, pixels * self.unit)) for name, pixels in TYPE_SIZES.items()
        }

    def x(self, position: float) -> float:
        """Horizontal place in this frame."""
        return position * self.size[0] / 960

    def y(self, position: float) -> float:
        """Vertical place in this frame, downwards."""
        return position * self.size[1] / 540

    def box(self, left: float, top: float, right: float, bottom: float) -> Box:
        """A rectangle in this frame, on whole pixels."""
        return round(self.x(left)), round(self.y(top)), round(self.x(right)), round(self.y(bottom))

    def cards(self) -> Image.Image:
        """An empty frame."""
        region = Region((0, 0, *self.size), PAPER)
        for card in (self.ARRAY, self.FORCES, self.BEARINGS):
            region.rounded_box(self.box(*card), 8 * self.unit, CARD)
        frame = Image.new("RGB", self.size)
        region.paste_into(frame)
        return frame

    def pen(self, frame: Image.Image) -> TextPen:
        """A pen that writes on the frame."""
        return TextPen(frame, self._fonts)
