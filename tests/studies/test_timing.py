from dataclasses import replace

import pytest
from helpers import make_motion

from solar_env.mechanics.running.errors import SimulationError
from solar_env.studies.common.timing import time_interleaved


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
    jobs = {"short": job("short", 1.0), "long": job("long", 50.0), "bad": job("bad", None), "other": job("other", 2.0)}
    measured = time_interleaved(jobs, repeats=3, long_run=20.0, announce=announced.append)
    assert announced == list(jobs)
    assert calls == ["short", "long", "bad", "other", "short", "other", "short", "other"]
    assert measured["short"].walls == (2.0, 6.0, 8.0)
    assert measured["short"].wall == pytest.approx(6.0)
    assert len(measured["long"].walls) == 1
    assert measured["bad"].motion is None
    assert measured["bad"].failure == "Newton"
