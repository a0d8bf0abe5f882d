"""The runs of a study: all once, then all again, so that disturbances of the machine meet all alike."""

import statistics
from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass
from typing import TypeVar

from threadpoolctl import threadpool_limits

from solar_env.mechanics.running.errors import SimulationError
from solar_env.studies.common.motion import Motion
from solar_env.support.campaigns import ONE, Workers, each_done

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
        """Median of the repeats [s]."""
        return statistics.median(self.walls)


def measure(
    jobs: Mapping[Key, Job], announce: Callable[[str], None] = lambda name: None, workers: Workers = ONE
) -> dict[Key, Measured]:
    """Run every job once, announced by its name, then those to be repeated again, up to the number of repeats.

    Linear algebra gets one thread: for matrices this small a second one gains nothing, and waits for a busy processor.
    With several workers nothing is repeated, jobs are announced as they are done, and wall times mean little.
    """
    if workers != ONE:
        done: dict[Key, Measured] = {}
        for (key, job), result in each_done(_first_run, jobs.items(), workers):
            announce(job.name)
            done[key] = result
        return {key: done[key] for key in jobs}
    first: dict[Key, Measured] = {}
    with threadpool_limits(1):
        for key, job in jobs.items():
            announce(job.name)
            first[key] = _first_run((key, job))
        walls = {key: list(result.walls) for key, result in first.items()}
        for round_ in range(1, max((job.repeats for job in jobs.values()), default=1)):
            for key, job in jobs.items():
                if round_ < job.repeats and walls[key] and walls[key][0] <= job.long_run:
                    walls[key].append(job.solve().wall_time)
    return {key: Measured(result.motion, tuple(walls[key]), result.failure) for key, result in first.items()}


def _first_run(item: tuple[Hashable, Job]) -> Measured:
    try:
        motion = item[1].solve()
    except SimulationError as error:
        return Measured(None, failure=str(error))
    return Measured(motion, (motion.wall_time,))
