"""Mechanisms of rigid bodies and modal panels in motion: against independent solutions, and their books."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from helpers import attempt, single_steps
from lagrangian import Lagrangian
from numpy.typing import NDArray

from solar_env.array import ArrayParameters, build
from solar_env.mechanics.arrays import columns
from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.equations.build import compile_mechanism
from solar_env.mechanics.integrators.settings import ModalRadau
from solar_env.mechanics.joints.laws import PowerLaw
from solar_env.mechanics.mechanism.description import (
    GROUND,
    Bearing,
    Body,
    CableLoop,
    FlexibleBody,
    Joint,
    Load,
    Mechanism,
    ModalPanel,
    Spring,
)
from solar_env.mechanics.modal.tables import level_size
from solar_env.mechanics.records.recording import make_recorder
from solar_env.mechanics.running.diagnosis import SimulationWarning
from solar_env.mechanics.running.simulation import Simulation

STIFFNESS = 1e6  # N/m^1.5
SOFT_BEARING = Bearing(clearance=0.01, journal_radius=0.1, contact=PowerLaw(STIFFNESS))
PANEL = ModalPanel("panel", 2.0, 3.0, axial_stiffness=2e4, bending_stiffness=300.0, modes=2)


def hanging_panel(**changes: object) -> Mechanism:
    """A panel on a spring, whose journal bounces on the wall of a soft bearing under its weight, and stays on it."""
    panel = replace(PANEL, angle=-1.2, **changes)  # type: ignore[arg-type]
    depth = 1.2 * (PANEL.mass * 9.81 / STIFFNESS) ** (2 / 3)
    panel = replace(panel, position=(0.0, -0.01 - depth))
    joint = Joint("hinge", GROUND, "panel", (0.0, 0.0), (0.0, 0.0), bearing=SOFT_BEARING, spring=Spring(20.0, -1.0))
    return Mechanism((panel,), (joint,), gravity=(0.0, -9.81))


def fixed_steps(level: int) -> ModalRadau:
    """Steps of a tabled size throughout."""
    return ModalRadau(rtol=0.1, velocity_scale=1.0, max_step=level_size(level))


def coordinates_after(mechanism: Mechanism, duration: float, integrator: ModalRadau) -> NDArray[np.float64]:
    simulation = Simulation(mechanism, integrator)
    simulation.advance(duration)
    return simulation.state.q.copy()


@pytest.mark.slow
def test_motion_converges_with_fifth_order_to_that_of_the_lagrangian_system() -> None:
    mechanism = hanging_panel(spin=0.5)
    simulation = Simulation(mechanism, ModalRadau())
    start, panels, duration = simulation.state, simulation.model.panels, 0.032
    reference, _ = Lagrangian(simulation.model).run(start.q, start.v, duration)
    errors = np.array(
        [np.abs(coordinates_after(mechanism, duration, fixed_steps(level)) - reference) for level in (8, 10, 12, 14)]
    )
    # The height, which bounces with the contact: a fifth order gains a factor of 32 with half the step, down to the
    # 3e-9 m that ringing pseudo-modes move it.
    assert errors[0, 1] > 25.0 * errors[1, 1]
    assert errors[2:, 1].max() < 5e-9
    # The stiffest pseudo-modes ring in the exact solution and are at rest in the method's.
    frequencies = np.concatenate([np.zeros(3), panels.frequency[0]])
    followed = frequencies * level_size(14) < 0.7
    assert followed.sum() > 12
    assert errors[-1, : frequencies.size][followed].max() < 3e-8


def belted_panels(loop: CableLoop) -> Mechanism:
    """A body and two panels apart from each other's bearings, which a spring, a cable loop and their motion bend."""
    wide = replace(SOFT_BEARING, clearance=1.0, journal_radius=3.0)
    panel = replace(PANEL, axial_stiffness=500.0, bending_stiffness=50.0, modes=0, spin=0.6, velocity=(0.1, 0.2))
    # The loop's carrier lies against its chord, and the other panel is bent by the spring.
    carrier = replace(panel, angle=2.9, position=(2.0, 0.1), spin=-0.4)
    other = replace(panel, name="other", position=(2.1, 0.0), angle=0.4)
    base = Body("base", 5.0, 2.0, 1.0, (0.3, 0.1), position=(-0.9, 0.0))
    joints = (
        Joint("inner", "base", "panel", (0.9, 0.0), (2.0, 0.0), folded_angle=math.pi, middle=0.2, bearing=wide),
        Joint("outer", "panel", "other", (0.0, 0.0), (0.0, 0.0), sign=-1, folded_angle=-math.pi, bearing=wide),
    )
    joints = (joints[0], replace(joints[1], spring=Spring(3.0, 0.4)))
    return Mechanism((base, carrier, other), joints, (loop,))


STIFF = CableLoop("inner", "outer", 400.0, 2.0, 2.0)
PULLING = replace(STIFF, stiffness=4.0, preload_torque=5.0, wheel_radius=0.1)
# The torque follows from iteration to iteration, or Newton's method solves for it; with pulls, both strands are taut or
# one is slack from a mismatch of 0.03 rad on.
LOOPS = [replace(STIFF, stiffness=4.0), STIFF, PULLING, replace(PULLING, preload_torque=0.06)]


