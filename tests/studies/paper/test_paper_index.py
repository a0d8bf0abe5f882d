"""The index of the paper's equations, figures and tables: complete, and true of the code."""

import re
from pathlib import Path

import pytest

from solar_env.commands.studies.paper import INDEX_SECTION
from solar_env.studies.paper.index import INDEX, Entry, as_markdown

ROOT = Path(__file__).parents[3]


def test_every_equation_and_figure_is_listed_once() -> None:
    for kind, all_numbers in (("Eq", range(1, 47)), ("Fig", range(1, 24))):
        listed = [number for entry in INDEX if entry.place.startswith(kind) for number in entry.numbers]
        assert listed == list(all_numbers)


@pytest.mark.parametrize("entry", INDEX, ids=lambda entry: entry.place)
def test_what_is_listed_is_there(entry: Entry) -> None:
    for place in (entry.code, entry.test):
        file, name = place.split(":")
        text = (ROOT / file).read_text(encoding="utf-8")
        assert re.search(rf"^(def |class |){re.escape(name)}\b", text, re.MULTILINE), place
        assert name.startswith("test_") == (place == entry.test)


def test_the_page_holds_the_index() -> None:
    assert INDEX_SECTION.read() == as_markdown()
