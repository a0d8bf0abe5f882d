"""The array: its parameters and what is refused, presets, geometry, and the integrators by name."""

from __future__ import annotations

import json
import math
import re
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from solar_env.array import (
    DEFAULT_ELEMENTS,
    MODELS,
    PRESETS,
    ArrayParameters,
    PanelModel,
    build,
    check_model,
    main_body_corners,
)
from solar_env.array.deployment import panel_deflections, simulate
from solar_env.array.methods import INTEGRATOR_NAMES, default_integrator, make_integrator
from solar_env.mechanics.analysis.geometry import centreline
from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.bodies.kinds import CABLE_ELEMENTS
from solar_env.mechanics.bodies.markers import place
from solar_env.mechanics.bodies.markers import velocity as marker_velocity
from solar_env.mechanics.equations.build import compile_mechanism
from solar_env.mechanics.integrators.settings import DormandPrince, GeneralizedAlpha, ModalRadau, Rosenbrock, RungeKutta
from solar_env.mechanics.joints.friction.ramp import RampedCoulomb
from solar_env.mechanics.joints.joint import ANGLE, RATE
from solar_env.mechanics.mechanism.description import FlexibleBody
from solar_env.mechanics.running.simulation import Simulation
from solar_env.mechanics.running.trajectory import Trajectory

NUMBERS = [f.name for f in fields(ArrayParameters) if not isinstance(f.default, (str, bool))]
PER_JOINT = ("spring_stiffness", "spring_preload_angle", "clearance", "initial_rate")


def refused(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=re.escape(message)):
        ArrayParameters().with_changes(changes)


def test_the_defaults_are_the_papers_table() -> None:
    p = ArrayParameters()
    assert (p.body_mass, p.body_inertia) == (1500.0, 250.0)
    assert p.panel_density * p.panel_length * p.panel_width * p.panel_thickness == pytest.approx(6.0, rel=1e-14)
    assert (p.spring_stiffness, p.spring_preload_angle) == ((0.1, 0.075), (math.pi / 2, math.pi))
    assert (p.restitution, p.contact_stiffness, p.friction_coefficient) == (0.9, 7.39e10, 0.15)
    assert (p.journal_radius, p.clearance) == (0.01, 2e-4)


def test_every_parameter_is_documented() -> None:
    for item in fields(ArrayParameters):
        assert re.search(rf"\b{item.name}\b", ArrayParameters.__doc__ or ""), item.name


@pytest.mark.parametrize("name", NUMBERS)
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, "1", [], [[1.0]], True])
def test_what_is_not_a_finite_number_is_refused_by_name(name: str, value: Any) -> None:
    with pytest.raises(ValueError, match=f"^{name} = "):
        ArrayParameters().with_changes({name: value})


@pytest.mark.parametrize(
    "name",
    [
        "body_mass",
        "body_inertia",
        "body_size",
        "panel_length",
        "panel_width",
        "panel_thickness",
        "panel_density",
        "panel_young",
        "cable_wheel_radius",
        "journal_radius",
        "bearing_width",
        "clearance",
        "contact_stiffness",
        "panel_count",
        "wear_bins",
        "restitution",
        "minimum_impact_speed",
        "journal_young",
        "bearing_young",
        "latch_stiffness",
        "latch_ramp_depth",
    ],
)
@pytest.mark.parametrize("value", [0, -1])
def test_what_must_be_positive_is_refused_otherwise_by_name_and_value(name: str, value: Any) -> None:
    whole = isinstance(getattr(ArrayParameters(), name), int)
    number = value if whole else float(value)
    with pytest.raises(ValueError, match=re.escape(f"{name} = {number!r} must")):
        ArrayParameters().with_changes({name: number})


