"""Deployments repeated with the worn clearance fed back."""

import itertools
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from solar_env.__main__ import main
from solar_env.array import ArrayParameters
from solar_env.studies.common.plans import FAST_PARAMETERS
from solar_env.studies.common.tables import read_table
from solar_env.studies.wear import repeated
from solar_env.studies.wear.repeated import wear_campaign

FAST_DURATION = 4.0


def fast(wear_coefficient: float, **changes: Any) -> ArrayParameters:
    return FAST_PARAMETERS.with_changes({"wear_coefficient": wear_coefficient, **changes})


@pytest.fixture
def short(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(repeated, "DURATION", FAST_DURATION)


@pytest.mark.usefixtures("short")
def test_extrapolated_wear_is_that_of_ten_direct_deployments() -> None:
    extrapolated, direct = (list(wear_campaign(fast(1e-7), 10, growth, members=4)) for growth in (0.06, 0.0))
    assert len(extrapolated) <= 4
    assert [deployment.number for deployment in direct] == list(range(10))
    for before, after in itertools.pairwise(direct):
        assert after.clearance == pytest.approx(before.clearance + before.wear, rel=1e-15, abs=0.0)
    ends = [last.clearance + last.repeated * last.wear for last in (extrapolated[-1], direct[-1])]
    grown = ends[1] - direct[0].clearance
    assert np.all(grown > 0.03 * direct[0].clearance)
    errors = [sum(d.repeated * d.wear_error for d in campaign) for campaign in (extrapolated, direct)]
    assert np.all(np.abs(ends[0] - ends[1]) < np.hypot(*errors) + 0.01 * grown)


def test_wear_between_deployments_is_linear(monkeypatch: pytest.MonkeyPatch) -> None:
    wear = iter([1e-5, 1e-5, 3e-5, 3e-5, 3e-5, 3e-5])
    monkeypatch.setattr(repeated, "_deploy", lambda run: [[next(wear)] * 2, [1.0, 1.0]])
    first, second, third = itertools.islice(wear_campaign(ArrayParameters(clearance=1e-4), 9, 0.41, members=2), 3)
    assert [(one.number, one.repeated) for one in (first, second, third)] == [(0, 4), (4, 1), (5, 2)]
    assert second.clearance == pytest.approx(np.full(2, 1.4e-4)), "as the first predicts"
    # What the first four wore is corrected to 1, 1.5, 2 and 2.5 times 1e-5.
    assert third.clearance == pytest.approx(np.full(2, 1e-4 + 7e-5 + 3e-5))


@pytest.mark.usefixtures("short")
def test_wear_that_changes_nothing_is_simulated_once() -> None:
    (only,) = wear_campaign(fast(1e-14), 1000, 0.01, members=2)
    assert only.repeated == 1000
    assert np.all(only.wear > 0.0)
    (only,) = wear_campaign(fast(0.0), 7, 0.0, members=2)
    assert (only.repeated, only.wear.tolist()) == (7, [0.0, 0.0])


@pytest.mark.usefixtures("short")
def test_repeateds_are_written_and_drawn(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name, value in (("WEAR_COEFFICIENT", 1e-7), ("MEMBERS", 2)):
        monkeypatch.setattr(repeated, name, value)
    monkeypatch.setattr("solar_env.commands.studies.wear.QUICK", 3)
    assert main(["study", "wear", "--quick", "--jobs", "1", "--out", str(tmp_path)]) == 0
    assert {path.name for path in tmp_path.iterdir()} == {"repeated.csv", "repeated.png"}
    assert read_table(tmp_path / "repeated.csv").column("repeated").sum() == 3