@pytest.mark.parametrize("loop", LOOPS)
def test_belt_along_the_chord_moves_panels_as_the_lagrangian_system_has_it(loop: CableLoop) -> None:
    mechanism, duration = belted_panels(loop), 0.032
    simulation = Simulation(mechanism, ModalRadau())
    start, turns = simulation.state, simulation.model.bodies["offset"] + 2
    reference, _ = Lagrangian(simulation.model).run(start.q, start.v, duration, rtol=1e-7)
    found = coordinates_after(mechanism, duration, fixed_steps(12))
    moved = np.abs(reference - start.q - duration * start.v)[turns].min()
    assert found[turns] == pytest.approx(reference[turns], abs=1e-4 * moved)


@pytest.mark.filterwarnings("ignore:.*modal panels have bent by")  # momentum and energy hold beyond the range, too
@pytest.mark.parametrize("loop", LOOPS[1:])
@pytest.mark.parametrize("torque_ratio", [2.0, 1.0])
def test_belt_keeps_momentum_and_energy(torque_ratio: float, loop: CableLoop) -> None:
    mechanism = belted_panels(replace(loop, torque_ratio=torque_ratio))
    simulation = Simulation(mechanism, ModalRadau(rtol=1e-5))
    before = simulation.momenta()
    simulation.advance(0.3)
    residual, turnover = simulation.energy_book()
    assert abs(residual) < 1e-5 * turnover
    assert simulation.momenta() == pytest.approx(before, abs=1e-9)
    work = m.joint_integrals(simulation.state.integrals)[:, m.CABLE_WORK].sum()
    assert (work == 0.0) == (torque_ratio == 2.0)


@pytest.mark.parametrize("speed", [1e-3, 0.1])
def test_impact_gives_back_the_exit_speed_of_its_law_within_one_percent(speed: float) -> None:
    law = PowerLaw(7.39e10, damping=0.3)
    bearing = Bearing(clearance=2e-4, journal_radius=0.01, contact=law)
    body = Body("body", 5.0, 1.0, 1.0, (0.0, 0.0), velocity=(speed, 0.0))
    joint = Joint("hinge", GROUND, "body", (0.0, 0.0), (0.0, 0.0), bearing=bearing)
    simulation = Simulation(Mechanism((body,), (joint,)), ModalRadau(rtol=1e-2))
    simulation.advance(3e-4 / speed)
    assert simulation.state.joints[0]["contact_starts"] == 1
    assert not simulation.state.joints[0]["in_contact"]
    assert -simulation.state.v[0] / speed == pytest.approx(law.exit_speed_ratio(), rel=0.01)
    # The integral of the normal force is the change of momentum.
    impulse = m.joint_integrals(simulation.state.integrals)[0, m.IMPULSE]
    assert impulse == pytest.approx(5.0 * (speed - simulation.state.v[0]), rel=1e-3)


def test_contacts_begin_at_the_wall_however_little_of_the_vibration_a_step_sees() -> None:
    """Not a micrometre inside, where an impact of 1 mm/s would begin with a hundred newtons instead of none."""
    parameters = ArrayParameters()
    simulation = single_steps(build(parameters, "flexible-clearance:24 modes"), ModalRadau(rtol=1e-2))
    clearance, seen, depths, done = parameters.by_joint("clearance", 0), np.zeros(2, dtype=int), [], False
    while not done:
        done = attempt(simulation, 1.0)
        starts = simulation.state.joints["contact_starts"].copy()
        for j in np.flatnonzero(starts != seen):
            eccentricity = simulation.joint_loads()[j, [columns.ECCENTRICITY_X, columns.ECCENTRICITY_Y]]
            depths.append(float(np.hypot(*eccentricity)) - clearance)
        seen = starts
    assert len(depths) > 50
    assert depths == pytest.approx(np.zeros(len(depths)), abs=3e-5 * clearance)


def test_journal_that_starts_pressed_and_at_rest_is_pushed_back() -> None:
    body = Body("body", 5.0, 1.0, 1.0, (0.0, 0.0), position=(0.012, 0.0))
    joint = Joint("hinge", GROUND, "body", (0.0, 0.0), (0.0, 0.0), bearing=SOFT_BEARING)
    simulation = Simulation(Mechanism((body,), (joint,)), ModalRadau(rtol=1e-6))
    simulation.advance(0.05)
    # The contact's energy, 0.4 K depth^2.5, as motion.
    assert -simulation.state.v[0] == pytest.approx(math.sqrt(0.8 * STIFFNESS * 0.002**2.5 / 5.0), rel=1e-4)