@pytest.mark.parametrize(
    "name",
    [
        "panel_damping",
        "cable_stiffness",
        "cable_preload_force",
        "cable_torque_ratio",
        "friction_coefficient",
        "wear_coefficient",
        "spring_stiffness",
        "hinge_x",
        "friction_speed_zero",
        "latch_gap",
        "latch_damping",
    ],
)
def test_what_must_not_be_negative_is_refused_if_it_is_and_may_be_zero(name: str) -> None:
    with pytest.raises(ValueError, match=re.escape(f"{name} = -0.1 must not be negative")):
        ArrayParameters().with_changes({name: -0.1})
    assert getattr(ArrayParameters().with_changes({name: 0.0}), name) == 0.0


def test_other_values_without_sense_are_refused() -> None:
    refused({"panel_count": 101}, "panel_count = 101 must lie between 1 and 100")
    refused({"panel_count": 2.5}, "panel_count = 2.5 must be a whole number")
    refused({"wear_bins": 360.0}, "wear_bins = 360.0 must be a whole number")
    refused({"clearance": 0.0}, "clearance = 0.0 must be positive; for no clearance choose an ideal model")
    refused({"clearance": (1e-4, -1e-4)}, "clearance = (0.0001, -0.0001) must be positive")
    refused({"clearance": 0.02}, "clearance = 0.02 must be below journal_radius")
    refused({"restitution": 1.1}, "restitution = 1.1 must lie in (0, 1]")
    refused({"contact_law": "dubowsky"}, "contact law 'dubowsky' is unknown")
    refused({"contact_law": 3}, "contact_law = 3 must be of type str")
    refused({"friction_sliding": "paper"}, "friction_sliding = 'paper' must be material or centres")
    refused({"friction_law": "stribeck"}, "friction_law = 'stribeck' must be one of ramp, brown-mcphee")
    refused({"static_friction_ratio": 0.9}, "static_friction_ratio = 0.9 must be at least 1")
    refused({"static_friction_ratio": 1.5}, "static_friction_ratio = 1.5 must be 1 with friction_law = 'ramp'")
    refused({"body_fixed": 1}, "body_fixed = 1 must be of type bool")
    refused({"latch_exponent": 0.5}, "latch_exponent = 0.5 must be at least 1")
    for name in ("journal_poisson", "bearing_poisson"):
        for value in (-1.0, 0.51):
            refused({name: value}, f"{name} = {value} must lie in (-1, 0.5]")
    refused({"wear_bins": 100_001}, "wear_bins = 100001 must lie between 1 and 100000")
    refused({"friction_speed_zero": 1e-2}, "friction_speed_zero = 0.01 must be below friction_speed_full = 0.001")
    refused({"body_mass": None}, "body_mass = None must be a finite number")


def test_an_unknown_name_is_refused_with_the_one_that_was_meant() -> None:
    refused({"clearence": 1e-4}, "parameter 'clearence' is unknown; did you mean 'clearance'?")
    refused({"xyzzy": 1.0}, "parameter 'xyzzy' is unknown; choose from panel_count, body_mass")


@pytest.mark.parametrize("name", [n for n in NUMBERS if n not in PER_JOINT])
def test_only_quantities_by_joint_take_several_entries(name: str) -> None:
    refused({name: (1.0, 1.0)}, f"{name} = (1.0, 1.0) must be a single number")


@pytest.mark.parametrize("name", PER_JOINT)
def test_the_last_entry_of_a_quantity_by_joint_holds_for_all_further_joints(name: str) -> None:
    p = ArrayParameters(panel_count=4).with_changes({name: [0.001, 0.002]})
    assert [p.by_joint(name, j) for j in range(4)] == [0.001, 0.002, 0.002, 0.002]
    assert [ArrayParameters().with_changes({name: 0.003}).by_joint(name, j) for j in range(2)] == [0.003] * 2
    refused({name: (0.001, 0.002, 0.003)}, f"{name} = (0.001, 0.002, 0.003) has more entries than panels (2)")


def test_the_default_entries_by_joint_also_serve_a_single_panel() -> None:
    assert ArrayParameters(panel_count=1).by_joint("spring_stiffness", 0) == 0.1


