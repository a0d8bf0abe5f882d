"""How far a command is: in a terminal a bar, else a line now and then, as in the log of a job."""

from collections.abc import Iterator
from contextlib import contextmanager
from datetime import timedelta
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TaskID, TextColumn, TimeElapsedColumn

_INTERVAL = 30.0  # s, between the lines


class TellingProgress(Progress):
    """A bar that vanishes at the end; where its console is no terminal, lines instead of it.

    There is a line at the beginning of a task, and then one where at least half a minute has passed since the last.
    """

    def __init__(self, *columns: Any, console: Console) -> None:
        super().__init__(*columns, console=console, transient=True, disable=not console.is_interactive)
        self._told: dict[TaskID, float] = {}

    def stop(self) -> None:
        """End the display; where there is none, without the empty line that Rich would leave."""
        if not self.disable:
            super().stop()

    def add_task(self, *arguments: Any, **options: Any) -> TaskID:
        """Begin a task, see `Progress.add_task`."""
        task = super().add_task(*arguments, **options)
        self._tell(task)
        return task

    def update(self, task_id: TaskID, **options: Any) -> None:
        """Change a task, see `Progress.update`."""
        super().update(task_id, **options)
        self._tell(task_id)

    def advance(self, task_id: TaskID, advance: float = 1) -> None:
        """Go on with a task, see `Progress.advance`."""
        super().advance(task_id, advance)
        self._tell(task_id)

    def _tell(self, task_id: TaskID) -> None:
        task, now = self._tasks[task_id], self.get_time()
        if not self.disable or not task.description or now - self._told.get(task_id, -_INTERVAL) < _INTERVAL:
            return
        self._told[task_id] = now
        share = "" if task.total is None else f" of {_count(task.total)}"
        taken = timedelta(seconds=int(task.elapsed or 0.0))
        _say(self.console, f"{task.description}: {_count(task.completed)}{share}, {taken}")


def counting_bar(console: Console) -> Progress:
    """A bar with the number of things done, the time taken and what is in hand; it vanishes at the end."""
    columns = (BarColumn(), MofNCompleteColumn(), TimeElapsedColumn(), TextColumn("{task.description}"))
    return TellingProgress(*columns, console=console)


def share_bar(console: Console) -> Progress:
    """A bar with the share that is done and the time left; it vanishes at the end."""
    return TellingProgress(*Progress.get_default_columns(), console=console)


@contextmanager
def stage(console: Console, text: str) -> Iterator[None]:
    """Say what takes a while and cannot be counted: in a terminal as long as it lasts, else in a line."""
    if not console.is_interactive:
        _say(console, text)
    with console.status(text):
        yield


def _count(number: float) -> str:
    return f"{number:,.0f}" if float(number).is_integer() else f"{number:,.1f}"


def _say(console: Console, text: str) -> None:
    console.print(text, highlight=False, markup=False, soft_wrap=True)
