"""Contents of an HTML page as plain data, independent of the simulator: motions, charts and tables."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Motion:
    """Motion of a deployment for an animated page, with nt times and nj joints.

    Attributes:
        time: (nt,) times, ascending [s].
        body: (nt, 4, 2) corners of the main body, in order round the body [m].
        panels: a polyline (nt, k, 2) for each panel, from its inner hinge to its tip [m].
        eccentricity: (nt, nj, 2) journal centre minus bearing centre, divided by clearance; zero for ideal joints.
        clearance: (nj,) radial clearances [m].
        force: (nt, nj) contact force [N].
        latch_times: (nj,) latch times [s], nan if not latched.
        torque: (nt, motors) torques of the motors [N m].
    """

    name: str
    time: Array
    body: Array
    panels: Sequence[Array]
    eccentricity: Array
    clearance: Array
    force: Array
    latch_times: Array
    torque: Array


@dataclass(frozen=True, eq=False)
class Line:
    """A line through points of a chart.

    Attributes:
        name: name in the legend.
        x, y: (n,) coordinates; in a polar chart, x is the angle [deg] and y the radius.
        colour: "#rrggbb".
        dash: "solid", "dash" or "dot".
    """

    name: str
    x: Array
    y: Array
    colour: str
    dash: str = "solid"


@dataclass(frozen=True, eq=False)
class Chart:
    """Lines in one pair of axes.

    Attributes:
        title: quantity that the chart shows.
        x, y: names of the axes with units.
        over_time: whether x is the time [s]; the page's time slider then moves a vertical line along it.
        logarithmic: axes with a logarithmic scale: "", "y" or "xy".
        polar: whether y is the radius, and x the angle [deg]; the axis name `y` is then the unit alone.
        limits: limits of y; by default the lines set them.
        bars: labels of the rows, from the top, if the lines are horizontal bars; otherwise empty. Row k is at y = k.
            A line has three points for each of its bars: the bar's two ends, and one with x = nan as a gap before the
            next bar. The bars of a second line may lie at a slightly greater y, below the bars of the first.
    """

    title: str
    x: str
    y: str
    lines: Sequence[Line]
    over_time: bool = True
    logarithmic: str = ""
    polar: bool = False
    limits: tuple[float, float] | None = None
    bars: Sequence[str] = ()


@dataclass(frozen=True)
class Table:
    """Rows of text under a title; a folded table opens when its title is clicked."""

    title: str
    columns: Sequence[str]
    rows: Sequence[Sequence[str]]
    folded: bool = False


@dataclass(frozen=True, eq=False)
class Page:
    """A page with motions, charts and tables.

    Attributes:
        answer: sentences at the top, which state the result.
        motions: motions side by side, moved by one slider.
        charts, tables: charts and tables below the motions.
        notes: last lines, such as the command and the versions that made the page.
    """

    title: str
    answer: Sequence[str]
    motions: Sequence[Motion]
    charts: Sequence[Chart]
    tables: Sequence[Table] = ()
    notes: Sequence[str] = field(default=())
