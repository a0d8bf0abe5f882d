"""A parameter far from its default is fine, or the library says what is wrong with it: never neither."""

from dataclasses import fields

import pytest

from solar_env.array import ArrayParameters
from solar_env.studies.stability import parameter_ranges as ranges


# The torque ratio is left out: it follows from the wheels, and any other destroys work.
@pytest.mark.parametrize(
    "name", ["body_mass", *sorted({*ranges.COUNTED_FROM, *ranges.BESIDE} - {"cable_torque_ratio"})]
)
def test_a_default_is_fine_and_so_is_what_decades_are_counted_from(name):
    assert ranges.trial(name, 1.0, "rigid-clearance", 0.1)["class"] == ranges.FINE


def test_an_open_energy_book_without_a_word_is_a_silent_failure(monkeypatch):
    monkeypatch.setattr(ranges, "LARGEST_ENERGY_SHARE", -1.0)
    assert ranges.trial("body_mass", 1.0, "rigid-clearance", 0.1)["class"] == ranges.SILENT


def test_every_parameter_is_tried_or_named_as_not_tried():
    counts_and_switches = ["panel_count", "wings", "body_fixed", "folding", "latching", "release_after", "wear_bins"]
    choices = ["cable_bearing_forces", "contact_law", "friction_sliding"]
    tables = ["panel_masses", "spring_torque", "harness_torque"]
    listed = [*ranges.NAMES, *counts_and_switches, *choices, *tables]
    assert sorted(listed) == sorted(field.name for field in fields(ArrayParameters))


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
