from dataclasses import replace

import pytest
from helpers import make_motion
from threadpoolctl import threadpool_info

from solar_env.mechanics.running.errors import SimulationError
from solar_env.studies.common.timing import Job, measure


def test_runs_are_repeated_in_turn_and_long_or_failed_ones_are_not():
    calls = []

    def job(name, wall):
        def run():
            calls.append(name)
            if wall is None:
                raise SimulationError("Newton", 0.1, "newton")
            return replace(make_motion(), wall_time=wall + len(calls))

        return run

    announced = []
    runs = (("short", 1.0, 3), ("long", 50.0, 3), ("bad", None, 3), ("other", 2.0, 3), ("once", 3.0, 1))
    jobs = {name: Job(name, job(name, wall), repeats, long_run=20.0) for name, wall, repeats in runs}
    measured = measure(jobs, announced.append)
    assert announced == list(jobs)
    assert calls == ["short", "long", "bad", "other", "once", "short", "other", "short", "other"]
    assert measured["short"].walls == (2.0, 7.0, 9.0)
    assert measured["short"].wall == pytest.approx(7.0)
    assert len(measured["once"].walls) == 1
    assert len(measured["long"].walls) == 1
    assert measured["bad"].motion is None
    assert measured["bad"].failure == "Newton"
    assert measured["short"].times() == {"repeats": 3, "wall_s": 7.0, "wall_min_s": 2.0, "wall_max_s": 9.0}


def test_timed_runs_leave_linear_algebra_one_thread():
    threads = []

    def run():
        threads.extend(pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas")
        return make_motion()

    measure({"run": Job("run", run)})
    assert threads
    assert set(threads) == {1}
