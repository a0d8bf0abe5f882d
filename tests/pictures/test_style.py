"""Claims about the style of the figures: every method, level and controller looks the same in all of them."""

from pathlib import Path

import pytest

import agents
from agents.commands.studies.learning import LENGTHS
from solar_env.pictures import style
from solar_env.studies.common.motion import Level
from solar_env.studies.common.plans import FULL, QUICK
from solar_env.studies.precision.methods import METHODS

TABLES = (style.METHOD_LOOKS, style.LEVEL_LOOKS, style.CONTROLLER_LOOKS)


@pytest.mark.parametrize("looks", TABLES)
def test_no_two_rows_of_a_table_have_a_colour_or_a_marker_in_common(looks):
    for entry in ("color", "marker"):
        assert len({look[entry] for look in looks.values()}) == len(looks)


def test_every_method_that_is_charted_has_its_look():
    assert METHODS.keys() <= set(style.METHOD_LOOKS)


def test_every_level_that_is_measured_has_its_look():
    levels = (*FULL.levels, *QUICK.levels)
    assert {
        Level(f"flexible-ideal:{level.panels}" if level.panels else "rigid-ideal", level.tighter).size
        for level in levels
    } == set(style.LEVEL_LOOKS)


def test_every_controller_and_algorithm_that_is_configured_has_its_look():
    configured = {path.stem for path in (Path(agents.__file__).parent / "configs").glob("*.json")}
    assert configured | set(LENGTHS) <= set(style.CONTROLLER_LOOKS)


def test_a_controller_looks_the_same_whatever_stands_beside_it():
    few = style.controller_looks(["servo", "cma-es-rigid"])
    many = style.controller_looks(["passive", "runs/first", "cma-es-rigid", "damper", "servo"])
    assert all(few[name] == many[name] for name in few)


def test_controllers_without_a_row_are_told_apart():
    names = ["ppo-nominal", "ppo-soft-start", "ppo", "runs/first", "runs/second"]
    looks = style.controller_looks(names)
    assert list(looks) == names
    assert len({look["color"] for look in looks.values()}) == len(names)


def test_a_name_without_a_row_is_refused():
    with pytest.raises(ValueError, match=r"'euler' has no colour and marker: add a row"):
        style.look_of("euler", style.METHOD_LOOKS)
