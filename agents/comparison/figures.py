"""Figures of training runs, of single episodes, and of comparisons."""

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from agents.comparison.report import FEWEST, HIGHER_IS_BETTER, TABLE
from agents.learning import runs
from agents.rollout import Step
from solar_env.pictures.style import CONTROLLER_LOOKS, STYLE, controller_looks, look_of
from solar_env.support.files import save_figure

OPENING, RATES = "opening [lock angle]", "joint rates [rad/s]"
TORQUE, FORCE, CHARGED = "motor torque [N m]", "peak force in a period [N]", "charged so far"

Curve = tuple[np.ndarray, np.ndarray]
"""Of a training run: simulated time [s] and mean validation return (validations,)."""


def plot_learning_curve(axes: Axes, folder: Path, reference_returns: Mapping[str, float]) -> None:
    """Plot minus the returns of training and validation episodes over environment steps, with references as lines."""
    config = runs.read_config(folder)
    color = look_of(config["algo"], CONTROLLER_LOOKS)["color"]
    history = runs.read_evaluations(folder)
    steps, validation = history["timesteps"], history["results"].mean(axis=1)
    ends, returns = training_episodes(folder)
    axes.plot(ends, -returns, ".", color=color, ms=2, alpha=0.4, label="training episode")
    axes.plot(steps, -validation, "o-", color=color, ms=3, label="validation, mean")
    for name, look in controller_looks(list(reference_returns)).items():
        axes.axhline(-reference_returns[name], ls="--", color=look["color"], label=name)
    axes.set(xlabel="environment steps", ylabel="minus the return", yscale="log")
    axes.legend()


def training_episodes(folder: Path) -> tuple[np.ndarray, np.ndarray]:
    """Read the environment steps (n,) at which training episodes of a run ended, and their returns (n,).

    A run that was interrupted has a further log for every time that it went on, which begins at its checkpoint.
    """
    logs = {int(path.name.split(".")[0].replace("monitor", "0")): path for path in folder.glob("*monitor.csv")}
    ends, returns = np.zeros(0), np.zeros(0)
    for start, path in sorted(logs.items()):
        rows = np.array([line.split(",")[:2] for line in path.read_text().splitlines()[2:]], dtype=float).reshape(-1, 2)
        before = ends <= start
        ends = np.concatenate([ends[before], start + np.cumsum(rows[:, 1])])
        returns = np.concatenate([returns[before], rows[:, 0]])
    return ends, returns


def plot_episodes(panels: Mapping[str, Axes], episodes: Mapping[str, Sequence[Step]]) -> None:
    """Plot one episode of each controller over time.

    Args:
        panels: Quantity with its unit, one of those in `series`, -> axes that show it.
        episodes: Controller -> steps of one episode.
    """
    looks = controller_looks(list(episodes))
    for controller, steps in episodes.items():
        time = [step.time_s for step in steps]
        openings, rates = (
            {f", joint {k}": of_joint for k, of_joint in enumerate(np.transpose(values), start=1)}
            for values in ([step.openings for step in steps], [step.rates for step in steps])
        )
        series: dict[str, tuple[str, dict[str, Any]]] = {
            OPENING: ("default", openings),
            RATES: ("default", rates),
            TORQUE: ("steps-pre", {"": [step.motor_torque for step in steps]}),
            FORCE: ("steps-pre", {"": [step.peak_forces.max() for step in steps]}),
            CHARGED: ("steps-post", {"": -np.cumsum([sum(step.reward_terms.values()) for step in steps])}),
        }
        for quantity, axes in panels.items():
            drawstyle, lines = series[quantity]
            for line, (suffix, values) in zip(("-", "--", ":"), lines.items(), strict=False):
                color = looks[controller]["color"]
                axes.plot(time, values, line, drawstyle=drawstyle, color=color, label=controller + suffix)
    for quantity, axes in panels.items():
        axes.set(xlabel="time [s]", ylabel=quantity)
        axes.legend()


@rc_context(STYLE)
def run_figure(
    folder: Path,
    reference_returns: Mapping[str, float],
    episodes: Mapping[str, Sequence[Step]],
) -> None:
    """Draw `figure.png` of the finished run in `folder`.

    `reference_returns` by controller are lines in the learning curve; the rest is as for `plot_episodes`.
    """
    figure = Figure(figsize=(11, 7), layout="constrained")
    axes = figure.subplots(2, 2)
    plot_learning_curve(axes[0, 0], folder, reference_returns)
    plot_episodes({OPENING: axes[0, 1], TORQUE: axes[1, 0], CHARGED: axes[1, 1]}, episodes)
    reached = runs.read_evaluations(folder)["results"].mean(axis=1).max()
    others = ", ".join(f"{name} {value:.3g}" for name, value in reference_returns.items())
    figure.suptitle(f"{runs.read_config(folder)['algo']} reaches a return of {reached:.3g} in validation; {others}")
    save_figure(figure, folder / "figure.png", dpi=150)


