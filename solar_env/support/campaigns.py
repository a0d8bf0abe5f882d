"""Many independent simulations, run on several processes and resumed after an interruption.

`each_done` hands simulations to joblib. A `Campaign` saves each result of a set of simulations to a file.
"""

import hashlib
import json
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any, TypeVar

from joblib import Parallel, delayed
from rich.console import Console

from solar_env.support.files import make_folder, write_text
from solar_env.support.interruption import keeping, starting_workers
from solar_env.support.plain_arrays import parse_json
from solar_env.support.progress import counting_bar

Task = TypeVar("Task")
Result = TypeVar("Result")
Cell = Mapping[str, Any]


def each_done(
    function: Callable[[Task], Result], tasks: Iterable[Task], workers: int = 1
) -> Iterator[tuple[Task, Result]]:
    """Call `function` for every task, and yield each task with its result when the call is done.

    With one worker all calls happen in this process and in order.

    Args:
        function: function defined at the top of a module; the function and its results can be pickled.
        tasks: arguments of the function.
        workers: number of processes; -1 for one per processor.

    Raises:
        Exception: whatever `function` raises.
    """
    calls = (delayed(_with_task)(function, task) for task in tasks)
    with starting_workers():
        results = Parallel(n_jobs=workers, return_as="generator_unordered")(calls)
    with warnings.catch_warnings():
        # Joblib replaces a worker whose memory has grown, which loading kernels causes, and warns in another thread.
        # If a filter made that warning an error, the thread would end, and results would never come.
        warnings.filterwarnings("ignore", "A worker stopped while some jobs were given", UserWarning)
        yield from results


def _with_task(function: Callable[[Task], Result], task: Task) -> tuple[Task, Result]:
    return task, function(task)


class Campaign:
    """A set of simulations, such as a map or an ensemble, whose results are kept in a file of JSON lines.

    A "cell" holds the arguments of one simulation. The first line of the file records the function, its settings and a
    hash of the package's code; a file with another first line is refused, so that results are never mixed.

    Args:
        function: function from a cell to a result that JSON can store, defined at the top of a module.
        cells: arguments of the simulations, as mappings that JSON can store, no two alike.
        store: file of the results.
        settings: everything else on which the results depend.
        admits: function that returns whether a value in the file can be a result.

    Raises:
        ValueError: if the file belongs to another campaign or is damaged.
    """

    def __init__(
        self,
        function: Callable[[Cell], object],
        cells: Sequence[Cell],
        store: Path,
        settings: Mapping[str, object] | None = None,
        admits: Callable[[Any], bool] = lambda _: True,
    ) -> None:
        self._function, self._store = function, store
        self.cells = {_key(cell): cell for cell in cells}
        name = f"{function.__module__}.{function.__qualname__}"
        made_by = json.dumps({"function": name, "code": _code_digest(), "settings": settings or {}}, sort_keys=True)
        self._results: dict[str, Any] = {}
        kept = store.read_text(encoding="utf-8", errors="replace").splitlines(keepends=True) if store.exists() else []
        # An interruption may have cut off the last line; the simulation of that line is then run again.
        whole = [line for line in kept if line.endswith("\n")] or [made_by + "\n"]
        if whole[0] != made_by + "\n":
            raise ValueError(f"{store} was made by other code or with other settings; delete it or choose another")
        for line in whole[1:]:
            try:
                row = parse_json(line)
                key, result = _key(row["cell"]), row["result"]
                if key in self.cells and not admits(result):
                    raise ValueError(f"{json.dumps(result)[:80]} is the result of no cell")
            except (KeyError, TypeError, ValueError) as error:
                told = f"{store} is damaged: a line of it holds no cell with its result ({error})"
                raise ValueError(f"{told}; delete it, and the work is done again") from error
            self._results[key] = result
        if whole != kept:
            make_folder(store.parent)
            write_text(store, "".join(whole))

    @property
    def missing(self) -> tuple[Cell, ...]:
        """Cells (arguments of one simulation each) that have no result yet, in their given order."""
        return tuple(cell for key, cell in self.cells.items() if key not in self._results)

    def run(self, workers: int = 1) -> Iterator[Cell]:
        """Run the simulations that have no result yet; yield the arguments of each once its result is in the file."""
        with self._store.open("a", encoding="utf-8") as file, keeping(self._kept):
            for cell, result in each_done(self._function, self.missing, workers):
                try:
                    file.write(json.dumps({"cell": dict(cell), "result": result}) + "\n")
                    file.flush()
                except OSError as error:
                    error.filename = str(self._store)
                    raise
                self._results[_key(cell)] = json.loads(json.dumps(result))
                yield cell

    def run_shown(self, workers: int, console: Console, cells: str) -> list[Any]:
        """Compute missing results under a progress bar labelled `cells`; return results of all simulations, in order.

        Where the console is no terminal, a line is printed at the start, and after every 10 % of the missing results.
        """
        total, missing = len(self.cells), len(self.missing)
        lines = Console(quiet=True) if console.is_interactive else console
        if missing:
            lines.print(f"{total - missing} of {total} {cells}", highlight=False, soft_wrap=True)
        with counting_bar(console) as bar:
            task = bar.add_task(cells, total=total, completed=total - missing)
            for done, _ in enumerate(self.run(workers), 1):
                bar.advance(task)
                if 10 * done // missing > 10 * (done - 1) // missing:
                    lines.print(f"{total - missing + done} of {total} {cells}", highlight=False, soft_wrap=True)
        return self.results()

    def _kept(self) -> str:
        done, total = len(self.cells) - len(self.missing), len(self.cells)
        return f"kept {done} of {total} results in {self._store}; the same command goes on from there"

    def results(self) -> list[Any]:
        """Return the results of all cells (simulations), in the given order of cells; every result must exist."""
        return [self._results[key] for key in self.cells]

    def result(self, cell: Cell) -> Any:
        """Return the stored result of a cell, the arguments of one simulation; the result must exist."""
        return self._results[_key(cell)]


@cache
def _code_digest() -> str:
    """Return a hash of the package's sources and of the versions of its numerical libraries."""
    digest = hashlib.sha256()
    for path in sorted(Path(__file__).parent.parent.rglob("*.py")):
        digest.update(path.read_bytes())
    for package in ("cma", "numba", "numpy", "scipy"):
        digest.update(version(package).encode())
    return digest.hexdigest()[:16]


def _key(cell: Cell) -> str:
    return json.dumps(dict(cell), sort_keys=True)