def test_changes_leave_the_original_alone_and_may_be_lists() -> None:
    p = ArrayParameters()
    changed = p.with_changes({"clearance": [1e-4, 3e-4], "body_mass": 10.0})
    assert (changed.clearance, changed.body_mass) == ((1e-4, 3e-4), 10.0)
    assert p == ArrayParameters()


def test_parameters_survive_json() -> None:
    p = ArrayParameters(panel_count=3, clearance=(1e-4, 2e-4, 3e-4), contact_stiffness=None)
    assert ArrayParameters().with_changes(json.loads(json.dumps(p.to_dict()))) == p


@pytest.mark.parametrize(
    ("name", "given", "kept"),
    [
        ("clearance", np.array([1e-4, 2e-4]), (1e-4, 2e-4)),
        ("clearance", [np.float64(1e-4), 2e-4], (1e-4, 2e-4)),
        ("clearance", np.array(1e-4), 1e-4),
        ("initial_rate", np.array([0, 1]), (0, 1)),
        ("body_mass", np.float32(900.5), 900.5),
        ("body_mass", np.float64(900.5), 900.5),
        ("contact_stiffness", np.float32(2.0**36), 2.0**36),
        ("panel_count", np.int64(3), 3),
        ("wear_bins", np.int32(90), 90),
        ("body_fixed", np.bool_(True), True),
        ("contact_law", np.str_("flores"), "flores"),
    ],
)
def test_numpys_numbers_and_arrays_are_taken_as_pythons(name: str, given: Any, kept: Any) -> None:
    for p in (ArrayParameters(**{name: given}), ArrayParameters().with_changes({name: given})):
        value = getattr(p, name)
        assert value == kept
        assert type(value) is type(kept)
        if isinstance(kept, tuple):
            assert [type(entry) for entry in value] == [type(entry) for entry in kept]
        assert ArrayParameters().with_changes(json.loads(json.dumps(p.to_dict()))) == p
        assert hash(p) == hash(ArrayParameters(**{name: kept}))


def test_the_papers_preset_differs_in_these_four_parameters_alone() -> None:
    assert ArrayParameters.preset("paper") == ArrayParameters(
        hinge_y=-0.5, cable_torque_ratio=1.0, friction_sliding="centres", panel_damping=0.0
    )


def test_presets() -> None:
    assert ArrayParameters.preset("default") == ArrayParameters()
    paper = ArrayParameters.preset("paper")
    assert (paper.hinge_x, paper.hinge_y) == (0.5, -0.5)
    assert paper.cable_torque_ratio == 1.0
    assert paper.friction_sliding == "centres"
    for name in PRESETS:
        assert ArrayParameters.preset(name).with_changes({}) == ArrayParameters.preset(name)
    with pytest.raises(ValueError, match="preset 'papper' is unknown; did you mean 'paper'"):
        ArrayParameters.preset("papper")


def test_an_unknown_model_is_refused_with_the_choices() -> None:
    for call in (check_model, lambda model: build(ArrayParameters(), model), lambda model: simulate(model=model)):
        with pytest.raises(ValueError, match="model 'rigid' is unknown; choose from rigid-ideal, rigid-clearance"):
            call("rigid")


def test_the_contact_stiffness_is_given_or_follows_from_eq_40_by_joint() -> None:
    assert ArrayParameters().contact(1).stiffness == 7.39e10
    p = ArrayParameters(contact_stiffness=None, clearance=(2e-4, 1e-4))
    assert p.contact(0).stiffness == pytest.approx(7.43e10, abs=0.005e10)
    assert p.contact(1).stiffness > p.contact(0).stiffness == p.bearing(0).contact.stiffness


