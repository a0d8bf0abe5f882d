"""Warnings name the quantity, its value and what to do, and are empty below their limits."""

from __future__ import annotations

import re

import pytest

from solar_env.array import ArrayParameters
from solar_env.mechanics.running.diagnosis import (
    SimulationWarning,
    constraint_force_text,
    energy_text,
    impact_step_text,
    restitution_text,
)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (
            energy_text(2.0, 0.3, 2.0, "reduce the step"),
            r"by t = 2 s .* gained 0\.3 J .* 15 % of the 2 J turned over",
        ),
        (energy_text(2.0, -0.3, 2.0, "reduce the step"), r"lost 0\.3 J"),
        (energy_text(1.0, float("nan"), 1.0, "reduce the step"), "nan J"),
        (constraint_force_text(1.0, 5.0, 20.0), r"at t = 1 s .* off by 5 N where the largest force is 20 N.*rho_inf"),
        (impact_step_text(4.0, 8, 8e-4), r"0\.0008 s got 4 steps, .* needs 8; .* at most 0\.0001 s, or give rtol"),
        (restitution_text("lankarani-nikravesh", 0.5, 0.725), r"nikravesh .* 0\.5 .* 0\.7; choose .*'restitution'"),
    ],
)
def test_a_shortcoming_is_told_with_its_quantity_and_a_remedy(text: str, told: str) -> None:
    assert re.search(told, text)


def test_below_their_limits_nothing_is_told() -> None:
    assert energy_text(2.0, 0.0199, 2.0, "") == energy_text(0.0, 0.0, 0.0, "") == ""
    assert constraint_force_text(1.0, 1.9, 20.0) == impact_step_text(8.0, 8, 8e-4) == ""
    assert restitution_text("lankarani-nikravesh", 0.9, 0.913) == ""


def test_a_restitution_is_told_once_for_values_that_are_nearly_the_same() -> None:
    law = "lankarani-nikravesh"
    assert restitution_text(law, 0.5, 0.725) == restitution_text(law, 0.501, 0.726)


@pytest.mark.parametrize("restitution", [0.5, 0.78])
def test_parameters_whose_law_bounces_too_much_are_accepted_with_a_warning(restitution: float) -> None:
    with pytest.warns(SimulationWarning, match="restitution"):
        parameters = ArrayParameters(contact_law="lankarani-nikravesh", restitution=restitution)
    assert parameters.restitution == restitution


@pytest.mark.parametrize(
    ("law", "restitution"),
    [("lankarani-nikravesh", 0.8), ("flores", 0.5), ("flores", 0.01), ("restitution", 0.1), ("hertz", 0.5)],
)
def test_parameters_whose_law_bounces_as_asked_are_accepted_in_silence(law: str, restitution: float) -> None:
    ArrayParameters(contact_law=law, restitution=restitution)
