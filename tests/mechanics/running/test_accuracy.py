"""A run that finishes but is wrong warns; one that is right keeps silent. Warnings are errors in these tests."""

from __future__ import annotations

import re
import warnings
from collections.abc import Callable
from dataclasses import replace

import gymnasium
import numpy as np
import pytest
from mechanisms import block, pendulum

from solar_env.array import ArrayParameters, build
from solar_env.array.deployment import simulate as simulate_deployment
from solar_env.environment.registration import DEPLOY_V1
from solar_env.mechanics.integrators.settings import GeneralizedAlpha, Integrator, ModalRadau, RungeKutta
from solar_env.mechanics.joints.laws import PowerLaw
from solar_env.mechanics.mechanism.description import Bearing, Stop
from solar_env.mechanics.mechanism.textbook import bouncing_block, four_bar
from solar_env.mechanics.mechanism.textbook import pendulum as point_pendulum
from solar_env.mechanics.running.diagnosis import SimulationWarning, restitution_text
from solar_env.mechanics.running.simulation import Simulation, simulate
from solar_env.studies.stability.step_maps import swinging_link

# Impacts of some 0.5 ms.
GAP = Bearing(2e-4, 0.01, PowerLaw(7.39e10))


def told_by(run: Callable[[], object]) -> list[str]:
    """Warnings of a run."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        run()
    return [str(one.message) for one in caught]


def told(simulation: Simulation, end: float) -> list[str]:
    """Warnings of one call."""
    return told_by(lambda: simulation.advance(end))


@pytest.mark.parametrize("rho_inf", [0.0, 0.5, 0.8, 1.0])
def test_impacts_that_a_fixed_step_does_not_resolve_are_told_and_told_once(rho_inf: float) -> None:
    simulation = Simulation(bouncing_block(GAP, 6.0), GeneralizedAlpha(step=2e-4, rho_inf=rho_inf))
    simulation.advance(0.01)
    (first,) = (one for one in told_by(simulation.check) if one.startswith("an impact"))
    assert re.search(r"an impact of 0\.000\d+ s got \S+ steps, .* good to 1 % needs \d+; .* step of at most", first)
    assert told_by(simulation.check) == []


def test_a_resolving_fixed_step_and_an_adaptive_one_are_silent_about_impacts() -> None:
    for chosen in (GeneralizedAlpha(step=2e-5), RungeKutta()):
        simulation = Simulation(bouncing_block(GAP, 6.0), chosen)
        simulation.advance(0.02)
        simulation.check()
        assert simulation.state.joints["contact_starts"][0] > 3


def test_energy_that_a_latch_gains_under_a_long_step_is_told() -> None:
    said = told_by(lambda: simulate(swinging_link(1e8), 0.4, integrator=GeneralizedAlpha(step=1e-3)))
    (one,) = (one for one in said if "that no force accounts for" in one)
    assert re.search(r"by t = 0\.4 s .* has gained \S+ J .* % of the \S+ J turned over; reduce the step$", one)


def test_energy_that_a_loose_tolerance_loses_is_told_with_the_tolerance() -> None:
    with pytest.warns(SimulationWarning, match=r"turned over; tighten rtol = 0\.1"):
        simulate(
            bouncing_block(GAP, 6.0), 0.05, integrator=RungeKutta(rtol=0.1, impact_resolution=4.0, velocity_scale=10.0)
        )


@pytest.mark.parametrize("rtol", [0.01, 0.02])
def test_a_tolerance_that_lets_single_contacts_come_out_tenfold_is_told(rtol: float) -> None:
    """At 0.02 a joint of modal panels had 1,400 N for 102 N in one of 30 deployments, and a book closed to 0.5 %."""
    said = told_by(lambda: simulate(bouncing_block(GAP, 6.0), 0.05, integrator=ModalRadau(rtol=rtol)))
    assert ["a single contact may come out" in one for one in said] == [True] * (rtol > 0.01)


def test_a_loose_tolerance_without_contact_is_silent_about_contacts() -> None:
    assert not told_by(lambda: simulate(point_pendulum(1.0, 1.0), 0.1, integrator=ModalRadau(rtol=0.05)))


def test_a_run_that_goes_on_call_by_call_is_looked_at_every_ten_thousand_steps() -> None:
    simulation = Simulation(swinging_link(1e8), GeneralizedAlpha(step=1e-3))
    said: list[str] = []
    for k in range(1, 12):
        before = int(simulation.state.clock["steps"][0])
        said += told(simulation, float(k))
        assert simulation.state.clock["steps"][0] == before + 1000
    assert sum("that no force accounts for" in one for one in said) == 1


def test_constraint_forces_that_alternate_are_told() -> None:
    with pytest.warns(
        SimulationWarning, match=r"at t = 2 s the constraint forces .* off by \S+ N .* choose rho_inf = 0"
    ):
        simulate(build(ArrayParameters(), "rigid-ideal"), 2.0, integrator=GeneralizedAlpha(rho_inf=1.0))


def test_a_change_of_step_that_sets_constraint_forces_swinging_is_told() -> None:
    simulation = Simulation(point_pendulum(), GeneralizedAlpha(step=0.01, rho_inf=0.95))
    simulation.advance(1.0)
    simulation.integrator = GeneralizedAlpha(step=0.008, rho_inf=0.95)
    said: list[str] = []
    for k in range(1, 31):
        said += told(simulation, 1.0 + 0.008 * k)
    assert len(said) == 1
    assert "constraint forces" in said[0]


@pytest.mark.parametrize("chosen", [RungeKutta(), GeneralizedAlpha(step=1e-3)])
def test_good_runs_are_silent(chosen: Integrator) -> None:
    for mechanism in (pendulum(), point_pendulum(), four_bar(), build(ArrayParameters(), "rigid-ideal")):
        simulation = Simulation(mechanism, chosen)
        # Calls that end where a pendulum rests included.
        for k in range(1, 25):
            simulation.advance(0.1 * k)
            simulation.check()
    simulate(block((0.0, 0.0), bearing=GAP), 0.1, integrator=chosen)


def test_the_defaults_are_silent_for_a_whole_deployment() -> None:
    for model in ("rigid-ideal", "rigid-clearance"):
        simulate_deployment(model=model, duration=16.0)


def test_the_environment_looks_at_the_accuracy_when_an_episode_ends() -> None:
    env = gymnasium.make(DEPLOY_V1).unwrapped
    env.reset(seed=0)
    # Energy from nowhere.
    env.simulation.state.clock["initial_energy"] -= 0.1

    def run_to_the_end() -> None:
        while not env.step(np.zeros(1, dtype=np.float32))[2]:
            pass

    (one,) = told_by(run_to_the_end)
    assert "gained 0.1 J that no force accounts for" in one


def test_contacts_below_the_minimum_impact_speed_are_counted() -> None:
    slow, fast = (simulate(bouncing_block(GAP, 6.0, speed), 2.5 * GAP.clearance / speed) for speed in (5e-5, 5e-3))
    assert slow.metadata["slow_contacts"] == slow.contact_starts[0] == 1
    assert fast.metadata["slow_contacts"] == 0
    assert slow.summary()["slow_contacts"] == 1


def test_a_step_of_fewer_than_four_to_an_impact_is_refused() -> None:
    with pytest.raises(ValueError, match=r"impact_resolution = 2\.0 must be at least 4"):
        RungeKutta(impact_resolution=2.0)


def test_a_damped_latch_under_the_default_tolerance_is_silent() -> None:
    link = swinging_link(1e6)
    stop = Stop(0.01, 1e6, exponent=1.0, ramp_depth=1e-3, damping=10.0)
    simulate(replace(link, joints=(replace(link.joints[0], stop=stop),)), 0.3)


def test_a_law_that_bounces_otherwise_than_asked_is_told_once_for_values_that_are_nearly_the_same() -> None:
    law = "lankarani-nikravesh"
    text = restitution_text(law, 0.5, 0.725)
    assert re.search(r"nikravesh .* 0\.5 .* 0\.7; choose .*'restitution'", text)
    assert text == restitution_text(law, 0.501, 0.726)
    assert restitution_text(law, 0.9, 0.913) == ""
    with pytest.warns(SimulationWarning, match="restitution"):
        ArrayParameters(contact_law=law, restitution=0.5)
    for silent, restitution in ((law, 0.8), ("flores", 0.01), ("restitution", 0.1), ("hertz", 0.5)):
        ArrayParameters(contact_law=silent, restitution=restitution)
