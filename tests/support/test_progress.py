"""How far a command is: a bar in a terminal, lines in a log, and nothing where it is to be quiet."""

import io

import pytest
from rich.console import Console

from solar_env.support.progress import counting_bar, share_bar, stage

SHOWN = {"force_terminal": True, "force_interactive": True}


class Clock:
    time = 0.0

    def __call__(self):
        return self.time


def console(clock=None, **options):
    return Console(file=io.StringIO(), width=40, get_time=clock or Clock(), **options)


def lines(console):
    return console.file.getvalue().splitlines()


def test_a_log_gets_a_line_at_the_beginning_and_then_one_every_half_minute_at_most():
    clock = Clock()
    log = console(clock)
    with counting_bar(log) as bar:
        task = bar.add_task("deployments", total=2000, completed=3)
        for _ in range(1000):
            clock.time += 0.125
            bar.advance(task)
        clock.time += 60.0
        bar.update(task, completed=1500, description="deployments, the long ones at two levels of the model")
    assert lines(log) == [
        "deployments: 3 of 2,000, 0:00:00",
        "deployments: 243 of 2,000, 0:00:30",
        "deployments: 483 of 2,000, 0:01:00",
        "deployments: 723 of 2,000, 0:01:30",
        "deployments: 963 of 2,000, 0:02:00",
        "deployments, the long ones at two levels of the model: 1,500 of 2,000, 0:03:05",
    ]


def test_what_has_no_name_or_no_end_yet_is_told_without():
    log = console()
    with share_bar(log) as bar:
        task = bar.add_task("", total=0.5)
        bar.update(task, completed=0.25)
        bar.update(task, description="seconds simulated")
        bar.add_task("frames", total=None)
    assert lines(log) == ["seconds simulated: 0.2 of 0.5, 0:00:00", "frames: 0, 0:00:00"]


def test_things_that_are_gone_through_are_told_too():
    clock = Clock()
    log = console(clock)
    with counting_bar(log) as bar:
        for _ in bar.track("abc", description="pictures"):
            clock.time += 100.0
    first, *_, last = lines(log)
    assert (first, last) == ("pictures: 0 of 3, 0:00:00", "pictures: 3 of 3, 0:05:00")


def test_a_stage_is_told_in_a_line():
    log = console()
    with stage(log, "loading kernels of rigid-clearance, runge-kutta [minutes]"):
        assert lines(log) == ["loading kernels of rigid-clearance, runge-kutta [minutes]"]
    assert len(lines(log)) == 1


@pytest.mark.parametrize("options", [{"quiet": True}, SHOWN], ids=["quiet", "terminal"])
def test_neither_a_terminal_nor_who_wants_quiet_gets_lines(options):
    shown = console(**options)
    with stage(shown, "loading kernels"), counting_bar(shown) as bar:
        bar.advance(bar.add_task("runs", total=3))
    assert "runs: 0 of 3" not in shown.file.getvalue()
    assert bool(shown.file.getvalue()) == shown.is_terminal
