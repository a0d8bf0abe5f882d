"""Interleaved timing: all runs once, then all again, so that disturbances of the machine meet all alike."""

import statistics
from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass
from typing import Generic, TypeVar

from solar_env.mechanics.running.errors import SimulationError
from solar_env.studies.common.motion import Motion

Key = TypeVar("Key", bound=Hashable)


@dataclass(frozen=True)
class Measured(Generic[Key]):
    """Result of the repeats of one run.

    Attributes:
        motion: of the first repeat; None if the run could not go on.
        walls: times of all repeats [s].
        failure: why it could not go on; empty if it could.
    """

    motion: Motion | None
    walls: tuple[float, ...]
    failure: str = ""

    @property
    def wall(self) -> float:
        """Median of the repeats [s]."""
        return statistics.median(self.walls)


def time_interleaved(
    jobs: Mapping[Key, Callable[[], Motion]],
    repeats: int,
    long_run: float,
    announce: Callable[[Key], None] = lambda key: None,
) -> dict[Key, Measured[Key]]:
    """Run every job once, announced by its key, then all again, up to the number of repeats.

    A run that raises SimulationError, or takes longer than `long_run` [s], is not repeated.
    """
    first: dict[Key, Motion] = {}
    walls: dict[Key, list[float]] = {}
    failures: dict[Key, str] = {}
    for key, job in jobs.items():
        announce(key)
        try:
            first[key] = job()
            walls[key] = [first[key].wall_time]
        except SimulationError as error:
            failures[key] = str(error)
    for _ in range(repeats - 1):
        for key, times in walls.items():
            if times[0] <= long_run:
                times.append(jobs[key]().wall_time)
    return {key: Measured(first.get(key), tuple(walls.get(key, ())), failures.get(key, "")) for key in jobs}
