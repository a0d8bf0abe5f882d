"""Maps of where methods fail: classes, what is heard of the library, and which failures count as silent."""

import math
import warnings

import pytest

from solar_env.mechanics.running.diagnosis import SimulationWarning
from solar_env.mechanics.running.errors import SimulationError
from solar_env.studies.common.tables import Table
from solar_env.studies.stability.maps import (
    Axis,
    Finding,
    Kind,
    Said,
    StabilityMap,
    classify_ratios,
    listen,
    silent_failures,
)


@pytest.mark.parametrize(
    ("lowest", "highest", "kind"),
    [
        (1.0, 1.0, Kind.FINE),
        (0.995, 1.005, Kind.FINE),
        (0.9, 1.0, Kind.OVER_DAMPED),
        (1.0, 1.1, Kind.GROWING),
        (0.1, 1.1, Kind.GROWING),
        (0.0, 2.1, Kind.BLOW_UP),
        (0.0, math.inf, Kind.BLOW_UP),
        (math.nan, math.nan, Kind.BLOW_UP),
    ],
)
def test_gain_counts_before_loss_and_nonsense_before_both(lowest: float, highest: float, kind: str) -> None:
    assert classify_ratios(lowest, highest, 0.01) == kind


def warn_and_return() -> float:
    warnings.warn("too coarse", SimulationWarning, stacklevel=1)
    warnings.warn("too loose", SimulationWarning, stacklevel=1)
    return 3.0


def fine(result: float) -> Finding:
    return Finding(Kind.FINE, result)


def test_a_run_that_returns_is_heard_with_all_its_warnings() -> None:
    assert listen(warn_and_return, fine) == Finding(Kind.FINE, 3.0, Said.WARNING, "too coarse; too loose")
    assert listen(lambda: 3.0, fine) == Finding(Kind.FINE, 3.0)
    told = Finding(Kind.FINE, 3.0, Said.FIGURE, "in its figures")
    assert listen(lambda: 3.0, lambda result: told) == told


def test_an_error_of_the_simulation_is_a_class_of_its_own() -> None:
    for reason, kind in (("newton", Kind.NO_SOLUTION), ("steps", Kind.NO_END), ("penetration", Kind.BLOW_UP)):

        def fail(reason: str = reason) -> float:
            raise SimulationError("at t = 1 s", 1.0, reason)

        cell = listen(fail, fine)
        assert (cell.kind, cell.said, cell.message) == (kind, Said.ERROR, "at t = 1 s")
        assert math.isnan(cell.value)


def test_input_that_is_refused_is_heard_and_other_errors_are_not_hidden() -> None:
    assert listen(lambda: float("x"), fine).kind == Kind.REFUSED
    with pytest.raises(ZeroDivisionError):
        listen(lambda: 1 / 0, fine)


def test_rows_bear_the_names_of_the_axes_and_the_limit_and_failures_without_a_word_are_found() -> None:
    one = StabilityMap(
        name="example",
        title="Example",
        x=Axis("step_s", "step [s]", (1.0, 2.0), (1.0, 2.0, 3.0)),
        y=Axis("count", "count", (1,), (1, 2)),
        panels=("library", "other"),
        quantity="sum",
        advice="Take less.",
        measure=lambda panel, x, y: Finding(Kind.FINE if x + y < 3.0 else Kind.GROWING, x + y),
        limit=lambda panel, y: 3.0 - y,
        limit_label="theory",
    )
    assert len(list(one.cells(quick=False))) == 12
    rows = [dict(one.row(*cell)) for cell in one.cells(quick=True)]
    assert len(rows) == 4
    place = {"panel": "library", "step_s": 2.0, "count": 1}
    assert rows[1] == {**place, "class": "growing", "value": 3.0, "limit": 2.0, "said": "", "message": ""}
    rows[-1]["said"] = Said.WARNING
    (row,) = silent_failures(Table(tuple(rows), one.description())).rows
    assert (row["panel"], row["step_s"]) == ("library", 2.0)
