"""The result of a run: shapes, summary, and saving."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from mechanisms import block, rotor

from solar_env.array.deployment import simulate as simulate_deployment
from solar_env.array.methods import default_integrator
from solar_env.mechanics.arrays.columns import TORQUES
from solar_env.mechanics.arrays.model import ENERGY_NAMES
from solar_env.mechanics.integrators.settings import GeneralizedAlpha
from solar_env.mechanics.running.simulation import simulate
from solar_env.mechanics.running.trajectory import Trajectory

JOINTS, SAMPLES, BINS = 2, 201, 360
# Figures of the summary that are lists by joint, and the attributes that hold them.
PLAIN_LISTS = {
    "latch_times_s": "latch_times",
    "latch_rates_rad_s": "latch_rates",
    "peak_latch_torque_Nm": "peak_latch_torque",
    "peak_contact_force_N": "peak_force",
    "peak_postlock_force_N": "postlock_peak_force",
    "postlock_impulse_Ns": "postlock_impulse",
    "postlock_sliding_work_J": "postlock_sliding_work",
    "contact_starts": "contact_starts",
}
COUNTED = (
    "steps",
    "rejected_steps",
    "evaluations",
    "factorizations",
    "stability_bound_steps",
    "slow_contacts",
    "creeping_share",
    "wall_time_s",
)


RIGID: dict[str, Any] = {"model": "rigid-clearance"}
MODAL: dict[str, Any] = {"model": "flexible-clearance:4 modes"}


@pytest.fixture(scope="module", params=[RIGID, MODAL], ids=["rigid", "modal"])
def run(request: pytest.FixtureRequest) -> Trajectory:
    return simulate_deployment(**request.param, duration=2.0)


@pytest.fixture(scope="module", params=[RIGID, MODAL], ids=["rigid", "modal"])
def latched(request: pytest.FixtureRequest) -> Trajectory:
    """Springs that deploy the array within three seconds."""
    return simulate_deployment({"spring_stiffness": 2.0}, **request.param, duration=5.0)


def test_arrays_have_the_documented_shapes(run: Trajectory) -> None:
    by_joint = (SAMPLES, JOINTS)
    assert run.time.shape == (SAMPLES,)
    # Three bodies of two points, or of three coordinates, with the amplitudes of modes and pseudo-modes of two panels.
    coordinates = 12 if run.metadata["model"].startswith("rigid") else 9 + 2 * (4 + 8 + 2 + 4)
    assert run.coordinates.shape == run.velocities.shape == (SAMPLES, coordinates)
    for name in ("penetration", "sliding_work", *(law.name for law in TORQUES)):
        assert getattr(run, name).shape == by_joint, name
    assert run.eccentricity.shape == run.joint_force.shape == (*by_joint, 2)
    assert run.wear_journal.shape == run.wear_bearing.shape == (JOINTS, BINS)


def test_a_sample_is_consistent_in_itself(run: Trajectory) -> None:
    assert run.penetration == pytest.approx(np.hypot(*np.moveaxis(run.eccentricity, 2, 0)) - run.clearance, abs=1e-15)
    force = np.hypot(run.normal_force, run.tangential_force)
    assert np.hypot(*np.moveaxis(run.joint_force, 2, 0)) == pytest.approx(force, rel=1e-12, abs=1e-12)
    assert np.all(run.normal_force[run.penetration < 0.0] == 0.0)
    assert run.normal_force.max() > 0.0
    # Friction stays inside its cone.
    assert np.all(np.abs(run.tangential_force) <= 0.15 * run.normal_force * (1 + 1e-12))
    assert run.spring_torque == pytest.approx(
        np.array([0.1, 0.075]) * (np.array([math.pi / 2, math.pi]) - run.angles), abs=1e-12
    )


def test_the_energies_are_the_documented_ones_and_sum_up(run: Trajectory) -> None:
    stored = set(ENERGY_NAMES)
    put_in = {"motor_work", "cable_work", "external_work"}
    lost = {"contact_dissipation", "friction_dissipation", "latch_dissipation", "material_dissipation"}
    lost |= {"damper_dissipation", "hinge_friction_dissipation"}
    assert set(run.energies) == stored | put_in | lost | {"residual"}
    kept = np.sum([run.energies[name] for name in stored | lost], axis=0)
    total = kept - np.sum([run.energies[name] for name in put_in], axis=0)
    assert run.energies["residual"] == pytest.approx(total - total[0], abs=1e-14)
    assert run.energy_residual == np.abs(run.energies["residual"]).max()
    assert run.energy_put_in == pytest.approx(0.5 * 0.1 * (math.pi / 2) ** 2 + 0.5 * 0.075 * math.pi**2, rel=1e-12)


def test_angles_go_on_through_full_turns() -> None:
    run = simulate(rotor(1e3), 20.0, integrator=GeneralizedAlpha(step=1e-2))
    assert np.ptp(run.angles) == 0.0
    spinning = simulate(block((0.0, 0.0), spin=10.0), 3.0)
    assert spinning.angles[-1, 0] == pytest.approx(30.0, rel=1e-6)


def test_each_figure_of_the_summary_is_the_one_that_its_name_says(run: Trajectory) -> None:
    """Of a trajectory in which no two figures are alike."""
    pairs = {name: np.array([k + 0.25, k + 0.5]) for k, name in enumerate(PLAIN_LISTS.values(), start=1)}
    counts = {name: k for k, name in enumerate(COUNTED, start=100)}
    figures: dict[str, Any] = {**pairs, "metadata": {**run.metadata, **counts}}
    summary = replace(run, **figures).summary()
    for name, attribute in PLAIN_LISTS.items():
        assert summary.pop(name) == pairs[attribute].tolist(), name
    for name, count in counts.items():
        assert summary.pop(name) == count, name
    assert summary == {
        **{name: run.metadata.get(name) for name in ("model", "integrator")},
        "status": "completed",
        "duration_s": run.time[-1],
        "sliding_work_J": run.sliding_work[-1].tolist(),
        "wear_depth_max_m": np.maximum(run.wear_journal, run.wear_bearing).max(axis=1).tolist(),
        "theta_end_rad": run.angles[-1].tolist(),
        "energy_residual_J": np.abs(run.energies["residual"]).max(),
        "energy_put_in_J": run.energy_put_in,
        "cable_work_J": float(run.energies["cable_work"][-1]) or None,
    }


def test_what_counts_as_after_the_latching_begins_with_the_first_latching(latched: Trajectory) -> None:
    first = np.nanmin(latched.latch_times)
    before, after = (np.searchsorted(latched.time, first) + step for step in (-1, 0))
    assert 0 < before < after < len(latched.time) - 100
    for total, so_far in (
        (latched.postlock_impulse, latched.impulse),
        (latched.postlock_sliding_work, latched.sliding_work),
    ):
        assert np.all(so_far[-1] - so_far[after] <= total)
        assert np.all(total <= so_far[-1] - so_far[before])
        assert np.all(total < 0.98 * so_far[-1])
    for joint in range(JOINTS):
        own = latched.contacts[latched.contacts["joint"] == joint]
        later, there = own[own["start_s"] > first], own[~(own["end_s"] < first)]
        assert later["peak_force"].max() <= latched.postlock_peak_force[joint] <= there["peak_force"].max()


def test_the_summary_is_strict_json_with_null_for_what_did_not_happen(run: Trajectory) -> None:
    text = json.dumps(run.summary(), allow_nan=False)
    assert json.loads(text) == run.summary()
    assert run.summary()["latch_times_s"] == [None, None]
    # Before any latching there are no figures of the time after it.
    for figure in (run.postlock_peak_force, run.postlock_impulse, run.postlock_sliding_work):
        assert not figure.any()


def test_metadata_say_what_was_run_and_how(run: Trajectory) -> None:
    default = default_integrator(run.metadata["model"])
    assert run.metadata["integrator"] == default.name
    assert run.metadata["parameters"]["clearance"] == 2e-4
    assert run.metadata["steps"] > 0 < run.metadata["wall_time_s"]
    assert run.metadata["integrator_settings"]["rtol"] == default.rtol
    json.dumps(run.metadata, allow_nan=False)