def test_a_bearing_takes_over_its_parameters() -> None:
    p = ArrayParameters(clearance=(1e-4, 3e-4), contact_law="flores", restitution=0.5, friction_sliding="centres")
    bearing = p.bearing(1)
    assert bearing.clearance == 3e-4
    assert bearing.contact.damping == pytest.approx(1.6, rel=1e-14)
    assert bearing.sliding == "centres"
    assert bearing.friction == RampedCoulomb(p.friction_speed_zero, p.friction_speed_full)


def joint_points(simulation: Simulation) -> tuple[np.ndarray, np.ndarray]:
    """(joints, 2) bearing centres and journal centres."""
    model, q = simulation.model, simulation.state.q
    found = [[place(model.markers[k], q) for k in model.joints[side]] for side in ("inboard", "outboard")]
    return np.array(found[0]), np.array(found[1])


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("panels", [1, 2, 3, 4])
@pytest.mark.parametrize("hinge", [(0.5, 0.0), (0.5, -0.5), (1e-9, 0.2), (0.0, 0.3)])
def test_the_folded_array_lies_in_a_stack_along_the_side_of_the_body(
    panels: int, model: str, hinge: tuple[float, float]
) -> None:
    p = ArrayParameters(panel_count=panels, hinge_x=hinge[0], hinge_y=hinge[1])
    simulation = Simulation(build(p, model))
    bearings, journals = joint_points(simulation)
    assert journals == pytest.approx(bearings, abs=1e-14)
    # Accordion: the hinges alternate between the root and one panel's length below it.
    expected = [[hinge[0], hinge[1] - (k % 2) * p.panel_length] for k in range(panels)]
    assert bearings == pytest.approx(np.array(expected), abs=1e-14)
    assert simulation.joint_loads()[:, ANGLE] == pytest.approx(0.0, abs=1e-14)
    assert not simulation.state.v.any()


@pytest.mark.parametrize("panels", [1, 2, 3, 4])
@pytest.mark.parametrize("model", MODELS)
def test_at_its_lock_angles_the_array_is_straight_and_stands_off_the_body(panels: int, model: str) -> None:
    p = ArrayParameters(panel_count=panels, body_fixed=True)
    mechanism = build(p, model)
    simulation = Simulation(mechanism)
    # Set the coordinates of the deployed array by hand: every panel along +x from the hinge.
    for k, body in enumerate(simulation.model.bodies[1:]):
        start = 0.5 + k * p.panel_length
        q = simulation.state.q[body["offset"] : body["offset"] + body["coordinates"]]
        if body["kind"] == CABLE_ELEMENTS:
            stations = np.linspace(0.0, p.panel_length, DEFAULT_ELEMENTS + 1)
            q[:] = np.column_stack([start + stations, 0.0 * stations, stations**0, 0.0 * stations]).ravel()
        else:
            q[:] = start, 0.0, start + p.panel_length, 0.0
    bearings, journals = joint_points(simulation)
    assert journals == pytest.approx(bearings, abs=1e-14)
    locks = [p.lock_angle(k) for k in range(panels)]
    assert simulation.joint_loads()[:, ANGLE] == pytest.approx(locks, abs=1e-14)
    assert locks == [math.pi / 2] + [math.pi] * (panels - 1)
    assert [joint.lock_angle for joint in mechanism.joints] == locks


def test_springs_relax_at_the_lock_angles_by_default() -> None:
    p = ArrayParameters(panel_count=4)
    assert [p.by_joint("spring_preload_angle", k) for k in range(4)] == [p.lock_angle(k) for k in range(4)]


@pytest.mark.parametrize("panels", [1, 2, 3, 4])
def test_cable_loops_join_neighbours_in_the_ratio_of_their_lock_angles(panels: int) -> None:
    cables = build(ArrayParameters(panel_count=panels)).cables
    assert [(c.joint_a, c.joint_b) for c in cables] == [(f"joint {k}", f"joint {k + 1}") for k in range(1, panels)]
    assert [c.wheel_ratio for c in cables] == [2.0, 1.0, 1.0][: panels - 1]
    assert [c.torque_ratio for c in cables] == [c.wheel_ratio for c in cables]
    couples = build(ArrayParameters(panel_count=panels, cable_torque_ratio=1.0)).cables
    assert [c.torque_ratio for c in couples] == [1.0] * (panels - 1)


