import math
import re

import pytest

from solar_env.studies.common.tables import provenance, read_table, write_table

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


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("0.1,5", "fast,5", "step, which is 'fast' and no number"),
        ("0.1,5", ",5", "step, which is '' and no number"),
        ("0.1,5", "0.1", "its rows (zip"),
        ("step,", "steps,", "step"),
    ],
)
def test_a_damaged_or_outdated_file_is_told_by_its_name_and_column(tmp_path, old, new, told):
    path = tmp_path / "table.csv"
    write_table(path, ROWS, {"command": "solar-env study precision"})
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))
    with pytest.raises(ValueError, match=re.escape(f"table.csv is damaged or lacks {told}")):
        read_table(path).column("step")


def test_rows_with_other_columns_are_not_written(tmp_path):
    with pytest.raises(ValueError, match="'b'"):
        write_table(tmp_path / "table.csv", [{"a": 1}, {"b": 2}], {})
    assert not (tmp_path / "table.csv").exists()
