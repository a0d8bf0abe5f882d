"""Plotting functions that the studies share: axes, legends and saving. Plots are drawn from tables alone."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import LogLocator, NullFormatter
from numpy.typing import NDArray

from solar_env.pictures.style import STYLE, Look
from solar_env.support.files import save_figure

_ENTRY = 1.9  # width of an entry of the legend [inch]


def make_figure(rows: int, columns: int, size: tuple[float, float], entries: int) -> tuple[Figure, NDArray[Any]]:
    """Return a Matplotlib figure and its (rows, columns) axes, with room for a title above and a legend below.

    Args:
        rows, columns: numbers of rows and columns of axes.
        size: size of one axes with its labels [inch].
        entries: number of the legend's entries.
    """
    width = size[0] * columns
    with mpl.rc_context(STYLE):
        height = size[1] * rows + 0.8 + 0.16 * -(-entries // int(width / _ENTRY))
        figure = Figure(figsize=(width, height), layout="constrained")
        return figure, figure.subplots(rows, columns, squeeze=False)


def use_decades(axis: Axes, which: str) -> None:
    """Label a logarithmic axis (`which`: "x" or "y") at powers of ten; if fewer than two are in view, also at 2 and 5.

    Labels have no superscripts, which would be illegible where a page shows the figure at half its size.
    """
    scale, limits = (axis.xaxis, axis.get_xlim()) if which == "x" else (axis.yaxis, axis.get_ylim())
    low, high = np.log10(limits)
    if np.floor(high) - np.ceil(low) < 1.0:
        scale.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    scale.set_major_formatter(lambda value, _: short(value))
    scale.set_minor_formatter(NullFormatter())


def save(figure: Figure, path: Path, looks: Mapping[str, Look], title: str, note: str = "") -> None:
    """Save a figure of `make_figure` to `path`, with `title` (its conclusion) above, `note` and a legend below.

    `looks` maps each legend entry to its line style. Equal figures give equal files, byte by byte.
    """
    with mpl.rc_context(STYLE):
        handles = [Line2D([], [], linewidth=1.0, markersize=4, label=name, **look) for name, look in looks.items()]
        columns = int(figure.get_figwidth() / _ENTRY)
        figure.legend(handles=handles, loc="outside lower center", ncols=columns, title=note, title_fontsize=7)
        figure.suptitle(title, wrap=True)
        save_figure(figure, path, dpi=160)


def short(value: float) -> str:
    """Format a number for a label, in about five characters."""
    if value == 0.0 or 0.01 <= abs(value) < 1000.0:
        return f"{value:.3g}"
    mantissa, exponent = f"{value:.0e}".split("e")
    return f"{mantissa}e{int(exponent)}"
