"""The map of what excludes what, the ranges that agree, and two trade-offs, drawn from the tables alone."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from solar_env.array import ArrayParameters
from solar_env.pictures.style import BLUE, FAINT, GREY, STYLE, VERMILLION
from solar_env.studies.common.drawing import short
from solar_env.studies.common.tables import Table, number
from solar_env.studies.paper.claims import CLAIMS
from solar_env.studies.paper.identification.exclusions import NEARLY
from solar_env.studies.paper.identification.open_parameters import OPEN_PARAMETERS, quantities
from solar_env.support.files import save_figure


@dataclass(frozen=True)
class TradeOff:
    """Two claims that pull apart: their keys, labels, limits of the axes, and the paper's place."""

    x: str
    y: str
    labels: tuple[str, str]
    limits: tuple[tuple[float, float], tuple[float, float]]
    paper: tuple[float, float]


TRADE_OFFS = (
    TradeOff(
        "latch-1", "lead", ("joint 1 latches at [s]", "joint 1 before joint 2 [s]"),
        ((12.0, 14.2), (-0.01, 0.017)), (13.175, 0.008),
    ),
    TradeOff(
        "peak", "distribution-force", ("greatest force, equal clearances [N]", "... of models 1 and 2 [N]"),
        ((0.0, 1700.0), (0.0, 1500.0)), (800.0, 300.0),
    ),
)  # fmt: skip


def draw_identification(pairs: Table, front: Table, path: Path) -> None:
    """Draw the map to a PNG file; the same tables give the same file."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(13.0, 9.0), layout="constrained")
        FigureCanvasAgg(figure)
        axes = figure.subplot_mosaic(
            [["map", "ranges"], ["map", "0"], ["map", "1"]], width_ratios=(2.0, 1.0), height_ratios=(2.0, 1.0, 1.0)
        )
        claims = [str(key) for key in pairs.values("claim")]
        apart = _draw_map(axes["map"], pairs, claims)
        _draw_ranges(axes["ranges"], front)
        for number, trade_off in enumerate(TRADE_OFFS):
            _draw_trade_off(axes[str(number)], front, trade_off)
        most = int(front.column("claims_met").max())
        figure.suptitle(
            f"No searched set of what the paper leaves open meets all {len(claims)} claims on rigid panels: the best "
            f"meets {most}, and {apart} pairs are met by no set together"
        )
        save_figure(figure, path, dpi=110)


def _draw_map(axis: Axes, pairs: Table, claims: Sequence[str]) -> int:
    """Draw by how many sets pairs of claims are met; returns how many pairs are met alone but not together."""
    sets = np.zeros((len(claims), len(claims)))
    place = {key: index for index, key in enumerate(claims)}
    for row in pairs.rows:
        a, b = place[str(row["claim"])], place[str(row["other"])]
        sets[a, b] = sets[b, a] = number(row, "sets")
    image = axis.imshow(np.where(sets > 0, sets, np.nan), cmap="Blues", norm=LogNorm(1.0, sets.max()))
    alone = sets.diagonal()
    apart = [(a, b) for a, b in np.argwhere(sets == 0) if a != b and alone[a] and alone[b]]
    axis.plot([b for _, b in apart], [a for a, _ in apart], "x", color=VERMILLION, markersize=6, markeredgewidth=1.6)
    axis.set_xticks(range(len(claims)), claims, rotation=90)
    axis.set_yticks(range(len(claims)), claims)
    axis.grid(False)
    axis.set_title("sets that meet both claims; a cross where none does, though each is met alone")
    bar = axis.figure.colorbar(image, ax=axis, shrink=0.6, pad=0.01)
    bar.set_label("searched sets")
    return len(apart) // 2


def _draw_ranges(axis: Axes, front: Table) -> None:
    """Where in the searched ranges the sets lie that meet most claims."""
    preset = quantities(ArrayParameters.preset("paper"))
    met = front.column("claims_met")
    best = int(met.argmax())
    near = met >= met.max() - NEARLY
    for row, own in enumerate(reversed(OPEN_PARAMETERS)):
        values = front.column(own.name)
        shares = [own.share(float(value)) for value in values]
        inside = np.array(shares)[near]
        axis.plot([0.0, 1.0], [row, row], color=FAINT, linewidth=1.0)
        axis.plot([inside.min(), inside.max()], [row, row], color=BLUE, linewidth=5.0, alpha=0.5, solid_capstyle="butt")
        axis.plot(shares[best], row, "o", color=BLUE)
        axis.plot(own.share(preset[own.name]), row, "D", color=GREY, markersize=4)
        for end, value in ((0.0, own.low), (1.0, own.high)):
            axis.text(end, row + 0.22, short(value), ha="left" if end == 0.0 else "right", fontsize=6)
    names = [f"{own.name} [{own.unit}]" if own.unit else own.name for own in reversed(OPEN_PARAMETERS)]
    axis.set_yticks(range(len(names)), names)
    axis.set_xticks([])
    least = int(met.max()) - NEARLY
    axis.set_title(
        f"bars: the {near.sum()} sets of the front that meet at least {least};\npoint: the best; diamond: preset"
    )


def _draw_trade_off(axis: Axes, front: Table, own: TradeOff) -> None:
    """Two figures of the front's sets, the limits in which they agree, and the paper's place."""
    rows = [row for row in front.rows if "" not in (row[own.x], row[own.y])]
    axis.plot([row[own.x] for row in rows], [row[own.y] for row in rows], ".", color=BLUE, markersize=3)
    axis.plot(*own.paper, "*", color=VERMILLION, markersize=11)
    for key, span in ((own.x, axis.axvspan), (own.y, axis.axhspan)):
        claim = next(claim for claim in CLAIMS if claim.key == key)
        span(claim.low, claim.high, color=VERMILLION, alpha=0.12, linewidth=0.0)
    axis.set(xlabel=own.labels[0], ylabel=own.labels[1], xlim=own.limits[0], ylim=own.limits[1])
    axis.set_title("sets of the front; star and bands: the paper's")
