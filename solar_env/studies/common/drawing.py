"""Drawing that the studies share: panels, axes, legends, saving. Figures are drawn from tables alone."""

import itertools
import textwrap
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter
from numpy.typing import NDArray

from solar_env.pictures.style import FAINT, STYLE, Look
from solar_env.support.files import save_figure

Box = tuple[float, float, float, float]


class Label(NamedTuple):
    """A text that belongs to a point."""

    text: str
    x: float
    y: float
    colour: str


_ABOVE = 0.72  # room for titles [inch]
_TITLE_CHARACTERS = 10  # of the figure's title, for each inch of its width


def make_figure(
    rows: int, columns: int, size: tuple[float, float], entries: int, gap: float = 0.5
) -> tuple[Figure, NDArray[Any]]:
    """A figure with (rows, columns) axes, and room for titles above and a legend below.

    Args:
        rows, columns: of axes.
        size: of one axes with its labels [inch].
        entries: of the legend.
        gap: between rows of axes, for their labels [inch].
    """
    with mpl.rc_context(STYLE):
        width = size[0] * columns + 0.3
        below = 0.75 + 0.16 * -(-entries // _legend_columns(width))
        height = (size[1] - 0.5 + gap) * rows + _ABOVE + below - gap
        figure = Figure(figsize=(width, height))
        FigureCanvasAgg(figure)
        axes = figure.subplots(rows, columns, squeeze=False)
        figure.subplots_adjust(
            left=0.7 / width,
            right=1.0 - 0.2 / width,
            bottom=below / height,
            top=1.0 - _ABOVE / height,
            wspace=0.75 / (size[0] - 0.75),
            hspace=gap / (size[1] - 0.5),
        )
    return figure, axes


def _legend_columns(width: float) -> int:
    return max(1, int(width / 1.9))


def positive_points(x: NDArray[np.float64], y: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The points that logarithmic axes can show, in their order."""
    shown = np.isfinite(x) & np.isfinite(y) & (x > 0.0) & (y > 0.0)
    return x[shown], y[shown]


def use_decades(axis: Axes, which: str) -> None:
    """A logarithmic axis, "x" or "y", at least one decade wide, labelled at decades, and within where one is alone."""
    own, limits = (axis.xaxis, axis.get_xlim()) if which == "x" else (axis.yaxis, axis.get_ylim())
    low, high = np.log10(limits)
    if high - low < 1.2:
        low, high = np.floor(low), np.ceil(high)
        (axis.set_xlim if which == "x" else axis.set_ylim)(10.0**low, 10.0**high)
    # Exponents set small could not be read where a page shows the figure at half its size.
    own.set_major_formatter(FuncFormatter(lambda value, _: short(value)))
    own.set_minor_formatter(NullFormatter())
    if np.floor(high) - np.ceil(low) < 1.0:
        own.set_minor_locator(LogLocator(subs=(3.0,)))
        own.set_minor_formatter(FuncFormatter(lambda value, _: short(value)))
        own.set_tick_params(which="minor", length=mpl.rcParams["xtick.major.size"])


def draw_floor(axis: Axes, floor: float) -> None:
    """Shade the errors below which references disagree."""
    if np.isfinite(floor) and floor > 0.0:
        axis.axvspan(0.0, floor, color=FAINT, alpha=0.5, linewidth=0.0, zorder=0)
        axis.axvline(floor, color=FAINT, linewidth=0.8, zorder=0)


def save(figure: Figure, path: Path, looks: Mapping[str, Look], title: str, note: str = "") -> None:
    """Write a figure of `make_figure` with its conclusion as title, and below a legend of names and a note.

    The same tables give the same file.
    """
    with mpl.rc_context(STYLE):
        handles = [Line2D([], [], linewidth=1.0, markersize=4, label=name, **look) for name, look in looks.items()]
        columns = _legend_columns(figure.get_figwidth())
        place = (0.5, 0.18 / figure.get_figheight())
        figure.legend(handles=handles, loc="lower center", ncols=columns, bbox_to_anchor=place)
        lines = balanced(title, int(_TITLE_CHARACTERS * figure.get_figwidth()))
        figure.suptitle("\n".join(lines), y=1.0 - 0.06 / figure.get_figheight(), va="top")
        if note:
            figure.text(0.5, 0.04 / figure.get_figheight(), note, ha="center", va="bottom", fontsize=7)
        save_figure(figure, path, dpi=160)


def balanced(text: str, width: int) -> list[str]:
    """A text in as few lines of some width as it needs, of about the same length, broken at spaces alone."""
    count = len(textwrap.wrap(text, width, break_on_hyphens=False))
    widths = range(max(len(text) // max(count, 1), 1), width + 1)
    wrapped = (textwrap.wrap(text, some, break_on_hyphens=False, break_long_words=False) for some in widths)
    for lines in wrapped:
        if len(lines) <= count and all(len(line) <= width for line in lines):
            return lines
    return [text]


def place_labels(
    axis: Axes, labels: Sequence[Label], marks: Sequence[tuple[float, float]], lines: Sequence[Box] = ()
) -> None:
    """Write labels beside their points, inside the axes, off other labels and marks, and off lines where they can be.

    Args:
        axis: with its final limits and place.
        labels: in the order in which they choose.
        marks: x, y of those drawn already, in the units of the axes.
        lines: x0, y0, x1, y1 of those drawn already.
    """
    figure = axis.get_figure(root=True)
    assert figure is not None
    renderer = figure.canvas.get_renderer()  # type: ignore[attr-defined]
    margin = 3.0 * figure.dpi / 72.0  # half a mark [pixel]
    inside = axis.get_window_extent(renderer)

    def around(x0: float, y0: float, x1: float, y1: float, room: float) -> Box:
        (left, low), (right, high) = axis.transData.transform([(x0, y0), (x1, y1)])
        return min(left, right) - room, min(low, high) - room, max(left, right) + room, max(low, high) + room

    crossed = [around(*line, 0.3 * margin) for line in lines]
    kept_off = [around(x, y, x, y, margin) for x, y in marks]
    for label in labels:
        text = axis.annotate(
            label.text, (label.x, label.y), (0, 0), textcoords="offset points", fontsize=7, color=label.colour
        )
        tried: list[tuple[float, int, Any, Box]] = []
        for distance, (dx, dy) in itertools.product((5.0, 9.0, 14.0, 20.0), _DIRECTIONS):
            text.set_position((distance * dx, distance * dy))
            text.set_horizontalalignment("left" if dx > 0.3 else "right" if dx < -0.3 else "center")
            text.set_verticalalignment("bottom" if dy > 0.3 else "top" if dy < -0.3 else "center")
            box = text.get_window_extent(renderer)
            own: Box = (box.x0, box.y0, box.x1, box.y1)
            outside = (box.x1 - box.x0) * (box.y1 - box.y0) - _shared(own, (inside.x0, inside.y0, inside.x1, inside.y1))
            hidden = outside + sum(_shared(own, other) for other in kept_off)
            if distance > _NEAR:
                x, y = axis.transData.transform((label.x, label.y))
                reach = distance * figure.dpi / 72.0
                hidden += _struck((x, y), (x + dx * reach, y + dy * reach), kept_off)
            covered = _MARKS * hidden + sum(_shared(own, other) for other in crossed) + _FARTHER * distance
            looks = text.get_position(), text.get_horizontalalignment(), text.get_verticalalignment()
            tried.append((covered, len(tried), looks, own))
        _, _, (place, across, upright), own = min(tried, key=lambda one: one[:2])
        text.remove()
        axis.annotate(
            label.text, (label.x, label.y), place, textcoords="offset points", fontsize=7, color=label.colour,
            ha=across, va=upright,
            arrowprops={"arrowstyle": "-", "linewidth": 0.5, "color": label.colour, "shrinkA": 0.0, "shrinkB": 2.0}
            if np.hypot(*place) > _NEAR else None,
        )  # fmt: skip
        kept_off.append(own)


_MARKS = 20.0  # how much worse it is to cover a mark or a label, or to leave the axes, than to cover a line
_NEAR = 8.0  # from a point [point]; a label farther away has a line to it
_FARTHER = 4.0  # area that may be covered lest a label stand a point farther away
_DIRECTIONS = ((-1.0, 0.0), (1.0, 0.0), (-0.7, 0.7), (-0.7, -0.7), (0.7, 0.7), (0.7, -0.7), (0.0, 1.0), (0.0, -1.0))


def _struck(point: tuple[float, float], tip: tuple[float, float], boxes: Sequence[Box]) -> float:
    """How much a label's line covers of boxes other than that of its point: it would seem to tell of them."""
    (x, y), (tip_x, tip_y) = point, tip
    others = [box for box in boxes if not (box[0] < x < box[2] and box[1] < y < box[3])]
    along = [(x + t * (tip_x - x), y + t * (tip_y - y)) for t in (0.2, 0.4, 0.6, 0.8, 1.0)]
    return sum(_shared((a - 3.0, b - 3.0, a + 3.0, b + 3.0), box) for a, b in along for box in others)


def _shared(one: Box, other: Box) -> float:
    """Area that two boxes share."""
    width = min(one[2], other[2]) - max(one[0], other[0])
    height = min(one[3], other[3]) - max(one[1], other[1])
    return max(width, 0.0) * max(height, 0.0)


def short(value: float) -> str:
    """A number in five characters or so."""
    if value == 0.0 or 0.01 <= abs(value) < 1000.0:
        return f"{value:.3g}"
    mantissa, exponent = f"{value:.0e}".split("e")
    return f"{mantissa}e{int(exponent)}"
