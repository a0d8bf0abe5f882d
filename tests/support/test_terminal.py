"""Tables are drawn in a terminal and stay Markdown elsewhere."""

import rich.console

from solar_env.support import terminal

TABLE = "| a | b |\n|---|---|\n| 1 | 2 |\n"


def test_in_a_pipe_a_table_is_markdown(capsys):
    terminal.print_markdown(TABLE)
    assert capsys.readouterr().out == TABLE + "\n"


def test_in_a_terminal_it_is_drawn(capsys, monkeypatch):
    monkeypatch.setattr(terminal, "Console", lambda: rich.console.Console(force_terminal=True))
    terminal.print_markdown(TABLE)
    drawn = capsys.readouterr().out
    assert "|" not in drawn
    assert "─" in drawn
