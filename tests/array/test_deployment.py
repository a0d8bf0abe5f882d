"""Deployments of an array: integrators by name, durations, initial rates."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from deployments import NATURAL_LEVELS

from solar_env.array import MODELS, ArrayParameters, build
from solar_env.array.deployment import hub_turn, panel_deflections, simulate
from solar_env.array.methods import INTEGRATOR_NAMES, default_integrator, make_integrator
from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.arrays.columns import RATE
from solar_env.mechanics.bodies.markers import place
from solar_env.mechanics.integrators.settings import GeneralizedAlpha, ModalRadau, Rosenbrock, RungeKutta
from solar_env.mechanics.running.simulation import Simulation
from solar_env.mechanics.running.trajectory import Trajectory

FIXED = ("generalized-alpha", "paper")


@pytest.mark.parametrize("model", ["flexible-ideal:3 modes", "flexible-clearance:3 modes"])
def test_a_deployment_with_modal_panels_is_saved_and_measured_as_others(model: str, tmp_path: Path) -> None:
    run = simulate(model=model, duration=0.5)
    run.save(tmp_path / "run.npz")
    loaded = Trajectory.load(tmp_path / "run.npz")
    for told in (loaded.metadata, loaded.summary()):
        assert (told["model"], told["integrator"]) == (model, "modal-radau")
    assert np.array_equal(panel_deflections(loaded), panel_deflections(run))
    assert 1e-6 < np.abs(panel_deflections(run)).max() < 1e-2
    assert run.energy_residual < 1e-4 * run.energy_put_in


@pytest.mark.parametrize("level", NATURAL_LEVELS)
@pytest.mark.parametrize("name", INTEGRATOR_NAMES)
def test_integrators_by_name(name: str, level: str) -> None:
    default, flexible = default_integrator(level), level.startswith("flexible")
    modal = ModalRadau()
    model = level.replace("elements", "modes") if name == "modal-radau" else level
    if flexible:
        assert default_integrator(level.replace("elements", "modes")) == modal
        explicit, implicit = RungeKutta(rtol=1e-5), default
    else:
        explicit, implicit = default, Rosenbrock(rtol=default.rtol)
    expected, stepped = {
        "runge-kutta": (explicit, replace(explicit, max_step=1e-3)),
        "rosenbrock": (implicit, replace(implicit, max_step=1e-3)),
        "modal-radau": (modal, replace(modal, max_step=1e-3)),
        "generalized-alpha": (GeneralizedAlpha(), GeneralizedAlpha(step=1e-3)),
        "paper": (GeneralizedAlpha(rho_inf=1.0, step=1e-4), GeneralizedAlpha(rho_inf=1.0, step=1e-3)),
    }[name]
    assert make_integrator(name, model) == expected
    assert make_integrator(name, model, step=1e-3) == stepped
    if name in FIXED:
        with pytest.raises(ValueError, match="rtol = 1e-05 does not apply to 'generalized-alpha'"):
            make_integrator(name, model, rtol=1e-5)
    else:
        assert make_integrator(name, model, rtol=1e-5) == replace(expected, rtol=1e-5)


@pytest.mark.filterwarnings("ignore:.*the constraint forces of the integrator are off")
@pytest.mark.parametrize("name", [*INTEGRATOR_NAMES, None])
def test_a_deployment_takes_a_method_by_name_and_a_tolerance(name: str | None) -> None:
    tolerance = None if name in FIXED else 1e-5
    settings = make_integrator(name, "rigid-clearance", rtol=tolerance)
    named, given = (
        simulate(duration=0.02, **asked)
        for asked in ({"integrator": name, "rtol": tolerance}, {"integrator": settings})
    )
    kept = named.metadata["integrator_settings"]
    assert kept == given.metadata["integrator_settings"]
    assert kept.get("rtol") == tolerance
    assert named.coordinates.tobytes() == given.coordinates.tobytes()


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ({"parameters": "rigid-ideal"}, "parameter: 'rigid-ideal' must be a mapping of names to values"),
        ({"integrator": "euler"}, "integrator 'euler' is unknown; choose from runge-kutta"),
        ({"integrator": 45}, "integrator 45 is unknown; choose from runge-kutta, "),
        ({"integrator": RungeKutta}, "RungeKutta'> is unknown; choose from runge-kutta, "),
        ({"integrator": RungeKutta(), "rtol": 1e-5}, "rtol = 1e-05 beside integrator = RungeKutta("),
        ({"integrator": "paper", "rtol": 1e-5}, "rtol = 1e-05 does not apply to 'generalized-alpha'"),
        ({"rtol": 0.0}, "rtol = 0.0 must lie between 1e-13 and 0.1"),
        ({"duration": math.nan}, "duration = nan s"),
        ({"duration": 0.0}, "duration = 0.0 s"),
    ],
)
def test_what_a_deployment_cannot_take_is_refused_with_a_remedy(asked: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=re.escape(message)):
        simulate(**{"duration": 0.01, **asked})


def test_a_deployment_takes_parameters_or_changes_and_keeps_them() -> None:
    changed, given = (simulate(p, duration=0.1) for p in ({"clearance": 3e-4}, ArrayParameters(clearance=3e-4)))
    assert changed.coordinates.tobytes() == given.coordinates.tobytes()
    assert changed.metadata["parameters"] == ArrayParameters(clearance=3e-4).to_dict()
    assert changed.clearance.tolist() == [3e-4, 3e-4]
    assert changed.metadata["model"] == "rigid-clearance"
    paper = simulate({"friction_coefficient": 0.1}, preset="paper", duration=0.01).metadata["parameters"]
    assert paper == replace(ArrayParameters.preset("paper"), friction_coefficient=0.1).to_dict()


@pytest.mark.parametrize("model", ["flexible-ideal:3 elements", "flexible-clearance:3 elements"])
def test_a_flexible_deployment_has_the_coordinates_of_its_nodes_and_repeats_to_the_bit(model: str) -> None:
    first, second = (simulate(model=model, duration=0.3) for _ in range(2))
    assert first.coordinates.shape == (31, 4 + 2 * 16)
    assert first.coordinates.tobytes() == second.coordinates.tobytes()
    assert first.energies["elastic"].max() > 0.0
    assert first.energy_residual < 1e-4 * first.energy_put_in


@pytest.mark.parametrize("hinge", [(0.5, -0.5), (0.0, 0.3)])
@pytest.mark.parametrize("model", NATURAL_LEVELS)
def test_initial_rates_are_those_asked_for_and_strain_nothing(model: str, hinge: tuple[float, float]) -> None:
    """Joint rates and spin as given; the hinges' two sides move alike, and panels turn as rigid bodies."""
    rates, spin = (0.02, -0.03, 0.01), 0.04
    p = ArrayParameters(panel_count=3, initial_rate=rates, initial_spin=spin, hinge_x=hinge[0], hinge_y=hinge[1])
    simulation = Simulation(build(p, model))
    loads, state, compiled = simulation.joint_loads(), simulation.state, simulation.model
    assert loads[:, RATE] == pytest.approx(rates, abs=1e-14)
    for joint in compiled.joints:
        sides = [place(compiled.markers[joint[side]], state.v) for side in ("inboard", "outboard")]
        assert sides[0] == pytest.approx(sides[1], abs=1e-15)
    # Main body: at rest at its centroid; panels: every point turns about the hinge.
    velocity, turn, expected = np.zeros(2), spin, []
    arm = np.array(hinge)
    for k in range(3):
        velocity = velocity + turn * np.array([-arm[1], arm[0]])
        turn += (-1) ** k * rates[k]
        arm = np.array([0.0, -((-1) ** k) * p.panel_length])
        middle = velocity + turn * 0.5 * np.array([-arm[1], arm[0]])
        mass = p.panel_density * p.panel_length * p.panel_width * p.panel_thickness
        inertia = mass * p.panel_length**2 / 12.0
        if model.startswith("rigid"):
            inertia += mass * p.panel_thickness**2 / 12.0
        expected.append(0.5 * mass * middle @ middle + 0.5 * inertia * turn**2)
    energies = dict(zip(m.ENERGY_NAMES, simulation.stored_energies(), strict=True))
    assert energies["kinetic"] == pytest.approx(0.5 * p.body_inertia * spin**2 + sum(expected), rel=1e-12)
    assert energies["elastic"] == pytest.approx(0.0, abs=1e-20)


