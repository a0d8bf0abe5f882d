"""The level of the model as a word: what is read, what is written, what is refused."""

from __future__ import annotations

import re
from typing import Any

import pytest

from solar_env.array import MODELS, ArrayParameters, ModelLevel, build
from solar_env.array.deployment import simulate


@pytest.mark.parametrize(
    ("word", "level", "shortest"),
    [
        ("rigid-ideal", ModelLevel("rigid", "ideal"), "rigid-ideal"),
        ("rigid-clearance", ModelLevel("rigid", "clearance"), "rigid-clearance"),
        ("flexible-ideal", ModelLevel("flexible", "ideal", "modes", 32), "flexible-ideal"),
        ("flexible-clearance:32 modes", ModelLevel("flexible", "clearance", "modes", 32), "flexible-clearance"),
        ("flexible-clearance: 8 mode", ModelLevel("flexible", "clearance", "modes", 8), "flexible-clearance:8 modes"),
        ("flexible-ideal:0 modes", ModelLevel("flexible", "ideal", "modes", 0), "flexible-ideal:0 modes"),
        ("flexible-ideal:32 elements", ModelLevel("flexible", "ideal", "elements", 32), "flexible-ideal:32 elements"),
        ("flexible-ideal:1 elements", ModelLevel("flexible", "ideal", "elements", 1), "flexible-ideal:1 element"),
    ],
)
def test_a_word_is_read_and_its_level_written_as_the_shortest_one(word: str, level: ModelLevel, shortest: str) -> None:
    assert ModelLevel.of(word) == ModelLevel.of(level) == ModelLevel.of(shortest) == level
    assert str(level) == shortest
    assert f"{level.panels}-{level.joints}" == level.name in MODELS
    for body in build(ArrayParameters(), word).bodies[1:]:
        assert not level.flexible or getattr(body, level.unit) == level.count


@pytest.mark.parametrize(
    ("word", "message"),
    [
        ("rigid", "model 'rigid' is unknown; did you mean 'rigid-ideal'?"),
        ("flexible-cleerance:8 modes", "model 'flexible-cleerance' is unknown; did you mean 'flexible-clearance'"),
        ("flexible-clearance:8", "model 'flexible-clearance:8' is unknown"),
        ("flexible-clearance:8 beams", "as in 'flexible-clearance:8 modes' or 'flexible-ideal:6 elements'"),
        ("flexible-ideal:2.5 modes", "model 'flexible-ideal:2.5 modes' is unknown; did you mean 'flexible-ideal'"),
        ("auto", "choose from rigid-ideal, rigid-clearance, flexible-ideal, flexible-clearance"),
        (3, "model 3 is unknown; choose from"),
        ("rigid-ideal:8 modes", "model 'rigid-ideal' has rigid panels, which take no count: leave out '8 modes'"),
        ("flexible-ideal:0 elements", "elements = 0: must lie between 1 and 1000"),
        ("flexible-ideal:1001 elements", "elements = 1001: must lie between 1 and 1000"),
        ("flexible-ideal:201 modes", "modes = 201: must lie between 0 and 200"),
    ],
)
def test_a_wrong_word_is_refused_with_what_comes_close(word: Any, message: str) -> None:
    for call in (ModelLevel.of, lambda model: build(ArrayParameters(), model), lambda model: simulate(model=model)):
        with pytest.raises(ValueError, match=re.escape(message)):
            call(word)


@pytest.mark.parametrize(
    ("word", "integrator", "instead"),
    [
        ("flexible-ideal:8 modes", "rosenbrock", "flexible-ideal:6 elements"),
        ("flexible-clearance", "paper", "flexible-clearance:6 elements"),
        ("flexible-ideal:6 elements", "modal-radau", "flexible-ideal"),
    ],
)
def test_an_integrator_of_other_panels_is_refused_with_the_model_to_choose(
    word: str, integrator: str, instead: str
) -> None:
    message = f"integrator = '.*' steps panels of .*, and those of model = '{word}' .*: choose the model '{instead}'"
    with pytest.raises(ValueError, match=message):
        simulate(model=word, integrator=integrator)
