"""Drawing that the studies share: panels, axes, legends, saving. Figures are drawn from tables alone."""

import textwrap
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter
from numpy.typing import NDArray

from solar_env.pictures.style import STYLE, Look
from solar_env.support.files import save_figure

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


def short(value: float) -> str:
    """A number in five characters or so."""
    if value == 0.0 or 0.01 <= abs(value) < 1000.0:
        return f"{value:.3g}"
    mantissa, exponent = f"{value:.0e}".split("e")
    return f"{mantissa}e{int(exponent)}"
