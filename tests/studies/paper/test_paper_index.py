"""The table of the paper's equations, figures and tables: complete, and true of the code."""

import re
from pathlib import Path

import pytest

from solar_env.commands.studies.paper import FOLDER
from solar_env.studies.common.tables import read_table

ROOT = Path(__file__).parents[3]
# Place in the paper -> file and name of its code, and of its test.
INDEX = {row["place"]: (row["code"], row["test"]) for row in read_table(FOLDER / "equations.csv").rows}


def test_every_equation_and_figure_is_listed_once():
    for kind, last in (("Eq", 46), ("Fig", 23)):
        spans = [re.findall(r"\d+", place) for place in INDEX if place.startswith(kind)]
        assert [k for span in spans for k in range(int(span[0]), int(span[-1]) + 1)] == list(range(1, last + 1))


@pytest.mark.parametrize("place", INDEX)
def test_what_is_listed_is_there(place):
    for listed in INDEX[place]:
        file, name = listed.split(":")
        text = (ROOT / file).read_text(encoding="utf-8")
        assert re.search(rf"^(def |class |){re.escape(name)}\b", text, re.MULTILINE), listed
        assert name.startswith("test_") == (listed == INDEX[place][1])
