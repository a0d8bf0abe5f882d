"""Figures of agents show what they were given, in the units of their axes."""

import math
from dataclasses import astuple

import numpy as np
import pytest

from agents.comparison.figures import Panel, comparison_figure, learning_curves_figure
from agents.comparison.statistics import Estimate


def drawn(axes, label):
    """The line of a label: abscissae and ordinates."""
    (line,) = (line for line in axes.lines if line.get_label() == label)
    return np.asarray(line.get_xdata(), float).tolist(), np.asarray(line.get_ydata(), float).tolist()


def test_a_comparison_shows_means_intervals_and_the_worst_of_every_controller_in_the_units_of_the_axes(
    tmp_path, saved_figures
):
    figures = {
        "return": Estimate(-2.0, -3.0, -1.5, -9.0, -1.0, 5),
        "peak_postlock_force_N": Estimate(20.0, 15.0, 30.0, 10.0, 90.0, 5),
        "sliding_work_J": Estimate(2e-3, 1e-3, 3e-3, 1e-4, 9e-3, 5),
        "wear_depth_max_m": Estimate(5e-15, 4e-15, 6e-15, 3e-15, 7e-15, 5),
    }
    better = {name: Estimate(*(0.1 * number for number in astuple(of)[:-1]), 5) for name, of in figures.items()}
    comparison_figure({"passive": figures, "servo": better}, tmp_path / "figure.png")
    panels = saved_figures[0].axes
    rows = {text.get_text(): row for row, text in enumerate(panels[0].get_yticklabels())}
    shown = [(-2.0, [-3.0, -1.5], -9.0), (20.0, [15.0, 30.0], 90.0), (2.0, [1.0, 3.0], 9.0), (5.0, [4.0, 6.0], 7.0)]
    for axes, (mean, ends, worst) in zip(panels, shown, strict=True):
        for name, factor in (("passive", 1.0), ("servo", 0.1)):
            found = [line.get_xdata() for line in axes.lines if set(line.get_ydata()) == {rows[name]}]
            for values, exact in zip(found, (ends, [mean], [worst]), strict=True):
                np.testing.assert_allclose(values, np.multiply(exact, factor))
    assert saved_figures[0].get_suptitle().startswith('"servo" has the best return, -0.2\n')


def test_a_comparison_of_fewer_than_four_episodes_shows_no_interval(tmp_path, saved_figures):
    others = ("peak_postlock_force_N", "sliding_work_J", "wear_depth_max_m")
    for count, bars in ((3, 0), (4, 1)):
        figures = dict.fromkeys(others, Estimate(0.0, 0.0, 0.0, 0.0, 0.0, count))
        figures["return"] = Estimate(-2.0, -3.0, -1.5, -9.0, -1.0, count)
        comparison_figure({"servo": figures}, tmp_path / "figure.png")
        (axes,) = saved_figures[-1].axes
        assert sum(line.get_linestyle() == "-" and len(line.get_xdata()) == 2 for line in axes.lines) == bars
        assert ("95 % interval" in saved_figures[-1].get_suptitle()) == bool(bars)


def test_a_comparison_has_no_panel_for_what_is_zero_whoever_controls(tmp_path, saved_figures):
    figures = {
        "return": Estimate(-2.0, -3.0, -1.5, -9.0, -1.0, 5),
        "peak_postlock_force_N": Estimate(20.0, 15.0, 30.0, 10.0, 90.0, 5),
        "sliding_work_J": Estimate(0.0, 0.0, 0.0, 0.0, 0.0, 5),
        "wear_depth_max_m": Estimate(math.nan, math.nan, math.nan, math.nan, math.nan, 0),
    }
    comparison_figure({"passive": figures}, tmp_path / "figure.png")
    assert [axes.get_xlabel() for axes in saved_figures[0].axes] == ["return", "peak post-lock force [N]"]


def test_a_learning_curve_is_the_median_of_the_seeds_and_their_range_as_far_as_all_runs_go(tmp_path, saved_figures):
    steps, seconds = np.array([1.0, 10.0]), np.array([2.0, 20.0])
    longer = np.array([1.0, 5.0, 12.0]), np.array([2.0, 10.0, 24.0]), np.array([-4.0, -1.0, -0.1])
    curves = {
        "ppo": [(steps, seconds, np.array(returns)) for returns in ([-1.0, -0.5], [-2.0, -0.7], [-6.0, -0.1])],
        "cma-es": [(steps, seconds, np.array([-4.0, -2.0])), longer],
    }
    learning_curves_figure({"rigid": Panel(curves, {"servo": -0.1})}, tmp_path / "figure.png")
    axes, over_seconds = saved_figures[0].axes
    assert axes.get_title() == "rigid: 2 to 3 seeds"
    assert saved_figures[0].get_suptitle() == "Best at the end: ppo with -0.5 (rigid)"
    assert drawn(over_seconds, "ppo") == ([2.0, 20.0], [-2.0, -0.5])
    assert drawn(axes, "ppo") == ([1.0, 10.0], [-2.0, -0.5])
    first, second = -4.0 + 2.0 * 4.0 / 9.0, -1.0 + 0.9 * 5.0 / 7.0
    assert drawn(axes, "cma-es") == (
        [1.0, 5.0, 10.0],
        pytest.approx([-4.0, (first - 1.0) / 2.0, (-2.0 + second) / 2.0]),
    )
    assert drawn(axes, "servo")[1] == [-0.1, -0.1]
    band = axes.collections[0].get_paths()[0].vertices
    assert (band[band[:, 0] == 1.0, 1].min(), band[band[:, 0] == 1.0, 1].max()) == (-6.0, -1.0)
