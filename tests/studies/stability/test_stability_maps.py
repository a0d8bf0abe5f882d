"""Where methods fail, and that the library says so: every quick map is measured, and its claims are checked."""

import math
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pytest

from solar_env.mechanics.integrators.settings import amplification_radius, steps_per_impact
from solar_env.mechanics.joints.contact.laws import contact_law
from solar_env.mechanics.running.trajectory import Trajectory
from solar_env.studies.common.tables import Table, read_table
from solar_env.studies.stability import (
    beam_maps,
    contact_law_maps,
    friction_maps,
    impact_maps,
    modal_maps,
    multiplier_maps,
    stop_maps,
)
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


def test_too_few_explicit_steps_are_refused_and_would_fail() -> None:
    for row in rows("impact-explicit", panel=impact_maps.LIBRARY):
        assert row["class"] == (Kind.FINE if row["steps_per_impact"] >= row["limit"] else Kind.REFUSED)
    assert {row["class"] for row in rows("impact-explicit", rtol=0.1, steps_per_impact=2)} == {
        Kind.REFUSED,
        Kind.OVER_DAMPED,
    }
    assert rows("impact-explicit", rtol=1e-6, steps_per_impact=1, panel=impact_maps.UNCHECKED)[0]["class"] == Kind.FINE


def test_without_a_restart_a_change_of_step_sends_multipliers_to_known_spikes() -> None:
    # Newtons over g, from 0.01 to 0.001 s: 6.8 at rho_inf = 0.8; 35 rising to 350 in 200 steps at 1.
    spiked = multiplier_maps.textbook_errors(0.1, 0.8) * 9.81
    assert spiked.max() == pytest.approx(6.8, rel=0.02)
    assert spiked[-50:].max() < 1e-2
    rising = multiplier_maps.textbook_errors(0.1, 1.0) * 9.81
    assert 30.0 < rising[:30].max() < 60.0
    assert rising[-10:].max() == pytest.approx(350.0, rel=0.02)


def test_the_library_restarts_and_tells_of_what_a_restart_cannot_help() -> None:
    for row in rows("step-change", panel=multiplier_maps.LIBRARY):
        if row["rho_inf"] < 1.0:
            assert row["class"] == Kind.FINE
        elif row["class"] == Kind.GROWING:
            assert "constraint forces" in row["message"]
    assert (
        rows("step-change", rho_inf=0.8, step_ratio=0.1, panel=multiplier_maps.CARRIED_OVER)[0]["class"] == Kind.SPIKES
    )


def test_adaptive_steps_on_beams_grow_just_beyond_the_limit_which_the_library_keeps() -> None:
    for row in rows("beam-step"):
        beyond = row["step_s"] / row["limit"]
        if row["panel"] == beam_maps.UNBOUNDED:
            assert row["class"] == (Kind.GROWING if beyond > 1.0 else Kind.FINE)
        else:
            assert row["class"] == (Kind.LIMITED if beyond > 0.95 else Kind.FINE)
            assert row["said"] == (Said.FIGURE if beyond > 0.95 else Said.SILENT)


def test_modal_panels_warn_from_where_theory_says_and_before_they_are_off_by_a_hundredth() -> None:
    for row in rows("modal-range"):
        assert (row["said"] != Said.SILENT) == (row["softening"] > row["limit"])
        assert row["said"] != Said.SILENT or abs(row["value"]) < 0.006
    for row in rows("modal-range", panel=modal_maps.SPIN):
        # The squared frequency that elements have grows by 2.05 spin^2.
        ratio = row["demand"] * math.sqrt(row["softening"]) / modal_maps._FREQUENCY
        assert row["value"] == pytest.approx((1.0 + 2.05 * ratio**2) ** -0.5 - 1.0, abs=0.005)


def test_a_deployment_of_softer_modal_panels_is_that_of_beam_elements() -> None:
    (row,) = rows("modal-array", softening=10)
    assert abs(row["value"]) < 0.01
    assert row["said"] == Said.SILENT


def test_bounces_have_the_speed_of_the_law_in_closed_form() -> None:
    for row in rows("restitution"):
        law = contact_law(row["panel"], contact_law_maps.ARRAY.surfaces(0), row["restitution"])
        slower = replace(law, damping=law.damping * min(1.0, row["speed_m_s"] / 1e-4))
        assert row["value"] == pytest.approx(slower.exit_speed_ratio(), abs=2e-3)
    (half,) = rows("restitution", panel="lankarani-nikravesh", restitution=0.5, speed_m_s=1)
    assert (half["class"], half["said"]) == (Kind.WRONG, Said.WARNING)
    assert half["value"] == pytest.approx(0.7252, abs=1e-3)
    (slow,) = rows("restitution", panel="flores", restitution=0.5, speed_m_s=1e-6)
    assert (slow["class"], slow["said"]) == (Kind.WRONG, Said.FIGURE)
    assert "minimum impact speed" in slow["message"]


