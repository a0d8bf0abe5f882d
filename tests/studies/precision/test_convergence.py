"""Members of ensembles are apart and the same everywhere; the study of convergence says whether two families meet."""

import math
from dataclasses import replace

import numpy as np
import pytest
from helpers import make_motion

from solar_env.array import ArrayParameters
from solar_env.array.parameters.ranges import RELEASE_RATE
from solar_env.studies.common.motion import SETTING_SHARE, Level, perturbed, perturbed_setting
from solar_env.studies.common.plans import FULL, QUICK
from solar_env.studies.common.tables import Table, read_table
from solar_env.studies.common.timing import Measured
from solar_env.studies.precision import convergence
from solar_env.support.readme import STUDIES


def test_members_are_released_at_rates_of_their_own_round_the_nominal_ones():
    nominal = ArrayParameters(panel_count=3, initial_rate=(0.1, 0.2))
    assert perturbed(nominal, 0) == replace(nominal, initial_rate=(0.1, 0.2, 0.2))
    rates = np.array([perturbed(nominal, member).initial_rate for member in range(1, 200)]) - (0.1, 0.2, 0.2)
    assert len(np.unique(rates.round(12))) == rates.size
    assert 0.9 * RELEASE_RATE < np.abs(rates).max() <= RELEASE_RATE
    assert np.abs(rates.mean(axis=0)).max() < 0.15 * RELEASE_RATE
    assert perturbed(nominal, 7) == perturbed(nominal, 7)


def test_members_take_settings_of_their_own_and_levels_divide_them():
    settings = np.array([perturbed_setting(2.0, member) for member in range(50)])
    assert settings[0] == 2.0
    assert len(np.unique(settings)) == 50
    assert np.abs(settings / 2.0 - 1.0).max() <= SETTING_SHARE
    level = Level("flexible-clearance")
    assert replace(level, tighter=4.0).integrator(3).rtol == pytest.approx(level.integrator(3).rtol / 4.0)
    assert level.integrator(3) == replace(level.integrator(), rtol=perturbed_setting(level.integrator().rtol, 3))


def test_levels_are_named_by_model_panels_and_tolerance():
    assert Level("rigid-ideal").name == "rigid-ideal"
    assert Level("flexible-ideal:1 element").name == "flexible-ideal, 1 element"
    assert Level("flexible-clearance", 4.0).name == "flexible-clearance, 32 modes, rtol / 4"


def test_a_level_simulates_its_member():
    level = Level("flexible-ideal:4 modes")
    run = level.deploy(ArrayParameters(), 2, 0.02, 0.02)
    assert run.metadata["model"] == level.model
    assert run.metadata["integrator_settings"]["rtol"] == level.integrator(2).rtol
    assert run.rates[0] == pytest.approx(perturbed(ArrayParameters(), 2).initial_rate)


@pytest.mark.parametrize("plan", [FULL, QUICK])
def test_both_families_of_panels_have_a_finest_level_with_clearance(plan):
    for kind in ("elements", "modes"):
        own = [level for level in plan.levels if convergence.family(level) == kind]
        assert own[-1].members >= 2
        assert own[-1].panels == max((level.panels for level in own), key=lambda panels: int(panels.split()[0]))


def level_row(family, level, forces):
    """A row of the table: the peak forces of joint 1 are those of an ensemble, everything else is 1 in every run."""
    totals = dict.fromkeys(convergence.MEANS, np.ones(2))
    motions = [replace(make_motion(), totals={**totals, "peak_force_N": np.array([force, 1.0])}) for force in forces]
    ideal = {"reference": "48 modes", "wall_ideal_s": 0.5, **dict.fromkeys(convergence.ERRORS, 1e-3)}
    return {"family": family, "level": level, **ideal} | convergence._means([Measured(one, (1.0,)) for one in motions])


def two_families(beams, modes):
    return Table((level_row("elements", "48 elements", beams), level_row("modes", "32 modes", modes)), {})


def test_families_meet_if_their_means_differ_by_what_sampling_explains():
    scatter = 5.0 * np.random.default_rng(0).normal(size=64)
    apart = convergence.conclusion(two_families(120.0 + scatter[:3], 100.0 + scatter[3:]))
    assert "have not met: 48 elements and 32 modes differ by +" in apart
    assert apart.endswith("at most, in the peak force of joint 1")
    met = convergence.conclusion(two_families(102.0 + scatter[:3], 100.0 + scatter[3:]))
    assert "go to one limit" in met
    assert met.endswith("in the peak force of joint 1")


def test_the_difference_of_means_has_the_errors_of_both():
    rows = two_families((9.0, 11.0), (4.0, 5.0, 6.0)).rows
    change, error = convergence.difference(*rows, "peak_force_N_1")
    assert change == pytest.approx(1.0)
    assert error == pytest.approx(math.hypot(1.0, 2.0 / math.sqrt(3.0)) / 5.0)


def test_the_page_has_means_with_the_digits_that_their_errors_allow():
    rows = two_families((9.0, 11.0), (4.0, 5.0, 6.0))
    page = convergence._page(rows)
    assert "errors relative to the level 48 modes:" in page
    assert "| 48 elements | 0.5 | 1.0e-03 | 1.0e-03 | 1.0e-03 |" in page
    assert "| 48 elements | 2 | 1 | 10.0 / 1 |" in page


def test_of_many_levels_the_page_shows_ten():
    page = convergence._page(read_table(STUDIES / "precision" / "data" / "convergence.csv"))
    assert len([line for line in page.splitlines() if line.startswith("| ")]) == 2 * (1 + 10)


def test_runs_that_could_not_go_on_do_not_count():
    ended = Measured(replace(make_motion(), totals=dict.fromkeys(convergence.MEANS, np.ones(2))), (1.0,))
    assert convergence._means([ended, Measured(None, failure="Newton")])["runs"] == 1
