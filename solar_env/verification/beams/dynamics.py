"""Verification cases of flexible beams in large motion: spin-up, falling pendulum, free flight."""

import cmath
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from scipy.integrate import cumulative_trapezoid

from solar_env.mechanics.integrators.settings import GeneralizedAlpha, Integrator, RungeKutta
from solar_env.mechanics.mechanism import STANDARD_GRAVITY, Load
from solar_env.mechanics.mechanism.beams import (
    BEAM,
    PENDULUM_BEAM,
    SPIN_UP_BEAM,
    Beam,
    flexible_pendulum,
    free_beam,
    spin_up_beam,
)
from solar_env.mechanics.running.simulation import Simulation, simulate
from solar_env.verification.beams import theory
from solar_env.verification.beams.fields import flexible_body, momenta, tip
from solar_env.verification.beams.strain_theory import StrainBeam
from solar_env.verification.checks import ENERGY, Check, compare

STRETCHED = "exact: E A r'' = -rho A rate^2 r"
DRIVEN = "conservation of energy: stored = work of the drive"
LINEAR = "exact: m v = m v0 + F t"
ANGULAR = "exact: dL/dt = moment of the loads about the origin"
STRAIN_BEAM = "beam in direction and stretch instead of positions, Legendre polynomials, SciPy's DOP853"
SIMO = "J. C. Simo and L. Vu-Quoc, J. Appl. Mech. 53 (1986) 855, without shear: two methods agreed to the digits given"
BERZERI = "M. Berzeri and A. A. Shabana, J. Sound Vib. 235 (2000) 539: two methods agreed to the tolerance"

SPIN_RATE, RAMP_TIME = 6.0, 15.0
# The falling pendulum with damping and a hundredfold bending stiffness moves smoothly: both integrators converge.
DAMPED_PENDULUM_BEAM = replace(PENDULUM_BEAM, bending_stiffness=100.0 * PENDULUM_BEAM.bending_stiffness, damping=0.01)


def spin_up() -> Iterator[Check]:
    """Check a beam spun up about one end: lag and positions of the tip, mean final extension, and energy."""
    beam = SPIN_UP_BEAM
    mechanism = spin_up_beam(beam, 16, SPIN_RATE, RAMP_TIME)
    motion = simulate(mechanism, 20.0, integrator=GeneralizedAlpha(step=2e-3), output_step=0.01)
    turned = np.array([theory.spin_up_angle(t, SPIN_RATE, RAMP_TIME)[0] for t in motion.time])
    local = tip(flexible_body(mechanism), motion.coordinates) * np.exp(-1j * turned)
    lowest = int(local.imag.argmin())
    yield Check("largest lag of the tip [m], 16 elements", -0.5738, local[lowest].imag, 1e-4, SIMO)
    yield Check("time of the largest lag [s], 16 elements", 6.76, motion.time[lowest], 0.01, SIMO)
    # The tip still swings by 1e-3 m, which shortens the projection of the beam.
    obtained = local.real[motion.time > RAMP_TIME].mean() - beam.length
    extension = theory.spinning_extension(beam, SPIN_RATE)
    yield Check("mean extension after the spin-up [m]", extension, obtained, 0.01 * extension, STRETCHED)
    times = [3.0, 6.0, 9.0, 12.0, 15.0, 18.0]
    reference = StrainBeam(beam, 5, 1, root_angle=lambda t: theory.spin_up_angle(t, SPIN_RATE, RAMP_TIME))
    places = reference.tips([0.0, *times], rtol=1e-6)[1:]
    found = [tip(flexible_body(mechanism), motion.coordinates[round(t / 0.01)]) for t in times]
    obtained = np.abs(np.array(found) - places).max()
    yield Check("greatest distance of the tips at t = 3, 6, .. 18 s [m]", 0.0, obtained, 1e-4, STRAIN_BEAM)
    obtained = motion.energy_residual / motion.energy_put_in
    yield Check("energy residual over the energy put in", 0.0, obtained, 1e-4, DRIVEN)


