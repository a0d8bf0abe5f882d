"""The mechanism of an array: its geometry, folded and straight, its parts, and deflections of its panels."""

from __future__ import annotations

import math

import numpy as np
import pytest
from deployments import LEVELS

from solar_env.array import ArrayParameters, build, main_body_corners
from solar_env.array.deployment import panel_deflections, simulate
from solar_env.array.methods import default_integrator
from solar_env.mechanics.analysis.geometry import centreline
from solar_env.mechanics.arrays.columns import ANGLE, ECCENTRICITY_X, ECCENTRICITY_Y
from solar_env.mechanics.bodies.kinds import CABLE_ELEMENTS
from solar_env.mechanics.equations.build import compile_mechanism
from solar_env.mechanics.mechanism.description import FlexibleBody, ModalPanel
from solar_env.mechanics.running.simulation import Simulation


def folded(p: ArrayParameters, level: str) -> Simulation:
    """The array of a level, before it moves."""
    return Simulation(build(p, level), default_integrator(level))


def joint_points(simulation: Simulation) -> tuple[np.ndarray, np.ndarray]:
    """(joints, 2) inner ends of the panels, where their journals are, and these from the centres of their bearings."""
    model, q = simulation.model, simulation.state.q
    journals = np.array([centreline(model, q, body)[0] for body in range(1, len(model.bodies))])
    return journals, simulation.joint_loads()[:, [ECCENTRICITY_X, ECCENTRICITY_Y]]


@pytest.mark.parametrize("level", LEVELS)
@pytest.mark.parametrize("panels", [1, 4])
@pytest.mark.parametrize("hinge", [(0.5, 0.0), (0.5, -0.5), (1e-9, 0.2), (0.0, 0.3)])
def test_the_folded_array_lies_in_a_stack_along_the_side_of_the_body(
    panels: int, level: str, hinge: tuple[float, float]
) -> None:
    p = ArrayParameters(panel_count=panels, hinge_x=hinge[0], hinge_y=hinge[1])
    simulation = folded(p, level)
    journals, eccentricities = joint_points(simulation)
    assert eccentricities == pytest.approx(0.0, abs=1e-14)
    # Accordion: the hinges alternate between the root and one panel's length below it.
    expected = [[hinge[0], hinge[1] - (k % 2) * p.panel_length] for k in range(panels)]
    assert journals == pytest.approx(np.array(expected), abs=1e-14)
    assert simulation.joint_loads()[:, ANGLE] == pytest.approx(0.0, abs=1e-14)
    assert not simulation.state.v.any()


@pytest.mark.parametrize("panels", [1, 4])
@pytest.mark.parametrize("level", LEVELS)
def test_at_its_lock_angles_the_array_is_straight_and_stands_off_the_body(panels: int, level: str) -> None:
    p = ArrayParameters(panel_count=panels, body_fixed=True)
    simulation = folded(p, level)
    # Set the coordinates of the deployed array by hand: every panel along +x from the hinge.
    for k, body in enumerate(simulation.model.bodies[1:]):
        start = 0.5 + k * p.panel_length
        q = simulation.state.q[body["offset"] :]
        if level.endswith("modes"):
            q[:3] = start + 0.5 * p.panel_length, 0.0, 0.0
            continue
        q = q[: body["coordinates"]]
        if body["kind"] == CABLE_ELEMENTS:
            stations = np.linspace(0.0, p.panel_length, body["elements"] + 1)
            q[:] = np.column_stack([start + stations, 0.0 * stations, stations**0, 0.0 * stations]).ravel()
        else:
            q[:] = start, 0.0, start + p.panel_length, 0.0
    _, eccentricities = joint_points(simulation)
    assert eccentricities == pytest.approx(0.0, abs=1e-14)
    locks = [joint.lock_angle for joint in p.joints]
    assert simulation.joint_loads()[:, ANGLE] == pytest.approx(locks, abs=1e-14)
    assert locks == [math.pi / 2] + [math.pi] * (panels - 1)
    assert [joint.lock_angle for joint in build(p, level).joints] == locks


@pytest.mark.parametrize("panels", [1, 2, 3, 4])
def test_cable_loops_join_neighbours_in_the_ratio_of_their_lock_angles(panels: int) -> None:
    cables = build(ArrayParameters(panel_count=panels)).cables
    assert [(c.joint_a, c.joint_b) for c in cables] == [(f"joint {k}", f"joint {k + 1}") for k in range(1, panels)]
    assert [c.wheel_ratio for c in cables] == [2.0, 1.0, 1.0][: panels - 1]
    assert [c.torque_ratio for c in cables] == [c.wheel_ratio for c in cables]
    couples = build(ArrayParameters(panel_count=panels, cable_torque_ratio=1.0)).cables
    assert [c.torque_ratio for c in couples] == [1.0] * (panels - 1)
    p = ArrayParameters(panel_count=panels)
    assert p.for_each_joint("spring_preload_angle") == tuple(joint.lock_angle for joint in p.joints)


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


@pytest.mark.parametrize("unit", ["elements", "modes"])
def test_flexible_panels_have_the_mass_of_rigid_ones_and_the_stiffness_of_their_section(unit: str) -> None:
    p = ArrayParameters(panel_width=1.2, panel_thickness=0.03, panel_damping=2e-5)
    for panel in build(p, f"flexible-ideal:3 {unit}").bodies[1:]:
        assert isinstance(panel, FlexibleBody | ModalPanel)
        assert (panel.length, getattr(panel, unit), panel.damping) == (1.5, 3, 2e-5)
        mass = panel.mass if isinstance(panel, ModalPanel) else panel.linear_density * panel.length
        assert mass == pytest.approx(200.0 * 1.5 * 1.2 * 0.03, rel=1e-14)
        assert panel.axial_stiffness == pytest.approx(280e6 * 1.2 * 0.03, rel=1e-14)
        assert panel.bending_stiffness == pytest.approx(280e6 * 1.2 * 0.03**3 / 12.0, rel=1e-14)


@pytest.mark.parametrize("elements", [1, 2, 5])
def test_deflections_are_those_of_the_panels_middles_from_their_chords(elements: int) -> None:
    level = f"flexible-ideal:{elements} elements"
    run = simulate(model=level, duration=0.02)
    model, _ = compile_mechanism(build(ArrayParameters(), level))
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
    rigid = simulate(duration=0.05)
    assert np.array_equal(panel_deflections(rigid), np.zeros((len(rigid.time), 2)))


@pytest.mark.parametrize("hinge", [(0.5, 0.0), (1e-9, 0.2), (0.0, 0.3)])
def test_the_corners_of_the_main_body_surround_its_centroid(hinge: tuple[float, float]) -> None:
    p = ArrayParameters(hinge_x=hinge[0], hinge_y=hinge[1])
    base = Simulation(build(p)).state.q[:4].reshape(2, 2)
    expected = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]
    assert main_body_corners(p, base) == pytest.approx(np.array(expected), abs=1e-14)