@rc_context(STYLE)
def comparison_figure(summary: Mapping[str, Mapping[str, Any]], path: Path) -> None:
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


@rc_context(STYLE)
def learning_curves_figure(
    curves: Mapping[tuple[str, str], Sequence[Curve]], laws: Mapping[tuple[str, str], float], path: Path
) -> None:
    """Draw validation returns over simulated time, panel by panel: medians over training seeds, and their range.

    `curves` maps (panel, algorithm) to the curves of the seeds, which are drawn as far as all of them go; `laws` maps
    (panel, law) to the return of a law, which is a level.
    """
    panels = list(dict.fromkeys(panel for panel, _ in curves))
    common = {key: _over_common_times(of_agent) for key, of_agent in curves.items()}
    across = min(len(panels), 2)
    down = math.ceil(len(panels) / across)
    figure = Figure(figsize=(5.5 * across, 3.6 * down), layout="constrained")
    for axes, panel in zip(figure.subplots(down, across, squeeze=False).flat, panels, strict=False):
        for algo in (algo for title, algo in curves if title == panel):
            times, returns = common[panel, algo]
            color, hours = look_of(algo, CONTROLLER_LOOKS)["color"], times / 3600.0
            axes.plot(hours, -np.median(returns, axis=0), color=color, label=f"{algo}, {len(returns)} seeds")
            axes.fill_between(hours, -returns.max(axis=0), -returns.min(axis=0), color=color, alpha=0.15, lw=0)
        for name, mean in ((name, mean) for (title, name), mean in laws.items() if title == panel):
            axes.axhline(-mean, color=look_of(name, CONTROLLER_LOOKS)["color"], linestyle=":", label=f"{name}, tuned")
        axes.set(yscale="log", xlabel="simulated time [h]", ylabel="minus the validation return", title=panel)
        axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 1.5, 2.0, 3.0, 5.0, 7.0)))  # some in less than a decade
        axes.yaxis.set_major_formatter("{x:g}")
        axes.yaxis.set_minor_formatter(NullFormatter())
        axes.legend()
    last = {key: np.median(returns[:, -1]) for key, (_, returns) in common.items()}
    best = Counter(max((key for key in last if key[0] == panel), key=last.__getitem__)[1] for panel in panels)
    where = ", ".join(f"{algo} in {n} of {len(panels)} tasks" if len(panels) > 1 else algo for algo, n in best.items())
    figure.suptitle(f"Best at the end: {where}")
    save_figure(figure, path, dpi=130)


def _over_common_times(of_agent: Sequence[Curve]) -> tuple[np.ndarray, np.ndarray]:
    """Times of all runs up to the first end of one (n,), and the returns at these, linear in between (runs, n)."""
    times = np.unique(np.concatenate([times for times, _ in of_agent]))
    times = times[times <= min(run_times[-1] for run_times, _ in of_agent)]
    return times, np.array([np.interp(times, *run) for run in of_agent])


@rc_context(STYLE)
def deployments_figure(episodes: Mapping[str, Sequence[Step]], path: Path) -> None:
    """Draw one episode of each controller: torque, rates, forces and charged costs over time; see `plot_episodes`."""
    figure = Figure(figsize=(10, 9), layout="constrained")
    panels = dict(zip((TORQUE, RATES, FORCE, CHARGED), figure.subplots(4, 1, sharex=True), strict=True))
    plot_episodes(panels, episodes)
    panels[FORCE].set_yscale("symlog", linthresh=1.0)
    panels[CHARGED].set_yscale("symlog", linthresh=1e-3)
    for axes in panels.values():
        axes.label_outer()
    charged = {name: -sum(sum(step.reward_terms.values()) for step in steps) for name, steps in episodes.items()}
    order = sorted(charged, key=charged.__getitem__)
    others = ", ".join(f"{name} {charged[name]:.3g}" for name in order[1:])
    figure.suptitle(f"{order[0]} is charged least, {charged[order[0]]:.3g}; {others}")
    save_figure(figure, path, dpi=130)
