"""Timing of a study's runs in rounds: every run once a round, so that disturbances of the machine affect all alike."""

import math
import statistics
from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass
from typing import TypeVar

from threadpoolctl import threadpool_limits

from solar_env.mechanics.running.errors import SimulationError
from solar_env.studies.common.motion import Motion
from solar_env.studies.common.tables import Row

Key = TypeVar("Key", bound=Hashable)


@dataclass(frozen=True)
class Job:
    """A run of a study, to be simulated and timed."""

    name: str
    solve: Callable[[], Motion]  # raises SimulationError if it cannot go on
    repeats: int = 1  # number of timings
    long_run: float = 10.0  # time beyond which a run is not repeated [s]


@dataclass(frozen=True)
class Measured:
    """Result of a run and its repeats: the first run's motion and all wall times [s], or the reason for a failure."""

    motion: Motion | None = None
    walls: tuple[float, ...] = ()
    failure: str = ""

    @property
    def wall(self) -> float:
        """Median wall time of the repeats [s]; nan if the run failed."""
        return statistics.median(self.walls) if self.walls else math.nan

    def times(self) -> Row:
        """Return table cells: the number of timings, and their median, least and greatest wall time [s]."""
        least, greatest = min(self.walls, default=math.nan), max(self.walls, default=math.nan)
        return {"repeats": len(self.walls), "wall_s": self.wall, "wall_min_s": least, "wall_max_s": greatest}


def measure(jobs: Mapping[Key, Job], announce: Callable[[str], None] = lambda name: None) -> dict[Key, Measured]:
    """Run every job once, then in further rounds until it has `repeats` runs; return a `Measured` for each job's key.

    It holds the first run's motion and all wall times, or the reason for a failure. A job whose first run exceeds
    `long_run` is not repeated. `announce` gets each job's name before its first run. Linear algebra has one thread.
    """
    results = {key: Measured() for key in jobs}
    with threadpool_limits(1):
        for count in range(max(job.repeats for job in jobs.values())):
            for key, job in jobs.items():
                done = results[key]
                if count == 0:
                    announce(job.name)
                elif count >= job.repeats or not done.walls or done.walls[0] > job.long_run:
                    continue
                try:
                    motion = job.solve()
                    results[key] = Measured(done.motion or motion, (*done.walls, motion.wall_time))
                except SimulationError as error:
                    results[key] = Measured(failure=str(error))
    return results
