"""A parameter far from its default is fine, or the library says what is wrong with it: never neither."""

import pytest

from solar_env.array import ArrayParameters
from solar_env.studies.common.tables import Table
from solar_env.studies.stability import parameter_ranges as ranges


# The torque ratio is left out: it follows from the wheels, and any other destroys work.
@pytest.mark.parametrize("name", ["body_mass", "hinge_y", "initial_spin", "initial_rate"])
def test_a_default_is_fine_and_so_is_what_decades_are_counted_from(name):
    assert ranges.trial(name, 1.0, "rigid-clearance", 0.1)["class"] == ranges.FINE


def test_an_open_energy_book_without_a_word_is_a_silent_failure(monkeypatch):
    monkeypatch.setattr(ranges, "LARGEST_ENERGY_SHARE", -1.0)
    assert ranges.trial("body_mass", 1.0, "rigid-clearance", 0.1)["class"] == ranges.SILENT


def test_every_parameter_is_tried_or_named_as_not_tried():
    listed = [*ranges.NAMES, *ranges.NO_QUANTITIES]
    assert sorted(listed) == sorted(vars(ArrayParameters()))


@pytest.mark.parametrize(
    ("name", "factor", "kind", "word"),
    [
        ("clearance", 1e4, ranges.REFUSED, "clearance = 2.0 must be below journal_radius"),
        ("restitution", 10.0, ranges.REFUSED, "restitution = 9.0 must lie in (0, 1]"),
        ("body_inertia", 1e-4, ranges.FINE, ""),
        ("spring_preload_angle", 10.0, ranges.REFUSED, "spring_preload_angle"),
        ("initial_spin", 10.0, ranges.FINE, ""),
    ],
)
def test_a_trial_says_how_it_ended_and_what_the_library_said(name, factor, kind, word):
    row = ranges.trial(name, factor, "rigid-clearance", 0.1)
    assert (row["class"], row["value"]) == (kind, pytest.approx(ranges.scaled(name, factor)[0]))
    assert word in row["message"]


def test_the_page_has_a_line_a_parameter_with_what_is_fine_and_each_message_once():
    def row(factor, kind, message=""):
        cells = {"parameter": "clearance", "model": "rigid-clearance", "factor": factor, "value": 2e-4 * factor}
        return {**cells, "class": kind, "message": message}

    said = "clearance = {} must be below journal_radius"
    rows = [row(0.1, ranges.FINE), row(1.0, ranges.FINE)]
    rows += [row(factor, ranges.REFUSED, said.format(2e-4 * factor)) for factor in (100.0, 1000.0)]
    page = ranges.page(Table(tuple(rows), {}))
    assert "4 runs," in page
    assert "0 failures without a word" in page
    (line,) = [line for line in page.splitlines() if line.startswith("| `clearance` |")]
    assert "| 2e-05 to 0.0002 | - |" in line
    assert line.count("journal_radius") == 1
    assert "100, 1000: refused" in line
