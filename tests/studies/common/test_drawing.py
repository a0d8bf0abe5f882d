"""Figures of the studies: axes labelled in whole figures."""

import pytest

from solar_env.studies.common.drawing import make_figure, short, use_decades


@pytest.mark.parametrize(
    ("limits", "labels"),
    [((0.03, 0.9), ["0.05", "0.1", "0.5"]), ((2e-5, 5e-5), ["2e-5", "5e-5"]), ((5e-3, 3e2), ["0.01", "1", "100"])],
)
def test_a_logarithmic_axis_is_labelled_in_whole_figures_and_never_once_alone(limits, labels):
    figure, axes = make_figure(1, 1, (3.0, 2.0), 1)
    axis = axes[0, 0]
    axis.set_xscale("log")
    axis.set_xlim(*limits)
    use_decades(axis, "x")
    figure.draw_without_rendering()
    shown = {tick.label1.get_text() for tick in axis.xaxis.get_major_ticks()}
    assert set(labels) <= shown
    assert not any("$" in label for label in shown), "exponents set small cannot be read"


@pytest.mark.parametrize(
    ("value", "text"), [(0.0, "0"), (1.0, "1"), (0.9132, "0.913"), (2.2e-5, "2e-5"), (-31400.0, "-3e4"), (999.0, "999")]
)
def test_numbers_in_figures_are_short(value, text):
    assert short(value) == text
