"""Many independent simulations: on several processes, and resumed where they were interrupted.

:func:`each_done` hands simulations to joblib; a campaign is a set of them whose results a file keeps as they come.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any, TypeVar

from joblib import Parallel, delayed

Task = TypeVar("Task")
Result = TypeVar("Result")
Cell = Mapping[str, Any]


def each_done(
    function: Callable[[Task], Result], tasks: Iterable[Task], jobs: int = 1
) -> Iterator[tuple[Task, Result]]:
    """Call ``function`` for every task on ``jobs`` processes, and yield each task with its result as it is done.

    With one job everything happens in this process and in order.

    Args:
        function: at the top of a module, like its results something that can be pickled.
        tasks: its arguments.
        jobs: number of processes, 1 or more.

    Raises:
        ValueError: if ``jobs`` is not positive.
        Exception: whatever ``function`` raises.
    """
    if jobs < 1:
        raise ValueError(f"jobs = {jobs!r} must be at least 1")
    calls = (delayed(_with_task)(function, task) for task in tasks)
    yield from Parallel(n_jobs=jobs, return_as="generator_unordered")(calls)


def _with_task(function: Callable[[Task], Result], task: Task) -> tuple[Task, Result]:
    return task, function(task)


class Campaign:
    """Cells of a map or of an ensemble, whose results are kept in a file of JSON lines.

    The first line of the file says what made it: the function, its settings and a hash of the package's code. Results
    that were made by anything else are refused, not mixed.

    Args:
        function: from a cell to a result that JSON keeps; at the top of a module.
        cells: arguments; mappings that JSON keeps, no two alike.
        store: file of the results.
        settings: what else the results hang on.

    Raises:
        ValueError: if the file belongs to another campaign, or two cells are alike.
    """

    def __init__(
        self,
        function: Callable[[Cell], Any],
        cells: Sequence[Cell],
        store: Path,
        settings: Mapping[str, Any] | None = None,
    ) -> None:
        self._function = function
        self.cells = tuple(cells)
        self._store = store
        keys = [_key(cell) for cell in self.cells]
        if len(set(keys)) < len(keys):
            raise ValueError("two cells of the campaign are alike")
        name = f"{function.__module__}.{function.__qualname__}"
        self._made_by = {"function": name, "code": _code_digest(), "settings": dict(settings or {})}
        self._results: dict[str, Any] = {}
        kept = store.read_text(encoding="utf-8").splitlines(keepends=True) if store.exists() else []
        # An interruption may have cut the last line short: then its cell is done again.
        whole = [line for line in kept if line.endswith("\n")]
        if whole:
            self._load(whole, set(keys))
            if len(whole) < len(kept):
                store.write_text("".join(whole), encoding="utf-8")
        else:
            store.parent.mkdir(parents=True, exist_ok=True)
            store.write_text(json.dumps(self._made_by, sort_keys=True) + "\n", encoding="utf-8")

    def _load(self, lines: Sequence[str], keys: set[str]) -> None:
        if json.loads(lines[0]) != json.loads(json.dumps(self._made_by)):
            raise ValueError(
                f"{self._store} was made by other code or with other settings; delete it or choose another"
            )
        for line in lines[1:]:
            row = json.loads(line)
            key = _key(row["cell"])
            if key in keys:
                self._results[key] = row["result"]

    @property
    def missing(self) -> tuple[Cell, ...]:
        """The cells that are not done, in their order."""
        return tuple(cell for cell in self.cells if _key(cell) not in self._results)

    def run(self, jobs: int = 1) -> Iterator[Cell]:
        """Do what is missing, and yield each cell when its result is in the file."""
        with self._store.open("a", encoding="utf-8") as file:
            for cell, result in each_done(self._function, self.missing, jobs):
                file.write(json.dumps({"cell": dict(cell), "result": result}) + "\n")
                file.flush()
                self._results[_key(cell)] = json.loads(json.dumps(result))
                yield cell

    def results(self) -> list[Any]:
        """The results of all cells, in their order.

        Raises:
            ValueError: if some are missing.
        """
        if self.missing:
            raise ValueError(f"{len(self.missing)} of {len(self.cells)} cells are not done; run the campaign first")
        return [self._results[_key(cell)] for cell in self.cells]


@cache
def _code_digest() -> str:
    """Hash of the package's sources and of the versions of what computes for it."""
    digest = hashlib.sha256()
    for path in sorted(Path(__file__).parent.rglob("*.py")):
        digest.update(path.read_bytes())
    for package in ("numba", "numpy", "scipy"):
        digest.update(version(package).encode())
    return digest.hexdigest()[:16]


def _key(cell: Cell) -> str:
    return json.dumps(dict(cell), sort_keys=True)
