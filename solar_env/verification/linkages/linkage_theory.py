"""Slider-crank and four-bar with a uniformly turning crank: closed-form kinematics, Newton-Euler inverse dynamics.

Complex numbers stand for vectors of the plane. Differentiating the closed loop once and twice gives the rates of the
driven links; moments about two pins give the force in the last moving pin, and balances of forces the other ones
(J. J. Uicker, G. R. Pennock and J. E. Shigley, Theory of Machines and Mechanisms, Oxford University Press).
"""

import cmath
import math
from dataclasses import dataclass

import numpy as np

from solar_env.mechanics.mechanism.textbook import Link


@dataclass(frozen=True)
class LinkageState:
    """Motion and forces at one crank angle.

    Attributes:
        output: slider's displacement [m], or rocker's angle [rad].
        output_rate: its rate [m/s, rad/s].
        output_acceleration: [m/s2, rad/s2].
        crank_moment: that keeps the crank turning uniformly [N m].
        pin_forces: by pin in the order of the mechanism's, each on its outboard body [N].
        play_gain: greatest change of the output per displacement of a journal in any one pin, to first order.
    """

    output: float
    output_rate: float
    output_acceleration: float
    crank_moment: float
    pin_forces: tuple[complex, ...]
    play_gain: float


def _moment(arm: complex, force: complex) -> float:
    return (arm.conjugate() * force).imag


def _inertia_moment(link: Link, arm: complex, acceleration: complex, spin_rate: float) -> float:
    """Moment of the inertia force and couple of a link about a point, `arm` before its centroid."""
    return link.inertia * spin_rate + _moment(arm, link.mass * acceleration)


def slider_crank_state(crank: Link, rod: Link, slider_mass: float, rate: float, angle: float) -> LinkageState:
    """Slider-crank without gravity, slider on the x axis, at an angle [rad] and a uniform rate [rad/s]."""
    pin = cmath.rect(crank.length, angle)
    pin_acceleration = -(rate**2) * pin
    # Rod: its end stays on the axis, so that Im(pin + rod) = 0 and its derivatives.
    rod_y = -pin.imag
    rod_x = math.sqrt(rod.length**2 - rod_y**2)
    along = complex(rod_x, rod_y)
    spin = -(1j * rate * pin).imag / rod_x
    spin_rate = (spin**2 * rod_y - pin_acceleration.imag) / rod_x
    along_acceleration = (1j * spin_rate - spin**2) * along
    slider_acceleration = (pin_acceleration + along_acceleration).real
    # Force on the slider: axial from its own inertia, transverse from the moments on the rod about the crank pin.
    rod_acceleration = pin_acceleration + along_acceleration / 2.0
    axial = slider_mass * slider_acceleration
    inertial = _inertia_moment(rod, along / 2.0, rod_acceleration, spin_rate)
    transverse = -(inertial - along.imag * axial) / along.real
    slider_force = complex(axial, transverse)
    rod_force = rod.mass * rod_acceleration + slider_force
    ground_force = crank.mass * pin_acceleration / 2.0 + rod_force
    return LinkageState(
        output=(pin + along).real,
        output_rate=(1j * rate * pin + 1j * spin * along).real,
        output_acceleration=slider_acceleration,
        crank_moment=_moment(pin, rod_force),
        pin_forces=(ground_force, rod_force, slider_force),
        # Play along the rod moves the slider by its share along the axis: 1 / cos(rod angle).
        play_gain=rod.length / rod_x,
    )


def four_bar_state(
    crank: Link, coupler: Link, rocker: Link, ground_length: float, rate: float, angle: float, gravity: float
) -> LinkageState:
    """Open four-bar at a crank angle [rad] and a uniform rate [rad/s]; gravity towards -y."""
    pin = cmath.rect(crank.length, angle)
    # Freudenstein: the rocker's angle from the triangle over the diagonal between its ground pin and the crank pin.
    diagonal = pin - ground_length
    cosine = (rocker.length**2 + abs(diagonal) ** 2 - coupler.length**2) / (2.0 * rocker.length * abs(diagonal))
    rocker_arm = cmath.rect(rocker.length, cmath.phase(diagonal) - math.acos(cosine))
    coupler_arm = ground_length + rocker_arm - pin
    # Loop: crank + coupler - rocker = ground, differentiated once and twice.
    matrix = np.array([[-coupler_arm.imag, rocker_arm.imag], [coupler_arm.real, -rocker_arm.real]])

    def close(vector: complex) -> tuple[float, float]:
        solution = np.linalg.solve(matrix, [-vector.real, -vector.imag])
        return float(solution[0]), float(solution[1])

    coupler_spin, rocker_spin = close(1j * rate * pin)
    pin_acceleration = -(rate**2) * pin
    coupler_spin_rate, rocker_spin_rate = close(
        pin_acceleration - coupler_spin**2 * coupler_arm + rocker_spin**2 * rocker_arm
    )
    # Accelerations less that of gravity: weights count as inertia forces.
    up = 1j * gravity
    crank_effective = pin_acceleration / 2.0 + up
    coupler_effective = pin_acceleration + (1j * coupler_spin_rate - coupler_spin**2) * coupler_arm / 2.0 + up
    rocker_effective = (1j * rocker_spin_rate - rocker_spin**2) * rocker_arm / 2.0 + up
    # Force F on the rocker at its moving pin: moments on the coupler about the crank pin, on the rocker about its own.
    moments = [
        -_inertia_moment(coupler, coupler_arm / 2.0, coupler_effective, coupler_spin_rate),
        _inertia_moment(rocker, rocker_arm / 2.0, rocker_effective, rocker_spin_rate),
    ]
    arms = np.array([[-coupler_arm.imag, coupler_arm.real], [-rocker_arm.imag, rocker_arm.real]])
    rocker_force = complex(*np.linalg.solve(arms, moments))
    coupler_force = coupler.mass * coupler_effective + rocker_force
    crank_force = crank.mass * crank_effective + coupler_force
    ground_rocker_force = rocker.mass * rocker_effective - rocker_force
    return LinkageState(
        output=cmath.phase(rocker_arm),
        output_rate=rocker_spin,
        output_acceleration=rocker_spin_rate,
        crank_moment=_moment(pin / 2.0, crank.mass * crank_effective) + _moment(pin, coupler_force),
        pin_forces=(crank_force, coupler_force, rocker_force, ground_rocker_force),
        # Play along the coupler turns the rocker by its share across it: 1 / sin(transmission angle).
        play_gain=coupler.length / abs(_moment(coupler_arm, rocker_arm)),
    )
