"""Figures of the studies: titles in lines of one length, labels that leave points and each other free."""

import itertools

import pytest

from solar_env.studies.common.drawing import Label, balanced, make_figure, place_labels


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
    place_labels(axis, [Label(f"{k}e", x, y, "black") for k, (x, y) in enumerate(points)], [(*p, *p) for p in points])
    boxes = [text.get_window_extent() for text in axis.texts]
    assert len(boxes) == 5
    assert not any(one.overlaps(other) for one, other in itertools.combinations(boxes, 2))
    for point in axis.transData.transform(points):
        assert not any(box.contains(*point) for box in boxes)
    frame = axis.get_window_extent()
    assert all(frame.contains(*corner) for box in boxes for corner in box.get_points())
