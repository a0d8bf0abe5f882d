"""Figures of training runs, of single episodes, and of comparisons."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib import rc_context
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from agents.comparison.report import FEWEST, HIGHER_IS_BETTER, TABLE, Summary
from agents.learning import runs
from agents.rollout import Step
from solar_env.pictures.style import CONTROLLER_LOOKS, STYLE, controller_looks, look_of
from solar_env.support.files import save_figure

Curve = tuple[np.ndarray, np.ndarray, np.ndarray]
"""Of a training run: environment steps and mean validation return (validations,)."""


@rc_context(STYLE)
def learning_curve_figure(folder: Path, reference_returns: Mapping[str, float]) -> None:
    """Draw `figure.png` of the run in `folder`: the mean validation return over environment steps.

    `reference_returns` by controller are lines.
    """
    algo = runs.read_config(folder).algo
    history, color = runs.read_evaluations(folder), look_of(algo, CONTROLLER_LOOKS)["color"]
    validation = history["results"].mean(axis=1)
    figure = Figure(figsize=(6.5, 4.5), layout="constrained")
    axes = figure.subplots()
    axes.plot(history["timesteps"], validation, "o-", color=color, ms=3, label=algo)
    for name, look in controller_looks(list(reference_returns)).items():
        axes.axhline(reference_returns[name], ls="--", color=look["color"], label=name)
    axes.set(xlabel="environment steps", ylabel="return in validation")
    axes.legend()
    others = ", ".join(f"{name} {value:.3g}" for name, value in reference_returns.items())
    figure.suptitle(f"{algo} reaches a return of {validation.max():.3g} in validation; {others}")
    save_figure(figure, folder / "figure.png", dpi=150)


@rc_context(STYLE)
def comparison_figure(summary: Summary, path: Path) -> None:
    """Draw a comparison: interquartile mean, interval and worst episode of every controller.

    Fewer than `FEWEST` episodes have no interval. A figure that is zero for all controllers, as wear where joints are
    ideal, has no panel. `summary` is that of `agents.comparison.report.summarize`.
    """
    panels = [("return", "minus return", -1.0)]
    for key in ("peak_postlock_force_N", "sliding_work_J", "wear_depth_max_m"):
        if any(of[key].mean > 0 for of in summary.values()):
            panels.append((key, *TABLE[key]))
    names, looks = list(summary)[::-1], controller_looks(list(summary))
    figure = Figure(figsize=(0.5 + 3.25 * len(panels), 1.0 + 0.32 * len(names)), layout="constrained")
    across = figure.subplots(1, len(panels), sharey=True, squeeze=False)[0]
    for axes, (key, label, factor) in zip(across, panels, strict=True):
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
    figure.suptitle(f"{best} has the best return, {summary[best]['return'].mean:.3g}\n{marks}")
    save_figure(figure, path, dpi=130)


class Panel(NamedTuple):
    """Learning curves of a scene: by algorithm, of each seed the steps, seconds and returns, and returns by law."""

    curves: dict[str, list[Curve]]
    laws: dict[str, float]


@rc_context(STYLE)
def learning_curves_figure(panels: Mapping[str, Panel], path: Path) -> None:
    """Draw validation returns by scene, over steps and over seconds: medians over training seeds, and their range.

    Curves are drawn as far as those of all seeds go.
    """
    figure = Figure(figsize=(max(4.2 * len(panels), 6.5), 6.5), layout="constrained")
    axes, best = figure.subplots(2, len(panels), squeeze=False), {}
    for column, (scene, panel) in enumerate(panels.items()):
        last = {}
        for row, label in enumerate(("environment steps", "seconds of a core")):
            for algo, of_agent in panel.curves.items():
                at, returns = _over_common([(run[row], run[-1]) for run in of_agent])
                color, middle = look_of(algo, CONTROLLER_LOOKS)["color"], np.median(returns, axis=0)
                axes[row, column].plot(at, middle, color=color, label=f"{algo}, {len(returns)} seeds")
                axes[row, column].fill_between(at, *np.quantile(returns, (0, 1), axis=0), color=color, alpha=0.15, lw=0)
                last[algo] = middle[-1]
            for name, mean in panel.laws.items():
                axes[row, column].axhline(mean, color=look_of(name, CONTROLLER_LOOKS)["color"], ls=":", label=name)
            axes[row, column].set(ylim=(-3.0, 1.2), xscale="log", xlabel=label, ylabel="return in validation")
        axes[0, column].set_title(scene)
        best[scene] = max(last, key=last.__getitem__)
    axes[0, 0].legend()
    figure.suptitle("Best at the end: " + ", ".join(f"{algo} ({scene})" for scene, algo in best.items()))
    save_figure(figure, path, dpi=130)


def _over_common(of_agent: Sequence[tuple[np.ndarray, np.ndarray]]) -> tuple[np.ndarray, np.ndarray]:
    """Abscissas of all runs up to the first end of one (n,), and the values at these, linear between (runs, n)."""
    at = np.unique(np.concatenate([run for run, _ in of_agent]))
    at = at[at <= min(run[-1] for run, _ in of_agent)]
    return at, np.array([np.interp(at, *run) for run in of_agent])


@rc_context(STYLE)
def deployments_figure(episodes: Mapping[str, Sequence[Step]], path: Path) -> None:
    """Draw one episode of each controller: torque, rates, forces and charged costs over time."""
    figure = Figure(figsize=(10, 9), layout="constrained")
    panels = figure.subplots(4, 1, sharex=True)
    quantities = ("motor torque [N m]", "joint rates [rad/s]", "peak force in a period [N]", "charged so far")
    looks, charged = controller_looks(list(episodes)), {}
    for name, steps in episodes.items():
        costs = -np.cumsum([sum(step.reward_terms.values()) for step in steps])
        charged[name] = costs[-1]
        rates = np.array([step.rates for step in steps])
        series: list[tuple[str, Mapping[str, Sequence[float] | np.ndarray]]] = [
            ("steps-pre", {"": [step.motor_torque for step in steps]}),
            ("default", {f", joint {k}": of_joint for k, of_joint in enumerate(rates.T, start=1)}),
            ("steps-pre", {"": [step.peak_forces.max() for step in steps]}),
            ("steps-post", {"": costs}),
        ]
        time, color = [step.time_s for step in steps], looks[name]["color"]
        for axes, (drawstyle, lines) in zip(panels, series, strict=True):
            for line, (suffix, values) in zip(("-", "--", ":"), lines.items(), strict=False):
                axes.plot(time, values, line, drawstyle=drawstyle, color=color, label=name + suffix)
    for axes, quantity in zip(panels, quantities, strict=True):
        axes.set(xlabel="time [s]", ylabel=quantity)
        axes.legend()
        axes.label_outer()
    panels[2].set_yscale("symlog", linthresh=1.0)
    panels[3].set_yscale("symlog", linthresh=1e-3)
    order = sorted(charged, key=charged.__getitem__)
    others = ", ".join(f"{name} {charged[name]:.3g}" for name in order[1:])
    figure.suptitle(f"{order[0]} is charged least, {charged[order[0]]:.3g}; {others}")
    save_figure(figure, path, dpi=130)
