"""Figure 5: the four-bar linkage, by an independent computation of its moment and speed."""

import cmath
import math
from functools import cache
from typing import Any

import numpy as np
import pytest

from solar_env.array import ArrayParameters
from solar_env.mechanics.mechanism.textbook import STANDARD_GRAVITY, Link
from solar_env.studies.paper import cases, figures
from solar_env.verification.linkages.four_bar import LinkageState, four_bar_state

LENGTHS, GROUND = (0.10, 0.35, 0.25), 0.40  # m


simulate_once = cache(cases.simulate_four_bar)


@cache
def ideal_turn() -> tuple[tuple[float, LinkageState], ...]:
    """Angles of the crank [rad] over a turn, and the motion and forces of the ideal linkage there."""
    links = [Link.slender(length, length) for length in LENGTHS]
    turned = (np.arange(cases.SAMPLES_PER_TURN) + 0.5) / cases.SAMPLES_PER_TURN
    angles = math.pi * (0.5 + 2.0 * turned)
    return tuple(
        (angle, four_bar_state(*links, GROUND, cases.FOUR_BAR_RATE, angle, STANDARD_GRAVITY)) for angle in angles
    )


def worn_volume(depths: Any) -> float:
    """Volume [m3] worn off the journal, by its depths by bin [m]."""
    array = ArrayParameters()
    bin_area = 2.0 * math.pi * array.journal_radius / array.wear_bins * cases.FOUR_BAR_WIDTH
    return float(depths.sum()) * bin_area


def test_four_bar_wears_more_with_every_turn_and_its_books_close() -> None:
    motions = [cases.simulate_four_bar(turns, with_clearance=True) for turns in (1, 2)]
    depths = [motion.wear_bearing.max() for motion in motions]
    assert 1.5 < depths[1] / depths[0] < 2.5
    assert abs(motions[1].energy_residual) < 1e-4 * np.abs(motions[1].energies["external_work"]).max()


@pytest.fixture(scope="module")
def linkage() -> dict[tuple[str, int], Any]:
    """The curves of Figure 5 by quantity and turns."""
    curves: dict[tuple[str, int], Any] = {}
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(figures, "simulate_four_bar", simulate_once)
        rows = figures.FIGURES[5].table([{}])
    for row in rows:
        curves.setdefault((str(row["quantity"]), int(row["turns"])), []).append((row["place"], row["value"]))
    return {key: np.array(curve) for key, curve in curves.items()}


def test_figure_5_shows_the_turn_on_the_papers_axis_and_three_stages_of_wear(
    linkage: dict[tuple[str, int], Any],
) -> None:
    assert sorted(linkage) == [
        ("crank moment [N m]", 0), ("crank moment [N m]", 26), ("rocker speed [rad/s]", 0),
        ("rocker speed [rad/s]", 26), *(("wear depth of the journal [m]", turns) for turns in (6, 16, 26)),
    ]  # fmt: skip
    for (quantity, _), curve in linkage.items():
        if "wear" not in quantity:
            assert curve[[0, -1], 0] == pytest.approx([2.0, 2.08], abs=1e-4)
    worn = [linkage["wear depth of the journal [m]", turns][:, 1].sum() for turns in (6, 16, 26)]
    assert worn == pytest.approx(np.array([6, 16, 26]) * worn[2] / 26, rel=0.1)


def test_moment_and_speed_of_figure_5_are_those_of_inverse_dynamics(linkage: dict[tuple[str, int], Any]) -> None:
    """With an ideal joint at every angle; with clearance the rocker's speed but for what the play leaves it."""
    moments, speeds = np.array([(state.crank_moment, state.output_rate) for _, state in ideal_turn()]).T
    scale = np.abs(moments).max()
    assert linkage["crank moment [N m]", 0][:, 1] == pytest.approx(moments, abs=2e-4 * scale)
    assert linkage["rocker speed [rad/s]", 0][:, 1] == pytest.approx(speeds, abs=2e-4 * np.abs(speeds).max())
    loose = linkage["rocker speed [rad/s]", 26][:, 1]
    assert np.sqrt(np.mean((loose - speeds) ** 2)) < 0.05 * np.abs(speeds).max()


def test_the_crank_moment_of_figure_5_does_the_work_that_is_lost_or_stored_and_wear_is_that_of_the_sliding(
    linkage: dict[tuple[str, int], Any],
) -> None:
    ideal, worn = (linkage["crank moment [N m]", turns][:, 1] for turns in (0, 26))
    assert np.mean(ideal) == pytest.approx(0.0, abs=1e-6 * np.abs(ideal).max())
    motion = simulate_once(26, with_clearance=True)
    energies = motion.energies
    names = ("friction_dissipation", "contact_dissipation", "kinetic", "contact", "gravity")
    balance = np.sum([energies[name] for name in names], axis=0)
    work = balance[-1] - balance[-1 - cases.SAMPLES_PER_TURN]
    assert np.mean(worn) * 2.0 * math.pi == pytest.approx(work, rel=1e-3)
    # Archard's volume is that of the sliding work, here from the books; friction sets in at a thousandth of the speed.
    array = ArrayParameters()
    sliding_work = energies["friction_dissipation"][-1] / array.by_joint("friction_coefficient", 0)
    assert worn_volume(motion.wear_journal) == pytest.approx(array.wear_coefficient * sliding_work, rel=0.01)


def test_the_pin_of_figure_5_wears_as_much_as_the_forces_of_inverse_dynamics_would_wear_it(
    linkage: dict[tuple[str, int], Any],
) -> None:
    """Archard's depth over 26 turns of the ideal linkage, whose journal neither flies nor rattles in its play."""
    rate = cases.FOUR_BAR_RATE
    rubbed = []
    for angle, state in ideal_turn():
        pin, rocker = cmath.rect(LENGTHS[0], angle), cmath.rect(LENGTHS[2], state.output)
        coupler_rate = ((state.output_rate * rocker - rate * pin) / (GROUND + rocker - pin)).real
        rubbed.append(abs(state.pin_forces[1]) * abs(coupler_rate - rate))
    array = ArrayParameters()
    duration = 26 * 2.0 * math.pi / rate
    volume = array.wear_coefficient * float(np.mean(rubbed)) * array.journal_radius * duration
    worn = worn_volume(linkage["wear depth of the journal [m]", 26][:, 1])
    assert worn == pytest.approx(volume, rel=0.08)
