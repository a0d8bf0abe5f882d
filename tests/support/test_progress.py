"""How far a command is: a bar in a terminal, a line for a stage in a log, and nothing where it is to be quiet."""

import io

import pytest
from rich.console import Console

from solar_env.support.progress import counting_bar, print_markdown, stage


@pytest.mark.parametrize("options", [{}, {"quiet": True}, {"force_terminal": True, "force_interactive": True}])
def test_a_terminal_gets_a_bar_a_log_the_stage_in_a_line_and_who_wants_quiet_nothing(options):
    console = Console(file=io.StringIO(), width=60, **options)
    with stage(console, "loading kernels of rigid-clearance [minutes]"), counting_bar(console) as bar:
        bar.advance(bar.add_task("runs", total=3))
        bar.refresh()
    said = console.file.getvalue()
    if options:
        assert ("1/3" in said) == console.is_terminal
        assert bool(said) == console.is_terminal
    else:
        assert said == "loading kernels of rigid-clearance [minutes]\n"


def test_a_table_is_drawn_also_where_there_is_no_terminal(capsys):
    print_markdown("| a | b |\n|---|---|\n| 1 | 2 |\n")
    lines = capsys.readouterr().out.splitlines()
    assert [line.split() for line in lines if line.strip() and "\u2500" not in line] == [["a", "b"], ["1", "2"]]
