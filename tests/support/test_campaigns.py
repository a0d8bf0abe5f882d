"""Parallel tasks and campaigns that go on where they were interrupted."""

from __future__ import annotations

import json
import shutil
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from solar_env.commands.arguments import WorkerOptions
from solar_env.mechanics.running.errors import SimulationError
from solar_env.support import campaigns
from solar_env.support.campaigns import Campaign, each_done

CELLS = [{"x": x} for x in range(4)]
CALLS: list[int] = []
HELD: list[np.ndarray] = []


def square(cell: Any) -> dict[str, int]:
    CALLS.append(cell["x"])
    return {"square": cell["x"] ** 2}


def cube(cell: Any) -> int:
    return int(cell["x"] ** 3)


@pytest.fixture(autouse=True)
def fresh() -> None:
    CALLS.clear()


@pytest.mark.parametrize("jobs", [1, 2])
def test_every_task_comes_with_its_own_result(jobs: int) -> None:
    assert sorted((cell["x"], result) for cell, result in each_done(cube, CELLS, jobs)) == [
        (0, 0), (1, 1), (2, 8), (3, 27),
    ]  # fmt: skip


def fail(_: Any) -> None:
    raise SimulationError("at t = 1 s the step shrank", 1.0, "step_size")


@pytest.mark.parametrize("jobs", [1, 2])
def test_the_error_of_a_run_crosses_processes_whole(jobs: int) -> None:
    with pytest.raises(SimulationError, match="at t = 1 s the step shrank") as caught:
        list(each_done(fail, [1, 2], jobs))
    assert (caught.value.time, caught.value.reason) == (1.0, "step_size")


def grow(task: int) -> int:
    """Take 400 MB for good, so that joblib replaces the worker."""
    time.sleep(0.4)
    HELD.append(np.ones(50_000_000 if task >= 2 else 1))
    return task


@pytest.mark.slow
@pytest.mark.filterwarnings("error")
def test_results_come_though_a_worker_is_replaced_and_warnings_are_errors() -> None:
    results = each_done(grow, range(8), 2)
    assert sorted(result for _, result in results) == list(range(8))


def test_no_process_is_refused() -> None:
    with pytest.raises(ValueError, match="jobs = 0"):
        WorkerOptions(jobs=0).workers  # noqa: B018


def test_an_interrupted_campaign_does_only_what_is_missing(tmp_path: Path) -> None:
    store = tmp_path / "deep" / "cells.jsonl"
    run = Campaign(square, CELLS, store).run()
    next(run), next(run)
    run.close()
    again = Campaign(square, CELLS, store)
    assert [cell["x"] for cell in again.missing] == [2, 3]
    CALLS.clear()
    assert [cell["x"] for cell in again.run()] == CALLS == [2, 3]
    assert again.results() == [{"square": x**2} for x in range(4)]
    assert Campaign(square, CELLS[::-1], store).results() == [{"square": x**2} for x in (3, 2, 1, 0)]


def test_a_line_cut_short_is_done_again(tmp_path: Path) -> None:
    store = tmp_path / "cells.jsonl"
    list(Campaign(square, CELLS, store).run())
    store.write_text(store.read_text()[:-5])
    again = Campaign(square, CELLS, store)
    assert [cell["x"] for cell in again.run()] == [3]
    assert Campaign(square, CELLS, store).results() == [{"square": x**2} for x in range(4)]
    assert all(json.loads(line) for line in store.read_text().splitlines())


@pytest.mark.parametrize("line", ["5", "{}", '{"cell": 5, "result": 1}', "[1"])
def test_a_line_that_holds_no_cell_with_its_result_is_told(tmp_path: Path, line: str) -> None:
    store = tmp_path / "cells.jsonl"
    list(Campaign(square, CELLS[:2], store).run())
    store.write_text(store.read_text() + line + "\n")
    with pytest.raises(ValueError, match=r"cells\.jsonl is damaged: a line of it holds no cell with its result"):
        Campaign(square, CELLS, store)


def test_a_result_that_cannot_be_one_is_told(tmp_path: Path) -> None:
    store = tmp_path / "cells.jsonl"
    list(Campaign(square, CELLS[:2], store).run())
    store.write_text(store.read_text() + '{"cell": {"x": 2}, "result": 5}\n')
    with pytest.raises(ValueError, match=r"cells.jsonl is damaged: .*\(5 is the result of no cell\); delete it"):
        Campaign(square, CELLS, store, admits=lambda found: isinstance(found, dict) and "square" in found)


def test_results_of_other_code_or_settings_are_not_mixed(tmp_path: Path) -> None:
    store = tmp_path / "cells.jsonl"
    list(Campaign(square, CELLS, store, {"members": 8}).run())
    for function, settings in ((cube, {"members": 8}), (square, {"members": 4}), (square, None)):
        with pytest.raises(ValueError, match="other code or with other settings"):
            Campaign(function, CELLS, store, settings)


def test_results_of_an_earlier_version_of_the_package_are_not_mixed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    store = tmp_path / "cells.jsonl"
    list(Campaign(square, CELLS[:2], store).run())
    kept = store.read_text()
    monkeypatch.setattr(campaigns, "_code_digest", lambda: "0123456789abcdef")
    with pytest.raises(ValueError, match=f"{store} was made by other code or with other settings"):
        Campaign(square, CELLS, store)
    assert store.read_text() == kept
    monkeypatch.undo()
    assert len(Campaign(square, CELLS, store).missing) == 2


def test_editing_any_source_makes_other_code_of_the_package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    source = Path(campaigns.__file__).parents[1]
    shutil.copytree(source, tmp_path / "solar_env", ignore=shutil.ignore_patterns("__pycache__", "figures"))
    digest, path = campaigns._code_digest.__wrapped__, tmp_path / "solar_env" / "mechanics/joints/wear.py"
    here = digest()
    monkeypatch.setattr(campaigns, "__file__", str(tmp_path / "solar_env" / "support" / "campaigns.py"))
    assert digest() == here
    path.write_text(path.read_text() + "\n# edited\n")
    edited = digest()
    monkeypatch.setattr(campaigns, "version", lambda _: "0")
    assert len({here, edited, digest()}) == 3