def test_masses_and_centroids() -> None:
    mechanism = build(ArrayParameters(hinge_y=-0.3))
    body, panel = mechanism.bodies[:2]
    assert (body.mass, body.inertia) == (1500.0, 250.0)
    # The body's centroid is the origin.
    assert np.add(body.position, body.centroid) == pytest.approx([0.0, 0.0], abs=1e-15)
    assert panel.mass == pytest.approx(6.0, rel=1e-14)
    assert panel.inertia == pytest.approx(6.0 * 1.5**2 / 12.0, rel=1e-3)
    assert panel.centroid == (0.75, 0.0)


@pytest.mark.parametrize("panels", ["rigid", "flexible"])
def test_only_the_clearance_models_have_bearings(panels: str) -> None:
    p = ArrayParameters()
    assert all(joint.bearing is None for joint in build(p, f"{panels}-ideal").joints)
    assert [joint.bearing for joint in build(p, f"{panels}-clearance").joints] == [p.bearing(0), p.bearing(1)]


def test_flexible_panels_have_the_mass_of_rigid_ones_and_the_stiffness_of_their_section() -> None:
    p = ArrayParameters(panel_width=1.2, panel_thickness=0.03, panel_damping=2e-5)
    for panel in build(p, "flexible-ideal", 3).bodies[1:]:
        assert isinstance(panel, FlexibleBody)
        assert (panel.length, panel.elements, panel.damping) == (1.5, 3, 2e-5)
        assert panel.linear_density * panel.length == pytest.approx(200.0 * 1.5 * 1.2 * 0.03, rel=1e-14)
        assert panel.axial_stiffness == pytest.approx(280e6 * 1.2 * 0.03, rel=1e-14)
        assert panel.bending_stiffness == pytest.approx(280e6 * 1.2 * 0.03**3 / 12.0, rel=1e-14)


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("elements", [0, -1, 1001, 2.0, "6", True])
def test_a_refused_number_of_elements_is_named_whatever_the_model(model: str, elements: Any) -> None:
    calls = (
        lambda n: PanelModel("ancf", n),
        lambda n: build(ArrayParameters(), model, n),
        lambda n: simulate(model=model, elements=n),
    )
    for call in calls:
        with pytest.raises(ValueError, match=rf"elements = {re.escape(repr(elements))}: must"):
            call(elements)


