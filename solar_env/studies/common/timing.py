"""The runs of a study: all once, then all again, so that disturbances of the machine meet all alike."""

import math
import statistics
from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass, replace
from typing import TypeVar

from threadpoolctl import threadpool_limits

from solar_env.mechanics.running.errors import SimulationError
from solar_env.studies.common.motion import Motion
from solar_env.studies.common.tables import Row

Key = TypeVar("Key", bound=Hashable)


@dataclass(frozen=True)
class Job:
    """A run of a study.

    Attributes:
        name: in words.
        solve: makes the run; raises SimulationError if it cannot go on.
        repeats: how often it is timed.
        long_run: a run that takes longer than this is not repeated [s].
    """

    name: str
    solve: Callable[[], Motion]
    repeats: int = 1
    long_run: float = 10.0


@dataclass(frozen=True)
class Measured:
    """Result of the repeats of one run.

    Attributes:
        motion: of the first repeat; None if the run could not go on.
        walls: times of all repeats [s].
        failure: why it could not go on; empty if it could.
    """

    motion: Motion | None
    walls: tuple[float, ...] = ()
    failure: str = ""

    @property
    def wall(self) -> float:
        """Median of the repeats [s]; nan if the run could not go on."""
        return statistics.median(self.walls) if self.walls else math.nan

    def times(self) -> Row:
        """Number of the repeats, median, least and greatest time, as cells of a table."""
        least, greatest = min(self.walls, default=math.nan), max(self.walls, default=math.nan)
        return {"repeats": len(self.walls), "wall_s": self.wall, "wall_min_s": least, "wall_max_s": greatest}


def measure(jobs: Mapping[Key, Job], announce: Callable[[str], None] = lambda name: None) -> dict[Key, Measured]:
    """Run every job once, announced by its name, then those to be repeated again, up to the number of repeats.

    Linear algebra gets one thread: for matrices this small a second one gains nothing, and waits for a busy processor.
    """
    first: dict[Key, Measured] = {}
    with threadpool_limits(1):
        for key, job in jobs.items():
            announce(job.name)
            first[key] = _first_run(job)
        walls = {key: list(result.walls) for key, result in first.items()}
        for round_ in range(1, max((job.repeats for job in jobs.values()), default=1)):
            for key, job in jobs.items():
                if round_ < job.repeats and walls[key] and walls[key][0] <= job.long_run:
                    walls[key].append(job.solve().wall_time)
    return {key: replace(result, walls=tuple(walls[key])) for key, result in first.items()}


def _first_run(job: Job) -> Measured:
    try:
        motion = job.solve()
    except SimulationError as error:
        return Measured(None, failure=str(error))
    return Measured(motion, (motion.wall_time,))
