"""Figures of the studies: titles in lines of one length, axes labelled in whole figures."""

import pytest

from solar_env.studies.common.drawing import balanced, make_figure, use_decades


def test_a_title_breaks_into_lines_of_about_one_length_and_at_spaces_alone():
    assert balanced("short", 20) == ["short"]
    assert balanced("one two three four five", 19) == ["one two three", "four five"]
    kept = "modal-radau\N{NO-BREAK SPACE}(flexible-ideal)"
    assert balanced(f"cheapest of all: {kept}", 40) == ["cheapest of all:", kept]
    assert balanced("x" * 30, 20) == ["x" * 30]


@pytest.mark.parametrize(("limits", "labels"), [((0.03, 0.9), ["0.1", "0.3"]), ((5e-3, 3e2), ["0.01", "1", "100"])])
def test_a_logarithmic_axis_is_labelled_in_whole_figures_and_never_once_alone(limits, labels):
    figure, axes = make_figure(1, 1, (3.0, 2.0), 1)
    axis = axes[0, 0]
    axis.set_xscale("log")
    axis.set_xlim(*limits)
    use_decades(axis, "x")
    figure.canvas.draw()
    ticks = (*axis.xaxis.get_major_ticks(), *axis.xaxis.get_minor_ticks())
    shown = {tick.label1.get_text() for tick in ticks}
    assert set(labels) <= shown
    assert not any("$" in label for label in shown), "exponents set small cannot be read"
