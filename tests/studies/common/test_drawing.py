"""Figures of the studies: titles in lines of one length, labels that leave points and each other free."""

import itertools

import numpy as np
import pytest

from solar_env.studies.common.drawing import Label, balanced, make_figure, place_labels, use_decades


def test_a_title_breaks_into_lines_of_about_one_length_and_at_spaces_alone():
    assert balanced("short", 20) == ["short"]
    assert balanced("one two three four five", 19) == ["one two three", "four five"]
    kept = "modal-radau\N{NO-BREAK SPACE}(flexible-ideal)"
    assert balanced(f"cheapest of all: {kept}", 40) == ["cheapest of all:", kept]
    assert balanced("x" * 30, 20) == ["x" * 30]


@pytest.mark.parametrize("logarithmic", [False, True])
def test_labels_of_close_points_cover_neither_each_other_nor_a_point(logarithmic):
    _, axes = make_figure(1, 1, (4.0, 3.0), 1)
    axis = axes[0, 0]
    points = [(1.0 + 0.05 * k, 1.0 + 0.02 * k) for k in range(5)]
    if logarithmic:
        axis.set_xscale("log")
    axis.set_xlim(0.5, 2.0)
    axis.set_ylim(0.5, 2.0)
    place_labels(axis, [Label(f"{k}e", x, y, "black") for k, (x, y) in enumerate(points)], points)
    boxes = [text.get_window_extent() for text in axis.texts]
    assert len(boxes) == 5
    assert not any(one.overlaps(other) for one, other in itertools.combinations(boxes, 2))
    for point in axis.transData.transform(points):
        assert not any(box.contains(*point) for box in boxes)
    frame = axis.get_window_extent()
    assert all(frame.contains(*corner) for box in boxes for corner in box.get_points())


def test_a_label_at_the_edge_stays_inside_and_lies_on_a_line_rather_than_on_a_mark():
    _, axes = make_figure(1, 1, (4.0, 3.0), 1)
    axis = axes[0, 0]
    axis.set_xlim(0.0, 1.0)
    axis.set_ylim(0.0, 1.0)
    marks = [(0.01, 0.5), (0.01, 0.55), (0.01, 0.45)]
    place_labels(axis, [Label("32m", 0.01, 0.5, "black")], marks, [(0.0, 0.5, 1.0, 0.5)])
    (text,) = axis.texts
    box = text.get_window_extent()
    assert axis.get_window_extent().contains(box.x0, box.y0)
    assert not any(box.contains(*point) for point in axis.transData.transform(marks))


def test_lines_from_labels_to_their_points_cross_no_other_point_in_a_crowd():
    lines = 0
    for seed in range(10):
        # About 12 pixels apart, as marks are that can be told apart.
        lattice = np.array([(0.04 * i, 0.06 * k) for i in range(3) for k in range(3)])
        points = 0.4 + lattice + 0.01 * np.random.default_rng(seed).random((9, 2))
        _, axes = make_figure(1, 1, (4.0, 3.0), 1)
        axis = axes[0, 0]
        axis.set_xlim(0.0, 1.0)
        axis.set_ylim(0.0, 1.0)
        place_labels(axis, [Label("8m", x, y, "black") for x, y in points], [tuple(point) for point in points])
        pixels = axis.transData.transform(points)
        for own, text in zip(pixels, axis.texts, strict=True):
            if text.arrow_patch is None:
                continue
            lines += 1
            reach = np.array(text.get_position()) * axis.figure.dpi / 72.0
            for other in pixels:
                if (other != own).any():
                    along = np.clip((other - own) @ reach / (reach @ reach), 0.0, 1.0)
                    assert np.hypot(*(own + along * reach - other)) > 2.0
    assert lines > 0


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
