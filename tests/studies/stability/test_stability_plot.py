"""Figures of maps come from their tables alone."""

from pathlib import Path

import matplotlib as mpl
import pytest

from solar_env.pictures.style import OUTCOME_COLOURS
from solar_env.studies.common.tables import write_table
from solar_env.studies.stability.maps import Kind
from solar_env.studies.stability.stability_plot import draw_map

ABOUT = {
    "title": "A map",
    "x": "step_s",
    "y": "rho_inf",
    "x label": "step [s]",
    "y label": "rho_inf",
    "value": "gain",
    "limit": "theory",
    "advice": "Take shorter steps.",
}


def write_example(path: Path) -> None:
    rows = [
        {
            "panel": panel, "step_s": x, "rho_inf": y, "class": kind, "value": x, "limit": 0.02, "said": said,
            "message": "",
        }
        for panel in ("one", "two")
        for y in (0, 0.5)
        for x, kind, said in ((0.01, "fine", ""), (0.1, "growing", "warning"), (1.0, "blow-up", "error"))
    ]  # fmt: skip
    write_table(path, rows, ABOUT)


def test_a_table_is_enough_for_a_figure_with_title_classes_limit_and_advice(tmp_path: Path) -> None:
    write_example(tmp_path / "map.csv")
    with mpl.rc_context({"svg.fonttype": "none"}):
        draw_map(tmp_path / "map.csv", tmp_path / "map.svg")
    text = (tmp_path / "map.svg").read_text()
    for words in ("A map", "one", "two", "growing", "blow-up", "Line: theory", "Take shorter steps."):
        assert words in text


def test_another_table_is_refused_by_name(tmp_path: Path) -> None:
    write_table(tmp_path / "other.csv", [{"a": 1}], {"title": "x"})
    with pytest.raises(ValueError, match=r"other\.csv is damaged or lacks panel; measure it anew"):
        draw_map(tmp_path / "other.csv", tmp_path / "other.png")


def test_every_class_has_a_colour() -> None:
    assert set(OUTCOME_COLOURS) == set(Kind)
