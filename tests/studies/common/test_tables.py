import math

import pytest

from solar_env.studies.common.tables import Table, choice, number, provenance, read_table, write_table
from solar_env.studies.stability.maps import Kind

ROWS = [
    {"method": "runge-kutta", "step": 1e-3, "repeats": 3, "error": math.inf},
    {"method": "paper", "step": 0.1, "repeats": 5, "error": 2.5e-7},
]


def test_a_table_comes_back_as_it_was_written(tmp_path):
    made_by = provenance("solar-env study precision", quick=True)
    write_table(tmp_path / "folder" / "table.csv", ROWS, made_by)
    table = read_table(tmp_path / "folder" / "table.csv")
    assert [dict(row) for row in table.rows] == ROWS
    assert table.provenance == made_by
    assert table.values("method") == ("runge-kutta", "paper")
    assert table.where(method="paper").column("error").tolist() == [2.5e-7]


def test_provenance_names_command_settings_and_versions():
    made_by = provenance("solar-env study precision", quick=True, seed=3)
    assert made_by["command"] == "solar-env study precision"
    assert made_by["quick"] == "True"
    assert made_by["seed"] == "3"
    assert {"solar-env", "numpy", "numba", "python", "machine"} <= made_by.keys()


def test_rows_that_do_not_fit_together_are_refused(tmp_path):
    with pytest.raises(ValueError, match="no row"):
        write_table(tmp_path / "table.csv", [], {})
    with pytest.raises(ValueError, match="differ in their columns"):
        write_table(tmp_path / "table.csv", [{"a": 1}, {"b": 2}], {})
    assert not (tmp_path / "table.csv").exists()


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("0.1,5", "fast,5", r"table\.csv, line 4: step is 'fast', where a number belongs; measure it anew"),
        ("0.1,5", ",5", r"table\.csv, line 4: step is '', where a number belongs; measure it anew"),
        ("0.1,5", "0.1", r"table\.csv is damaged, or no table of measured rows"),
        ("3,inf", "0,inf", r"table\.csv, line 3: wall_s is 0, where a positive time belongs; measure it anew"),
        ("3,inf", "-1e-3,inf", r"table\.csv, line 3: wall_s is -0\.001, where a positive time belongs"),
    ],
)
def test_a_bad_cell_is_told_with_its_file_line_and_column(tmp_path, old, new, told):
    write_table(
        tmp_path / "table.csv",
        [{"wall_s" if k == "repeats" else k: v for k, v in row.items()} for row in ROWS],
        {"command": "solar-env study precision"},
    )
    text = (tmp_path / "table.csv").read_text()
    assert old in text
    (tmp_path / "table.csv").write_text(text.replace(old, new))
    with pytest.raises(ValueError, match=told):
        read_table(tmp_path / "table.csv")


def test_a_column_that_is_not_there_or_holds_no_numbers_is_told_with_file_and_line(tmp_path):
    write_table(tmp_path / "table.csv", ROWS, {"command": "solar-env study precision"})
    table = read_table(tmp_path / "table.csv")
    with pytest.raises(ValueError, match=r"table\.csv, line 3 lacks 'wall_s'; measure it anew"):
        table.column("wall_s")
    with pytest.raises(ValueError, match=r"table\.csv, line 3: method is 'runge-kutta', where a number belongs"):
        table.column("method")
    with pytest.raises(ValueError, match=r"table\.csv, line 4: method is 'paper', none of fine, .*; measure it anew"):
        choice(table.rows[1], "method", Kind)
    with pytest.raises(ValueError, match=r"table\.csv: no row has method = 'radau', step = 1; measure it anew"):
        table.first(method="radau", step=1)
    assert table.first(method="paper") == ROWS[1]


def test_rows_that_come_from_no_file_are_told_by_their_column():
    with pytest.raises(ValueError, match=r"^error is 'small', where a number belongs"):
        Table(({"error": "small"},), {}).column("error")
    assert number({"error": 2}, "error") == 2.0