@pytest.mark.parametrize(
    ("asked", "found"),
    [
        ({}, PanelModel("ancf", 6)),
        ({"panels": "modal"}, PanelModel("modal", 24)),
        ({"panels": "ancf"}, PanelModel("ancf", 6)),
        ({"elements": 3}, PanelModel("ancf", 3)),
        ({"modes": 8}, PanelModel("modal", 8)),
        ({"panels": PanelModel("modal", 5), "integrator": "modal-radau"}, PanelModel("modal", 5)),
        ({"panels": PanelModel("modal", 5), "modes": 3}, PanelModel("modal", 3)),
        ({"integrator": "modal-radau"}, PanelModel("modal", 24)),
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
    PanelModel.of("rigid-ideal", **{**asked, "integrator": "dop853"})


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
        ({"modes": 3, "integrator": "dop853"}, "integrator='dop853' belongs to panels of beam elements and modes=3"),
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


@pytest.mark.parametrize("model", ["flexible-ideal", "flexible-clearance"])
def test_a_deployment_with_modal_panels_is_saved_and_measured_as_others(model: str, tmp_path: Path) -> None:
    run = simulate(model=model, modes=3, duration=0.5)
    run.save(tmp_path / "run.npz")
    loaded = Trajectory.load(tmp_path / "run.npz")
    kept = [loaded.metadata[name] for name in ("panels", "modes", "integrator")]
    assert kept == ["modal", 3, "modal-radau"]
    assert loaded.summary()["modes"] == 3
    assert np.array_equal(panel_deflections(loaded), panel_deflections(run))
    assert 1e-6 < np.abs(panel_deflections(run)).max() < 1e-2
    assert run.energy_residual < 1e-4 * run.energy_put_in


@pytest.mark.parametrize("elements", [1, 7])
def test_elements_divide_flexible_panels_only(elements: int) -> None:
    for model in MODELS:
        bodies = compile_mechanism(build(ArrayParameters(), model, elements))[0].bodies
        assert bodies["elements"].tolist() == [0] + 2 * [elements if model.startswith("flexible") else 0]


@pytest.mark.parametrize("elements", [1, 2, 5])
def test_deflections_are_those_of_the_panels_middles_from_their_chords(elements: int) -> None:
    run = simulate(model="flexible-ideal", elements=elements, duration=0.02)
    model, _ = compile_mechanism(build(ArrayParameters(), "flexible-ideal", elements))
    # Parabolas over the chords, which cubics represent: the middle lies 1/4 of the end slopes' length off.
    stations = np.linspace(0.0, 1.5, elements + 1)
    angle = np.array([0.3, -1.2])
    for body, height in ((1, 0.01), (2, -0.03)):
        record = model.bodies[body]
        along, across = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
        shape, slope = (
            4.0 * height * stations / 1.5 * (1.0 - stations / 1.5),
            4.0 * height / 1.5 * (1.0 - 2.0 * stations / 1.5),
        )
        positions = stations[:, None] * along[:, 0] + shape[:, None] * across[:, 0] + 5.0
        slopes = along[:, 0] + slope[:, None] * across[:, 0]
        run.coordinates[:, record["offset"] : record["offset"] + record["coordinates"]] = np.hstack(
            [positions, slopes]
        ).ravel()
        middle = centreline(model, run.coordinates[0], body, 2)[elements]
        assert middle == pytest.approx(0.75 * along[:, 0] + height * across[:, 0] + 5.0, abs=1e-13)
    assert panel_deflections(run) == pytest.approx(np.tile([0.01, -0.03], (len(run.time), 1)), abs=1e-13)


def test_rigid_panels_do_not_deflect() -> None:
    run = simulate(duration=0.05)
    assert np.array_equal(panel_deflections(run), np.zeros((len(run.time), 2)))


@pytest.mark.parametrize("hinge", [(0.5, 0.0), (1e-9, 0.2), (0.0, 0.3)])
def test_the_corners_of_the_main_body_surround_its_centroid(hinge: tuple[float, float]) -> None:
    p = ArrayParameters(hinge_x=hinge[0], hinge_y=hinge[1])
    base = Simulation(build(p)).state.q[:4].reshape(2, 2)
    expected = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]
    assert main_body_corners(p, base) == pytest.approx(np.array(expected), abs=1e-14)


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("name", INTEGRATOR_NAMES)
def test_integrators_by_name(name: str, model: str) -> None:
    default = default_integrator(model)
    modal = ModalRadau(rtol=3e-4 if model.endswith("ideal") else 1e-2)
    assert default_integrator(model, PanelModel("modal", 2)) == (modal if model.startswith("flexible") else default)
    if model.startswith("flexible"):
        explicit, implicit = RungeKutta(rtol=1e-5), default
    else:
        explicit, implicit = default, Rosenbrock(rtol=default.rtol)
    expected, stepped = {
        "runge-kutta": (explicit, replace(explicit, max_step=1e-3)),
        "rosenbrock": (implicit, replace(implicit, max_step=1e-3)),
        "dop853": (DormandPrince(), DormandPrince(max_step=1e-3)),
        "modal-radau": (modal, replace(modal, max_step=1e-3)),
        "generalized-alpha": (GeneralizedAlpha(), GeneralizedAlpha(step=1e-3)),
        "paper": (GeneralizedAlpha(rho_inf=1.0, step=1e-4), GeneralizedAlpha(rho_inf=1.0, step=1e-3)),
    }[name]
    assert make_integrator(name, model) == expected
    assert make_integrator(name, model, step=1e-3) == stepped
    if name == "paper":
        with pytest.raises(ValueError, match="rtol does not apply to the integrator 'paper'"):
            make_integrator(name, model, rtol=1e-5)
    else:
        assert make_integrator(name, model, rtol=1e-5) == replace(expected, rtol=1e-5)


def test_an_unknown_integrator_is_refused_with_the_choices() -> None:
    choices = ", ".join(INTEGRATOR_NAMES)
    with pytest.raises(ValueError, match=f"integrator 'euler' is unknown; choose from {choices}"):
        make_integrator("euler", "rigid-ideal")


@pytest.mark.parametrize("name", INTEGRATOR_NAMES)
@pytest.mark.parametrize("step", [0.0, -1e-4, math.nan])
def test_an_absurd_step_is_refused_with_its_value(name: str, step: float) -> None:
    with pytest.raises(ValueError, match=f"step = {step!r}"):
        make_integrator(name, "rigid-clearance", step=step)


@pytest.mark.parametrize("duration", [0.0, -1.0, math.nan, math.inf])
def test_a_duration_without_sense_is_refused_with_its_value(duration: float) -> None:
    with pytest.raises(ValueError, match=f"duration = {duration!r} s"):
        simulate(duration=duration)


def test_a_deployment_takes_parameters_or_changes_and_keeps_them() -> None:
    changed, given = (simulate(p, duration=0.1) for p in ({"clearance": 3e-4}, ArrayParameters(clearance=3e-4)))
    assert changed.coordinates.tobytes() == given.coordinates.tobytes()
    assert changed.metadata["parameters"] == ArrayParameters(clearance=3e-4).to_dict()
    assert changed.clearance.tolist() == [3e-4, 3e-4]
    assert (changed.metadata["model"], changed.metadata["elements"]) == ("rigid-clearance", DEFAULT_ELEMENTS)


@pytest.mark.parametrize("model", ["flexible-ideal", "flexible-clearance"])
def test_a_flexible_deployment_has_the_coordinates_of_its_nodes_and_repeats_to_the_bit(model: str) -> None:
    first, second = (simulate(model=model, elements=3, duration=0.3) for _ in range(2))
    assert first.coordinates.shape == (31, 4 + 2 * 16)
    assert first.coordinates.tobytes() == second.coordinates.tobytes()
    assert first.metadata["elements"] == 3
    assert first.energies["elastic"].max() > 0.0
    assert first.energy_residual < 1e-4 * first.energy_put_in


@pytest.mark.parametrize("hinge", [(0.5, 0.0), (0.5, -0.5), (0.0, 0.3)])
@pytest.mark.parametrize("model", MODELS)
def test_initial_rates_are_those_asked_for_and_strain_nothing(model: str, hinge: tuple[float, float]) -> None:
    """Joint rates and spin as given; the hinges' two sides move alike, and panels turn as rigid bodies."""
    rates, spin = (0.02, -0.03, 0.01), 0.04
    p = ArrayParameters(panel_count=3, initial_rate=rates, initial_spin=spin, hinge_x=hinge[0], hinge_y=hinge[1])
    simulation = Simulation(build(p, model, 3))
    loads, state, compiled = simulation.joint_loads(), simulation.state, simulation.model
    assert loads[:, RATE] == pytest.approx(rates, abs=1e-14)
    for joint in compiled.joints:
        sides = [marker_velocity(compiled.markers[joint[side]], state.q, state.v) for side in ("inboard", "outboard")]
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


def test_a_body_that_is_held_cannot_turn() -> None:
    with pytest.raises(ValueError, match=r"initial_spin = 0\.1 needs a body that is not fixed"):
        ArrayParameters(body_fixed=True, initial_spin=0.1)
