"""Tables are drawn for who reads them, and never cut a number."""

import pytest

from solar_env.support import terminal

NAMES = [f"controller-{k}" for k in range(9)]
NUMBERS = [f"-0.0{k}7163" for k in range(9)]
ROWS = [
    f"| {name} | {number} [{number}, {number}] | " + "12.5 | " * 9 for name, number in zip(NAMES, NUMBERS, strict=True)
]
WIDE = "\n".join(["| who | return " + "| long heading of a column " * 9 + "|", "|---" * 11 + "|", *ROWS])


def drawn(text: str, width: int, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> str:
    monkeypatch.setenv("COLUMNS", str(width))
    terminal.print_markdown(text)
    return capsys.readouterr().out


def test_a_table_is_drawn_also_where_there_is_no_terminal(capsys, monkeypatch):
    out = drawn("| a | b |\n|---|---|\n| 1 | 2 |\n", 80, capsys, monkeypatch)
    assert "|" not in out
    assert [line.split() for line in out.splitlines() if line.strip() and "\u2500" not in line] == [
        ["a", "b"],
        ["1", "2"],
    ]


@pytest.mark.parametrize("width", [60, 80, 110, 300])
def test_no_word_of_a_table_is_cut_however_wide_the_terminal(width, capsys, monkeypatch):
    out = drawn(WIDE, width, capsys, monkeypatch)
    words = out.split()
    assert set(NAMES) <= set(words)
    assert set(NUMBERS) <= set(words)
    assert "\u2026" not in out
    assert max(map(len, out.splitlines())) <= width


def test_a_table_that_is_too_wide_stands_on_its_side(capsys, monkeypatch):
    assert drawn(WIDE, 300, capsys, monkeypatch).split().index(NAMES[1]) > drawn(
        WIDE, 80, capsys, monkeypatch
    ).split().index(NAMES[1])