@pytest.mark.parametrize("speed", [1e-3, 1e-2, 1e-1])
def test_a_free_undamped_vibration_keeps_its_energy_however_slow_it_is(speed: float) -> None:
    """At a fixed tolerance of 0.1 mm/s all of the energy of one of 1 mm/s is gone after half a second."""
    joint = Joint("hinge", GROUND, "panel", (0.0, 0.0), (0.0, 0.0), bearing=SOFT_BEARING)
    simulation = Simulation(Mechanism((replace(PANEL, modes=4),), (joint,)), ModalRadau(rtol=1e-3))
    # The second bending mode of each symmetry, in a journal that touches nothing.
    for group in range(2):
        simulation.state.v[3 + simulation.model.panels.first[group] + 1] = speed
    before = simulation.stored_energies().sum()
    simulation.advance(0.5)
    assert simulation.state.joints[0]["contact_starts"] == 0
    assert simulation.stored_energies().sum() == pytest.approx(before, rel=1e-5)


@pytest.mark.parametrize("model", ["flexible-ideal", "flexible-clearance"])
def test_array_keeps_its_books(model: str) -> None:
    mechanism = build(ArrayParameters(spring_stiffness=(2.0, 1.5), initial_rate=0.2), f"{model}:6 modes")
    left = []
    for rtol in (1e-3, 1e-6):
        simulation = Simulation(mechanism, ModalRadau(rtol=rtol))
        before = simulation.momenta()
        simulation.advance(0.2)
        residual, turnover = simulation.energy_book()
        left.append(abs(residual) / turnover)
        body = simulation.model.bodies[1]
        scale = body["mass"] * abs(simulation.state.v[body["offset"] : body["offset"] + 2]).max()
        assert np.abs(simulation.momenta() - before).max() < 1e-8 * max(scale, 1.0)
    assert left[0] < 1e-3
    assert left[1] < 2e-6


def test_samples_lie_on_the_run() -> None:
    sampled, between = (Simulation(hanging_panel(), ModalRadau(rtol=rtol)) for rtol in (1e-4, 1e-6))
    recorder = make_recorder(sampled.model, sampled.state, np.array([0.0, 0.1, 0.15]), 10)
    sampled.advance(0.15, recorder)
    assert recorder.filled[0] == 3
    between.advance(0.1)
    assert recorder.samples[1, :3] == pytest.approx(between.state.q[:3], abs=1e-6)


def test_what_the_method_does_not_take_is_refused_with_a_remedy() -> None:
    beam, other = FlexibleBody("beam", 1.0, 2, 1.0, 1.0, 1.0), replace(PANEL, name="other", modes=PANEL.modes + 1)
    inside = Joint("hinge", GROUND, "panel", (1.0, 0.0), (1.0, 0.0))
    off = Joint("hinge", GROUND, "panel", (0.1, 0.0), (0.0, 0.0))
    for mechanism, message in (
        (Mechanism((PANEL, beam)), "is a FlexibleBody, which does not go with ModalRadau; describe it as"),
        (Mechanism((PANEL,), loads=(Load("panel", torque=1.0),)), r"mechanism\.loads: ModalRadau takes none"),
        (Mechanism((PANEL, other)), r"modes = \[.*\] of the panels differ, .*: give every ModalPanel the greatest"),
        (Mechanism((PANEL,), (inside,)), "is not an end of panel 'panel'"),
        (Mechanism((PANEL,), (off,)), r"initial position violates a constraint by 0\.1 m"),
    ):
        with pytest.raises(ValueError, match=message):
            Simulation(mechanism, ModalRadau())
    with pytest.raises(ValueError, match="body 'panel' is a ModalPanel, which needs an integrator of its own: choose"):
        compile_mechanism(Mechanism((PANEL,)))


def test_panel_that_leaves_the_range_of_the_model_is_told_once_even_when_it_has_come_back() -> None:
    simulation = Simulation(Mechanism((replace(PANEL, spin=1.0),)), ModalRadau())
    _, ratio = simulation.formulation.modal_range(simulation.model, simulation.state)
    assert ratio == pytest.approx(1.0 / (4.730041**2 * math.sqrt(300.0 / 1.5) / 4.0), rel=1e-6)
    simulation.check()
    soft = replace(ArrayParameters(), panel_young=ArrayParameters().panel_young / 30.0)
    simulation = Simulation(build(soft, "flexible-ideal:8 modes"), ModalRadau(rtol=1e-3))
    with pytest.warns(SimulationWarning, match=r"by t = 20 s the modal panels have bent by 0\.2.* use beam elements"):
        simulation.advance(20.0)
    simulation.check()


def test_ideal_joints_hold_where_foreshortening_has_them():
    simulation = Simulation(build(ArrayParameters(), "flexible-ideal:8 modes"), ModalRadau(rtol=2e-4))
    simulation.advance(20.7)
    simulation.integrator = replace(simulation.integrator, max_steps=1)
    worst = 0.0
    while not attempt(simulation, 20.77):
        worst = max(worst, simulation.formulation.drift(simulation.model, simulation.state)[1])
    # A relative velocity that a step leaves behind is a blow in the next one, for which no step is short enough: a
    # quarter of the 2e-5 m/s that the tolerance allows is left at most.
    assert worst < 5e-6
