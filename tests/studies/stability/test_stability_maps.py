"""Where methods fail, and that the library says so: every quick map is measured, and its claims are checked."""

import math
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pytest

from solar_env.mechanics.integrators.settings import RungeKutta, amplification_radius, steps_per_impact
from solar_env.mechanics.joints.laws import PowerLaw, contact_law
from solar_env.studies.common.tables import Table, read_table
from solar_env.studies.stability import friction_maps, impact_maps, step_maps
from solar_env.studies.stability.maps import Kind, Said, silent_failures
from solar_env.studies.stability.stability_maps import MAPS, measure_map


@lru_cache(maxsize=len(MAPS))
def quick(name: str) -> Table:
    """The table of a quick map, as it is read back."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "map.csv"
        measure_map(name, True, path, lambda: None)
        return read_table(path)


def rows(name: str, **cells: Any) -> list[dict[str, Any]]:
    found = [dict(row) for row in quick(name).where(**cells).rows]
    assert found
    return found


@pytest.mark.parametrize("name", MAPS)
def test_no_failure_of_a_map_passes_in_silence(name: str) -> None:
    table = quick(name)
    assert silent_failures(table).rows == ()
    assert set(table.values("class")) <= set(Kind)
    # A map on which nothing fails would show nothing.
    assert Kind.FINE in table.values("class")
    assert len(table.values("class")) > 1
    assert table.provenance["advice"].endswith(".")
    for row in table.rows:
        assert bool(row["message"]) == (row["said"] != Said.SILENT)


def test_impacts_are_fine_up_to_the_limit_and_told_beyond_it_for_every_rho_inf() -> None:
    for row in rows("impact-implicit"):
        if row["step_over_duration"] <= row["limit"]:
            assert row["class"] == Kind.FINE
        else:
            assert row["said"] == Said.WARNING
            assert "needs" in row["message"] or "accounts for" in row["message"]
    kinds = {row["class"] for row in rows("impact-implicit")}
    assert kinds >= {Kind.OVER_DAMPED, Kind.GROWING, Kind.BLOW_UP}
    assert {row["class"] for row in rows("impact-implicit", rho_inf=0)} == {Kind.FINE, Kind.OVER_DAMPED}


def test_steps_to_an_impact_grow_with_algorithmic_damping_and_keep_a_hundredth_of_the_speed() -> None:
    assert [steps_per_impact(rho) for rho in (0.0, 0.2, 0.4, 0.5, 0.8, 1.0)] == [23, 16, 10, 8, 8, 8]
    # sqrt(15 / 8) v / depth is the frequency at the greatest depth.
    phase = math.sqrt(1.875) * 2.94328 / 23.0
    assert 0.99 <= amplification_radius(0.0, phase) ** 23 < 0.992
    assert amplification_radius(1.0, 2.0) == pytest.approx(1.0, abs=1e-12)
    assert amplification_radius(0.6, 1e7) == pytest.approx(0.6, abs=1e-3)


@pytest.mark.filterwarnings("ignore:.*the integration has lost")
@pytest.mark.parametrize("rtol", [1e-6, 1e-3, 1e-1])
def test_explicit_bounces_of_four_steps_an_impact_keep_their_speed_at_every_tolerance(rtol: float) -> None:
    ratios = impact_maps.bounce_ratios(PowerLaw(7.39e10), RungeKutta(rtol=rtol, impact_resolution=4.0))
    assert ratios == pytest.approx(1.0, abs=impact_maps.TOLERANCE)


def test_multipliers_hold_over_changes_of_the_step_and_what_a_restart_cannot_help_is_told() -> None:
    for row in rows("step-change"):
        if row["rho_inf"] < 1.0:
            assert row["class"] == Kind.FINE
        elif row["class"] == Kind.GROWING:
            assert "constraint forces" in row["message"]
    assert rows("step-change", rho_inf=1, step_ratio=1)[0]["class"] == Kind.GROWING


def test_bounces_have_the_speed_of_the_law_in_closed_form() -> None:
    for row in rows("restitution"):
        law = contact_law(row["panel"], impact_maps.ARRAY.surfaces(0), row["restitution"])
        slower = replace(law, damping=law.damping * min(1.0, row["speed_m_s"] / 1e-4))
        assert row["value"] == pytest.approx(slower.exit_speed_ratio(), abs=2e-3)
    (half,) = rows("restitution", panel="lankarani-nikravesh", restitution=0.5, speed_m_s=1)
    assert (half["class"], half["said"]) == (Kind.WRONG, Said.WARNING)
    assert half["value"] == pytest.approx(0.7252, abs=1e-3)
    (slow,) = rows("restitution", panel="flores", restitution=0.5, speed_m_s=1e-6)
    assert (slow["class"], slow["said"]) == (Kind.WRONG, Said.FIGURE)
    assert "minimum impact speed" in slow["message"]


@pytest.mark.parametrize("panel", friction_maps.FRICTION_MAP.panels)
def test_contacts_creep_as_the_ramp_has_it_and_a_run_tells_how_much_of_it_crept(
    panel: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    for row in rows("friction", panel=panel):
        v0, v1 = row["speed_zero_m_s"], row["speed_full_m_s"]
        if v0 >= v1:
            assert (row["class"], row["said"]) == (Kind.REFUSED, Said.ERROR)
            assert "friction_speeds" in row["message"]
            continue
        assert row["value"] == pytest.approx(0.5 * (v0 + v1), rel=1e-2)
        creeps = row["value"] > friction_maps.SLOW_CREEP
        assert creeps == (row["class"] == Kind.CREEPS) == row["message"].startswith("creeping_share = 1 of")
    # A map says nothing that the run has not told.
    run = friction_maps.creep(panel, speed_zero=0.0, speed_full=1e-3)
    silent = replace(run, metadata={**run.metadata, "creeping_share": 0.0})
    monkeypatch.setattr(friction_maps, "creep", lambda *_: silent)
    assert friction_maps.measure_friction(panel, 1e-3, 0.0).said == Said.SILENT


def test_a_narrow_ramp_bounds_the_explicit_step_as_theory_has_it() -> None:
    (narrow,) = rows("friction", panel=friction_maps.EXPLICIT, speed_zero_m_s=0, speed_full_m_s=1e-6)
    assert (narrow["class"], narrow["said"]) == (Kind.STIFF, Said.FIGURE)
    runs = [friction_maps.creep(friction_maps.EXPLICIT, 0.0, full) for full in (1e-6, 1e-3)]
    steps = [run.time[-1] / run.metadata["steps"] for run in runs]
    # Four explicit stages of order four: 2.785 over the decay rate of sliding.
    slope = friction_maps.FRICTION * friction_maps.LOAD / 1e-6  # N s/m
    rate = slope * (1.0 / friction_maps.MASS + friction_maps.RADIUS**2 / friction_maps.INERTIA)
    assert steps[0] == pytest.approx(2.785 / rate, rel=0.1)
    # The bearing's stiffness and damping, linearly implicit in a contact that lasts, do not.
    assert steps[1] > 10.0 * friction_maps.SHORT_STEP


def test_a_latch_is_resolved_by_eight_steps_whatever_its_stiffness() -> None:
    for row in rows("latch"):
        if row["panel"] == step_maps.EXPLICIT or row["step_s"] < 0.5 * row["limit"]:
            assert row["class"] == Kind.FINE
    rigid = rows("latch", stiffness_Nm_rad=1e8, step_s=0.01, panel=step_maps.DAMPED)[0]
    assert rigid["class"] == Kind.BLOW_UP
    assert "accounts for" in rigid["message"]


def test_the_duration_that_steps_are_measured_by_is_that_of_the_first_impact() -> None:
    depth = (1.25 * impact_maps.MASS * impact_maps.SPEED**2 / 7.39e10) ** 0.4
    assert impact_maps.contact_duration() == pytest.approx(2.94328 * depth / impact_maps.SPEED, rel=1e-5)
