import math

import pytest

from solar_env.studies.common.tables import provenance, read_table, write_table

ROWS = [
    {"method": "runge-kutta", "step": 1e-3, "repeats": 3, "error": math.inf},
    {"method": "paper", "step": 0.1, "repeats": 5, "error": 2.5e-7},
]


def test_a_table_comes_back_as_it_was_written(tmp_path):
    made_by = provenance("solar-env chart", quick=True)
    write_table(tmp_path / "folder" / "table.csv", ROWS, made_by)
    table = read_table(tmp_path / "folder" / "table.csv")
    assert [dict(row) for row in table.rows] == ROWS
    assert table.provenance == made_by
    assert table.values("method") == ("runge-kutta", "paper")
    assert table.where(method="paper").column("error").tolist() == [2.5e-7]


def test_provenance_names_command_settings_and_versions():
    made_by = provenance("solar-env chart", quick=True, seed=3)
    assert made_by["command"] == "solar-env chart"
    assert made_by["quick"] == "True"
    assert made_by["seed"] == "3"
    assert {"solar-env", "numpy", "numba", "python", "machine"} <= made_by.keys()


def test_rows_that_do_not_fit_together_are_refused(tmp_path):
    with pytest.raises(ValueError, match="no row"):
        write_table(tmp_path / "table.csv", [], {})
    with pytest.raises(ValueError, match="differ in their columns"):
        write_table(tmp_path / "table.csv", [{"a": 1}, {"b": 2}], {})
    assert not (tmp_path / "table.csv").exists()