FAST = {"spring_stiffness": (2.5, 1.875), "cable_preload_force": 1250.0}


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("gap", [0.0, 1e-9])
def test_a_latch_without_free_play_holds_its_joint(model: str, gap: float) -> None:
    motion = simulate({**FAST, "latch_gap": gap}, model=model, duration=4.0)
    assert motion.latch_times.max() < 3.0
    late = motion.time > motion.latch_times.max()
    beyond = motion.angles[late] - [math.pi / 2, math.pi]
    # No deeper in a latch of 1000 N m/rad than the energy allows, and to both sides of the lock angle.
    assert 0.5 * 1e3 * np.abs(beyond).max() ** 2 < motion.energy_put_in
    assert beyond.min(axis=0).max() < 0.0 < beyond.max(axis=0).min()
    assert motion.energy_residual < 1e-3 * motion.energy_put_in


@pytest.mark.parametrize(("model", "rtol"), [("rigid-clearance", None), ("flexible-clearance:8 modes", 1e-5)])
def test_strands_that_pull_on_the_bearings_close_the_book(model: str, rtol: float | None) -> None:
    pulling = {"cable_bearing_forces": True, "cable_preload_force": 10.0}
    motion = simulate(pulling, model=model, duration=2.0, rtol=rtol)
    assert motion.energy_residual < 1e-5 * motion.energy_put_in
    # Journals on their walls ease strands of 4000 N/m by twice the clearance.
    pull = 2.0 * (10.0 - 4000.0 * 2.0 * 2e-4)
    assert np.median(motion.normal_force[motion.time > 1.0], axis=0) == pytest.approx([pull, pull], rel=0.01)


