"""Plots of training runs and of comparisons."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib import rc_context
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from agents.comparison.report import FEWEST, HIGHER_IS_BETTER, TABLE, Summary
from solar_env.pictures.style import CONTROLLER_LOOKS, STYLE, controller_looks, look_of
from solar_env.support.files import save_figure

Curve = tuple[np.ndarray, ...]
"""Validation curve of a training run: abscissas of several kinds, then mean returns, all (validations,)."""
OVER = ("environment steps", "seconds of a core")  # names of the abscissas


@rc_context(STYLE)
def comparison_figure(summary: Summary, path: Path) -> None:
    """Plot interquartile mean with 95 % interval, and worst episode, of each controller's results; save to `path`.

    Fewer than `FEWEST` episodes have no interval. A quantity that is zero for all controllers, such as wear with ideal
    joints, has no subplot. `summary` comes from `agents.comparison.report.summarize`.
    """
    panels = [("return", *TABLE["return"])]
    for key in ("peak_postlock_force_N", "sliding_work_J", "wear_depth_max_m"):
        if any(of[key].mean > 0 for of in summary.values()):
            panels.append((key, *TABLE[key]))
    names, looks = list(summary)[::-1], controller_looks(list(summary))
    rows, columns = math.ceil(len(panels) / 2), min(len(panels), 2)
    figure = Figure(figsize=(8.8, 0.7 + rows * (0.6 + 0.24 * len(names))), layout="constrained")
    grid = figure.subplots(rows, columns, sharey=True, squeeze=False).ravel()
    for axes in grid[len(panels) :]:
        axes.remove()
    for axes, (key, label, factor) in zip(grid, panels, strict=False):
        for row, name in enumerate(names):
            value = summary[name][key]
            if value.count == 0:
                continue
            ends = sorted((factor * value.lower, factor * value.upper))
            worst = factor * (value.minimum if key in HIGHER_IS_BETTER else value.maximum)
            color, marker = looks[name]["color"], looks[name]["marker"]
            if value.count >= FEWEST:
                axes.plot(ends, [row, row], "-", color=color, lw=4, solid_capstyle="butt", alpha=0.5)
            axes.plot(factor * value.mean, row, marker, color=color, ms=4)
            axes.plot(worst, row, "x", color=color, ms=5)
        if key != "return":
            axes.set_xscale("log")
            least, greatest = np.log10(axes.get_xlim())
            if math.ceil(least) <= greatest:  # the labels between powers of ten would overlap
                axes.xaxis.set_minor_formatter(NullFormatter())
        axes.set_yticks(range(len(names)), names)
        axes.set_xlabel(label)
        axes.grid(visible=False, axis="y")
    best = max(summary, key=lambda name: summary[name]["return"].mean)
    interval = " with 95 % interval" if summary[best]["return"].count >= FEWEST else ""
    marks = f"marks: interquartile mean{interval}; x: worst episode"
    figure.suptitle(f'"{best}" has the best return, {summary[best]["return"].mean:.3g}\n{marks}')
    save_figure(figure, path, dpi=100)


class Panel(NamedTuple):
    """Learning curves in one environment, by algorithm and then by seed, and the mean return of each torque law."""

    curves: dict[str, list[Curve]]
    laws: dict[str, float]


@rc_context(STYLE)
def learning_curves_figure(panels: Mapping[str, Panel], path: Path, over: Sequence[str] = OVER) -> None:
    """Plot validation returns, with a column of axes per environment and a row per abscissa in `over`; save to `path`.

    Curves are medians over training seeds, in a band from least to greatest, up to the end of the shortest run.
    """
    size = max(4.2 * len(panels), 6.5), 1.0 + 2.75 * len(over)
    figure = Figure(figsize=size, layout="constrained")
    axes, best = figure.subplots(len(over), len(panels), squeeze=False), []
    for column, (scene, panel) in enumerate(panels.items()):
        last = dict[str, float]()
        for row, label in enumerate(over):
            for algo, of_agent in panel.curves.items():
                at, returns = _over_common([(run[row], run[-1]) for run in of_agent])
                color, middle = look_of(algo, CONTROLLER_LOOKS)["color"], np.median(returns, axis=0)
                axes[row, column].plot(at, middle, color=color, label=algo)
                axes[row, column].fill_between(at, *np.quantile(returns, (0, 1), axis=0), color=color, alpha=0.15, lw=0)
                last.setdefault(algo, middle[-1])
            for name, mean in panel.laws.items():
                axes[row, column].axhline(mean, color=look_of(name, CONTROLLER_LOOKS)["color"], ls=":", label=name)
            axes[row, column].set(ylim=(-3.0, 1.2), xscale="log", xlabel=label, ylabel="return in validation")
            axes[row, column].xaxis.set_minor_formatter(NullFormatter())  # minor labels would overlap
        few, many = (bound(map(len, panel.curves.values())) for bound in (min, max))
        seeds = f": {few} to {many} seeds" if few < many else f": {many} seeds" if many > 1 else ""
        axes[0, column].set_title(scene + seeds)
        winner = max(last, key=last.__getitem__)
        best.append(f"{winner} with {last[winner]:.2g} ({scene})")
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=5)
    figure.suptitle("Best at the end: " + ", ".join(best))
    save_figure(figure, path, dpi=130)


def _over_common(of_agent: Sequence[tuple[np.ndarray, np.ndarray]]) -> tuple[np.ndarray, np.ndarray]:
    """Return all abscissas (n,) up to the end of the shortest run, and all values (runs, n), interpolated there."""
    at = np.unique(np.concatenate([run for run, _ in of_agent]))
    at = at[at <= min(run[-1] for run, _ in of_agent)]
    return at, np.array([np.interp(at, *run) for run in of_agent])