def falling_pendulum() -> Iterator[Check]:
    """Check tip positions of falling flexible pendulums: one against published values, one against another theory."""
    elements = 32
    mechanism = flexible_pendulum(PENDULUM_BEAM, elements)
    simulation = Simulation(mechanism, GeneralizedAlpha(step=1e-3))
    for time, (x, y, tolerance) in theory.FALLING_TIPS.items():
        simulation.advance(time)
        place = tip(flexible_body(mechanism), simulation.state.q)
        quantity = f"{{}} of the tip at t = {time:g} s [m], {elements} elements"
        yield from compare((("x", x, place.real), ("y", y, place.imag)), quantity, tolerance, BERZERI)
    times, elements = [0.25, 0.5], 16
    places = StrainBeam(DAMPED_PENDULUM_BEAM, 10, 7, gravity=STANDARD_GRAVITY).tips([0.0, *times], rtol=1e-8)[1:]
    mechanism = flexible_pendulum(DAMPED_PENDULUM_BEAM, elements)
    choices: tuple[tuple[Integrator, float], ...] = ((RungeKutta(rtol=1e-8), 2e-5), (GeneralizedAlpha(step=5e-4), 1e-4))
    for integrator, tolerance in choices:
        simulation = Simulation(mechanism, integrator)
        for time, expected in zip(times, places, strict=True):
            simulation.advance(time)
            obtained = abs(tip(flexible_body(mechanism), simulation.state.q) - expected)
            quantity = f"damped, stiffer: distance of the tip at t = {time:g} s [m], {integrator.name}"
            yield Check(quantity, 0.0, obtained, tolerance, STRAIN_BEAM)


def free_flight() -> Iterator[Check]:
    """Check momenta and energy balance of a very flexible, free beam, without loads and under constant loads."""
    beam, elements = Beam(1.5, 4.0, 2e4, 2.0), 6
    duration, spin = 1.0, 4.0
    force, torque, middle = (3.0, -5.0), 2.0, 0.5 * beam.length
    velocity = complex(0.4, -0.2)
    variants: tuple[tuple[str, tuple[Load, ...]], ...] = (
        ("no loads", ()),
        ("force at mid-span", (Load(BEAM, (middle, 0.0), force),)),
        ("force at the tip", (Load(BEAM, (beam.length, 0.0), force),)),
        ("torque at the tip", (Load(BEAM, (beam.length, 0.0), torque=torque),)),
    )
    # Tolerances of angular momentum and energy. The trapezoidal rule integrates moments; generalized-alpha has
    # an error (omega h)^2, and damps the high modes that a sudden torque excites.
    integrators: tuple[tuple[Integrator, float, float], ...] = (
        (RungeKutta(rtol=1e-8), 1e-6, 1e-6),
        (GeneralizedAlpha(step=1e-3), 1e-5, 1e-3),
    )
    for name, loads in variants:
        mechanism = free_beam(beam, elements, (velocity.real, velocity.imag), spin, 0.3, loads)
        body = flexible_body(mechanism)
        centre_velocity = velocity + 1j * spin * middle * cmath.rect(1.0, 0.3)
        for integrator, angular_tolerance, energy_tolerance in integrators:
            motion = simulate(mechanism, duration, integrator=integrator, output_step=1e-3)
            linear, angular = momenta(mechanism, motion)
            pull = sum((complex(*load.force) for load in loads), 0j)
            expected = beam.mass * centre_velocity + pull * motion.time
            moment = np.full_like(motion.time, sum(load.torque for load in loads))
            for load in loads:
                node = body.node(load.point)
                place = motion.coordinates[:, 4 * node] + 1j * motion.coordinates[:, 4 * node + 1]
                moment = moment + (place.conj() * complex(*load.force)).imag
            impulse = cumulative_trapezoid(moment, motion.time, initial=0.0)
            obtained = np.abs(linear[:, 0] - expected).max() / np.abs(expected).max()
            yield Check(f"{name}: linear momentum less F t, relative, {integrator.name}", 0.0, obtained, 1e-9, LINEAR)
            obtained = np.abs(angular[:, 0] - angular[0, 0] - impulse).max() / np.abs(angular).max()
            quantity = f"{name}: angular momentum less the integral of the moments, relative, {integrator.name}"
            yield Check(quantity, 0.0, obtained, angular_tolerance, ANGULAR)
            at_hand = motion.energy_put_in + np.abs(motion.energies["gravity"]).max()
            obtained = motion.energy_residual / at_hand
            quantity = f"{name}: energy residual over the energy at hand, {integrator.name}"
            yield Check(quantity, 0.0, obtained, energy_tolerance, ENERGY)