def test_angles_and_the_rates_of_latches_do_not_hang_on_the_samples_nor_on_which_joint_is_first() -> None:
    changes = {"wings": 2, "spring_preload_angle": (2.0, 3.5)}
    fine, coarse = (simulate(changes, model="rigid-ideal", duration=15.0, output_step=step) for step in (0.01, 15.0))
    assert np.array_equal(fine.angles[-1], coarse.angles[-1]), "opened by more than pi between two samples"
    for run in (fine, coarse):
        assert run.latch_times[:2] == pytest.approx(run.latch_times[2:], rel=1e-12)
        assert run.latch_rates[:2] == pytest.approx(run.latch_rates[2:], rel=1e-9)


def test_a_tabulated_spring_puts_in_what_it_gives() -> None:
    torque = {"spring_stiffness": 0.0, "spring_torque": ((0.0, 0.1), (3.2, 0.1)), "cable_stiffness": 0.0}
    run = simulate(torque, model="rigid-ideal", duration=20.0)
    assert run.energy_put_in == pytest.approx(0.1 * run.angles.sum(axis=1).max(), rel=1e-9)


def test_the_hub_turns_as_its_momentum_has_it() -> None:
    """Of a hub so heavy that the panel turns alone: the hub's momentum is the panel's about the common centre."""
    run = simulate({"panel_count": 1, "body_inertia": 250.0, "hinge_x": 0.0}, model="rigid-ideal", duration=2.0)
    turn = hub_turn(run)
    assert turn[0] == 0.0
    assert turn[-1] < 0.0, "against the opening panel"
    assert abs(turn[-1]) == pytest.approx(4.5 / 254.5 * run.angles[-1, 0], rel=0.02)
    assert not hub_turn(simulate({"body_fixed": True}, model="rigid-ideal", duration=1.0)).any()
