"""The choice of a model of the flexible panels."""

from __future__ import annotations

import re
from typing import Any

import pytest

from solar_env.array import (
    ArrayParameters,
    PanelModel,
    build,
)


@pytest.mark.parametrize(
    ("asked", "found"),
    [
        ({}, PanelModel("modal", 32)),
        ({"preset": "paper"}, PanelModel("ancf", 6)),
        ({"preset": "paper", "panels": "modal"}, PanelModel("modal", 32)),
        ({"preset": "paper", "modes": 8}, PanelModel("modal", 8)),
        ({"preset": "paper", "integrator": "modal-radau"}, PanelModel("modal", 32)),
        ({"panels": "modal"}, PanelModel("modal", 32)),
        ({"panels": "ancf"}, PanelModel("ancf", 6)),
        ({"elements": 3}, PanelModel("ancf", 3)),
        ({"modes": 8}, PanelModel("modal", 8)),
        ({"panels": PanelModel("modal", 5), "integrator": "modal-radau"}, PanelModel("modal", 5)),
        ({"panels": PanelModel("modal", 5), "modes": 3}, PanelModel("modal", 3)),
        ({"integrator": "modal-radau"}, PanelModel("modal", 32)),
        ({"integrator": "rosenbrock"}, PanelModel("ancf", 6)),
        ({"panels": "modal", "modes": 8, "integrator": "modal-radau"}, PanelModel("modal", 8)),
    ],
)
def test_the_model_of_the_panels_follows_from_what_is_named(asked: dict[str, Any], found: PanelModel) -> None:
    assert PanelModel.of("flexible-ideal", **asked) == found
    assert PanelModel.of("flexible-ideal", **found.keywords) == found
    for body in build(ArrayParameters(), "flexible-ideal", panels=found).bodies[1:]:
        assert getattr(body, found.option) == found.count
    # Rigid panels take every method.
    PanelModel.of("rigid-ideal", **{**asked, "integrator": "runge-kutta"})


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ({"panels": "modals"}, "panels 'modals' is unknown; did you mean 'modal'?"),
        (
            {"panels": "modal", "elements": 3},
            "elements=3 belongs to panels of beam elements and panels='modal' to",
        ),
        (
            {"panels": "ancf", "modes": 3},
            "panels='ancf' belongs to panels of beam elements and modes=3 to modal",
        ),
        (
            {"elements": 3, "modes": 3},
            "elements=3 belongs to panels of beam elements and modes=3 to modal panels: leave",
        ),
        (
            {"modes": 3, "integrator": "rosenbrock"},
            "integrator='rosenbrock' belongs to panels of beam elements and modes=3",
        ),
        ({"panels": "ancf", "integrator": "modal-radau"}, "integrator='modal-radau' to modal panels: leave out one"),
        (
            {"panels": PanelModel("modal", 5), "elements": 3},
            "elements=3 belongs to panels of beam elements and panels=",
        ),
        ({"modes": 201}, "modes = 201: must lie between 0 and 200"),
    ],
)
def test_what_contradicts_itself_about_the_panels_is_refused(asked: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=re.escape(message)):
        PanelModel.of("flexible-ideal", **asked)
