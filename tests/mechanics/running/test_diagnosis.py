"""Warnings name the quantity, its value and what to do, and keep silent below their limits."""

from __future__ import annotations

import pytest

from solar_env.array import ArrayParameters
from solar_env.mechanics.running.diagnosis import (
    SimulationWarning,
    check_constraint_forces,
    check_energy,
    check_impact_steps,
    check_restitution,
)


def test_an_open_energy_book_is_told_with_its_share_and_the_remedy() -> None:
    with pytest.warns(SimulationWarning, match=r"by t = 2 s .* gained 0\.3 J .* 15 % of the 2 J turned over; reduce"):
        assert check_energy(2.0, 0.3, 2.0, "reduce the step")
    with pytest.warns(SimulationWarning, match=r"lost 0\.3 J"):
        assert check_energy(2.0, -0.3, 2.0, "reduce the step")
    assert not check_energy(2.0, 0.0199, 2.0, "reduce the step")
    assert not check_energy(0.0, 0.0, 0.0, "reduce the step")


def test_an_energy_that_is_no_number_is_told() -> None:
    with pytest.warns(SimulationWarning, match="nan J"):
        assert check_energy(1.0, float("nan"), 1.0, "reduce the step")


def test_constraint_forces_that_are_off_are_told_with_both_forces() -> None:
    with pytest.warns(SimulationWarning, match=r"at t = 1 s .* off by 5 N where the largest force is 20 N.*rho_inf"):
        assert check_constraint_forces(1.0, 5.0, 20.0)
    assert not check_constraint_forces(1.0, 1.9, 20.0)


def test_impacts_that_a_step_does_not_resolve_are_told_with_the_step_that_does() -> None:
    with pytest.warns(
        SimulationWarning, match=r"0\.0008 s got 4 steps, .* needs 8; .* at most 0\.0001 s, or give rtol"
    ):
        assert check_impact_steps(4.0, 8, 8e-4)
    assert not check_impact_steps(8.0, 8, 8e-4)


def test_a_restitution_that_the_law_does_not_give_is_told_once_for_values_that_are_nearly_the_same() -> None:
    texts = set()
    for asked, given in ((0.5, 0.725), (0.501, 0.726)):
        with pytest.warns(SimulationWarning, match=r"nikravesh .* 0\.5 .* 0\.7; choose .*'restitution'") as caught:
            assert check_restitution("lankarani-nikravesh", asked, given)
        texts.add(str(caught[0].message))
    assert len(texts) == 1
    assert not check_restitution("lankarani-nikravesh", 0.9, 0.913)


@pytest.mark.parametrize(("law", "restitution"), [("lankarani-nikravesh", 0.5), ("lankarani-nikravesh", 0.78)])
def test_parameters_whose_law_bounces_too_much_are_accepted_with_a_warning(law: str, restitution: float) -> None:
    with pytest.warns(SimulationWarning, match="restitution"):
        parameters = ArrayParameters(contact_law=law, restitution=restitution)
    assert parameters.restitution == restitution


@pytest.mark.parametrize(
    ("law", "restitution"),
    [("lankarani-nikravesh", 0.8), ("flores", 0.5), ("flores", 0.01), ("restitution", 0.1), ("hertz", 0.5)],
)
def test_parameters_whose_law_bounces_as_asked_are_accepted_in_silence(law: str, restitution: float) -> None:
    ArrayParameters(contact_law=law, restitution=restitution)