def test_a_law_attracts_and_is_cut_off_just_where_its_damping_outweighs_the_elastic_force() -> None:
    for row in rows("pull-off"):
        near = abs(row["restitution"] - row["limit"]) < 0.05
        assert near or row["class"] == (Kind.CUT_OFF if row["restitution"] < row["limit"] else Kind.FINE)
        assert row["said"] == (Said.FIGURE if row["class"] == Kind.CUT_OFF else Said.SILENT)


@pytest.mark.parametrize("law", contact_law_maps.LAWS)
def test_a_run_tells_in_how_many_samples_the_damping_was_cut_off(law: str) -> None:
    _, undamped = contact_law_maps._pull_off(law, restitution=1.0, ratio=10.0)
    assert undamped.metadata["cut_off_share"] < 0.01
    _, damped = contact_law_maps._pull_off("flores", restitution=0.01, ratio=10.0)
    assert damped.metadata["cut_off_share"] == 1.0


@pytest.mark.parametrize("integrator", friction_maps.CREEP.panels)
def test_a_run_tells_in_how_many_samples_a_contact_crept(integrator: str) -> None:
    _, run = friction_maps._creep(integrator, speed_zero=0.0, speed_full=1e-3)
    assert run.metadata["creeping_share"] == 1.0


@pytest.mark.parametrize("share", ["creeping_share", "cut_off_share"])
def test_a_map_says_nothing_that_the_run_has_not_told(share: str, monkeypatch: pytest.MonkeyPatch) -> None:
    module, cell = {
        "creeping_share": (friction_maps, lambda: friction_maps.measure_creep(friction_maps.EXPLICIT, 1e-3, 0.0)),
        "cut_off_share": (contact_law_maps, lambda: contact_law_maps.measure_pull_off("flores", 0.01, 10.0)),
    }[share]
    assert cell().said == Said.FIGURE
    simulate = module.simulate

    def silent(*arguments: Any, **keywords: Any) -> Trajectory:
        run = simulate(*arguments, **keywords)
        return replace(run, metadata={**run.metadata, share: 0.0})

    monkeypatch.setattr(module, "simulate", silent)
    assert cell().said == Said.SILENT


def test_contacts_creep_as_the_ramp_has_it_and_a_run_tells_how_much_of_it_crept() -> None:
    for row in rows("friction-creep"):
        v0, v1 = row["speed_zero_m_s"], row["speed_full_m_s"]
        if v0 >= v1:
            assert (row["class"], row["said"]) == (Kind.REFUSED, Said.ERROR)
            assert "speed_zero" in row["message"]
            continue
        assert row["value"] == pytest.approx(0.5 * (v0 + v1), rel=1e-2)
        assert row["class"] == (Kind.CREEPS if row["value"] > friction_maps.SLOW_CREEP else Kind.FINE)
        assert row["class"] == Kind.FINE or (row["said"], row["message"].split(" of ")[0]) == (
            Said.FIGURE,
            "creeping_share = 1",
        )


def test_a_narrow_ramp_bounds_the_explicit_step_as_theory_has_it() -> None:
    (narrow,) = rows("friction-step", speed_zero_m_s=0, speed_full_m_s=1e-6)
    assert narrow["class"] == Kind.STIFF
    assert narrow["value"] == pytest.approx(friction_maps.friction_step(0.0, 1e-6), rel=0.1)
    (wide,) = rows("friction-step", speed_zero_m_s=0, speed_full_m_s=1e-3)
    # The bearing's stiffness and damping, linearly implicit in a contact that lasts, do not.
    assert wide["value"] > 10.0 * friction_maps.SHORT_STEP


def test_vibrations_of_a_slack_cable_are_damped_beyond_the_limit_and_told() -> None:
    for row in rows("cable", panel=stop_maps.DAMPED):
        if row["step_s"] < 0.5 * row["limit"]:
            assert row["class"] == Kind.FINE
        elif row["step_s"] > 3.0 * row["limit"]:
            assert row["class"] != Kind.FINE
            assert row["said"] in (Said.WARNING, Said.ERROR)


def test_a_latch_is_resolved_by_eight_steps_whatever_its_stiffness() -> None:
    for name in ("latch", "latch-depth"):
        for row in rows(name):
            if row["panel"] == stop_maps.EXPLICIT or row["step_s"] < 0.5 * row["limit"]:
                assert row["class"] == Kind.FINE
    rigid = rows("latch", stiffness_Nm_rad=1e8, step_s=0.01, panel=stop_maps.DAMPED)[0]
    assert rigid["class"] == Kind.BLOW_UP
    assert "accounts for" in rigid["message"]


def test_the_duration_that_steps_are_measured_by_is_that_of_the_first_impact() -> None:
    depth = (1.25 * impact_maps.MASS * impact_maps.SPEED**2 / 7.39e10) ** 0.4
    assert impact_maps.contact_duration() == pytest.approx(2.94328 * depth / impact_maps.SPEED, rel=1e-5)
