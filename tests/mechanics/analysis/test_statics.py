import math
from dataclasses import replace

import numpy as np
import pytest
from mechanisms import double_pendulum

from solar_env.array import ArrayParameters, build
from solar_env.mechanics.analysis.linearization import linearize, natural_frequencies, static_equilibrium
from solar_env.mechanics.mechanism.beams import BEAM, PANEL, free_beam
from solar_env.mechanics.mechanism.description import GROUND, Body, CableLoop, Joint, Load, Mechanism, Spring, Stop
from solar_env.mechanics.mechanism.textbook import Link, pendulum
from solar_env.mechanics.running.errors import SimulationError


def sprung_link(preload_angle: float, load: float = 0.0, torque: float = 0.0, stiffness: float = 5.0) -> Mechanism:
    link = Link.slender(2.0, 3.0)
    joint = Joint("hinge", GROUND, "link", (0.0, 0.0), (0.0, 0.0), spring=Spring(stiffness, preload_angle))
    loads = (Load("link", (2.0, 0.0), (0.0, load), torque),)
    return Mechanism((link.body("link", 0j, 0.0, 0j, 0.0),), (joint,), loads=loads)


def test_a_sprung_link_turns_until_the_spring_balances_the_loads():
    q = static_equilibrium(sprung_link(0.3, load=-1.5, torque=0.7))
    angle = math.atan2(q[3] - q[1], q[2] - q[0])
    assert math.hypot(q[2] - q[0], q[3] - q[1]) == pytest.approx(2.0, abs=1e-12)
    assert 5.0 * (0.3 - angle) - 1.5 * 2.0 * math.cos(angle) + 0.7 == pytest.approx(0.0, abs=1e-9)


def test_a_pendulum_at_rest_hangs_and_swings_as_the_physical_pendulum():
    hanging = pendulum(angle=-math.pi / 2)
    assert natural_frequencies(hanging) == pytest.approx([math.sqrt(9.81) / (2.0 * math.pi)], rel=1e-9)
    both = natural_frequencies(double_pendulum(-math.pi / 2))
    # Two slender rods: omega^2 = (3 -+ 6 / sqrt(7)) g / l.
    squares = (3.0 + np.array([-1.0, 1.0]) * 6.0 / math.sqrt(7.0)) * 9.81
    assert both == pytest.approx(np.sqrt(squares) / (2.0 * math.pi), rel=1e-9)


def test_matrices_of_a_sprung_link():
    mechanism = sprung_link(0.0)
    mass, damping, stiffness, constraints = linearize(mechanism)
    assert mass == pytest.approx(mass.T)
    assert not damping.any()
    assert constraints.shape == (3, len(mass))
    turn = np.zeros(len(mass))
    turn[3] = 2.0
    assert constraints @ turn == pytest.approx(0.0)
    assert turn @ mass @ turn == pytest.approx(3.0 * 2.0**2 / 3.0)
    assert turn @ stiffness @ turn == pytest.approx(5.0)


def test_the_folded_array_has_the_zeros_of_a_free_body_and_no_damping_but_the_materials():
    mechanism = build(ArrayParameters(panel_damping=1e-3), "flexible-ideal:2 elements")
    frequencies = natural_frequencies(mechanism)
    assert np.count_nonzero(frequencies < 1e-3) == 3
    _, damping, _, _ = linearize(mechanism)
    assert damping.any()
    assert not linearize(build(ArrayParameters(panel_damping=0.0), "flexible-ideal:2 elements")).damping.any()


def test_a_pendulum_on_its_stow_stop_rests_where_the_stop_bears_its_weight():
    stop = Stop(gap=0.02, stiffness=500.0, exponent=1.0, ramp_depth=1e-3, damping=3.0)
    body = Body("arm", 2.0, 0.3, length=1.0, centroid=(0.6, 0.0))
    pin = Joint("pin", GROUND, "arm", (0.0, 0.0), (0.0, 0.0), stop=stop, stow_angle=0.0)
    mechanism = Mechanism((body,), (pin,), gravity=(0.0, -9.81))
    resting = Mechanism((replace(body, angle=-0.04),), (pin,), gravity=(0.0, -9.81))
    q = static_equilibrium(resting)
    angle = math.atan2(q[3] - q[1], q[2] - q[0])
    assert 500.0 * (-0.02 - angle) == pytest.approx(2.0 * 9.81 * 0.6 * math.cos(angle), rel=1e-9)
    inertia = 0.3 + 2.0 * 0.6**2
    stiffness = 500.0 + 2.0 * 9.81 * 0.6 * math.sin(0.04)
    expected = math.sqrt(stiffness / inertia) / (2.0 * math.pi)
    assert natural_frequencies(resting) == pytest.approx([expected], rel=1e-9)
    # Off the stop there is nothing that holds it.
    with pytest.raises(ValueError, match="unstable"):
        natural_frequencies(replace(mechanism, gravity=(9.81, 0.0), bodies=(replace(body, angle=math.pi),)))


def test_what_cannot_be_solved_is_refused():
    with pytest.raises(SimulationError, match=r"can move freely|was not found"):
        static_equilibrium(free_beam(PANEL, 2, loads=(Load(BEAM, force=(0.0, 1.0)),)))
    with pytest.raises(ValueError, match="unstable"):
        natural_frequencies(pendulum(angle=math.pi / 2))
    links = tuple(Body(n, 1.0, 0.1, 1.0, (0.5, 0.0), position=(x, 0.0)) for n, x in (("a", 0.0), ("b", 1.0)))
    joints = (
        Joint("root", GROUND, "a", (0.0, 0.0), (0.0, 0.0), spring=Spring(1.0, 0.0)),
        Joint("hinge", "a", "b", (1.0, 0.0), (0.0, 0.0), spring=Spring(1.0, 0.0)),
    )
    with pytest.raises(ValueError, match="no potential"):
        natural_frequencies(Mechanism(links, joints, (CableLoop("root", "hinge", 1.0, 2.0, 1.0),)))
