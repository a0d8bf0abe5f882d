"""A rigid mass that strikes an end of a free bar, by its waves, or of a free beam, by thousands of exact modes."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from solar_env.verification.panels.theory import FineBeam

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Impact:
    """A rigid mass that strikes an end of a free beam or bar through a Hertzian contact, F = K depth^1.5.

    Attributes:
        mass: of the striker [kg].
        speed: at which it comes [m/s].
        stiffness: K [N/m^1.5].
    """

    mass: float
    speed: float
    stiffness: float

    def force(self, depth: float) -> float:
        """Contact force at a depth [m], by Hertz [N]."""
        return self.stiffness * max(depth, 0.0) ** 1.5


@dataclass(frozen=True)
class Struck:
    """Outcome of an impact: time [s] and force [N] through it, and the striker's speed afterwards [m/s]."""

    time: Array
    force: Array
    exit_speed: float


def struck_bar(impact: Impact, length: float, impedance: float, wave_speed: float) -> Struck:
    """A free bar that is struck along its axis, by its waves, which its other end returns as tension.

    The struck end moves at F(t) / z + 2 sum_n F(t - n T) / z, T = 2 length / wave_speed (J. N. Goodier and
    S. P. Timoshenko, Theory of Elasticity, 3rd ed., 1970; K. F. Graff, Wave Motion in Elastic Solids, 1975).
    Without compliance of the contact it is St. Venant's solution, F = z v0 exp(-z t / m) up to T.

    Args:
        impact: of the mass.
        length: [m].
        impedance: z = sqrt(E A rho A) [kg/s].
        wave_speed: sqrt(E / rho) [m/s].
    """
    there_and_back = 2.0 * length / wave_speed
    segments: list[Callable[[float], Array]] = []

    def slope(time: float, state: Array) -> tuple[float, float, float]:
        force = impact.force(state[0] - state[2])
        returned = 0.0
        for number, segment in enumerate(reversed(segments), 1):
            then = segment(time - number * there_and_back)
            returned += 2.0 * impact.force(float(then[0] - then[2]))
        return float(state[1]), -force / impact.mass, (force + returned) / impedance

    def parted(_: float, state: Array) -> float:
        return float(state[0] - state[2]) if state[1] < impact.speed else 1.0

    parted.terminal, parted.direction = True, -1.0  # type: ignore[attr-defined]
    state, times, forces = np.array([0.0, impact.speed, 0.0]), [], []
    while True:
        first = len(segments) * there_and_back
        found = solve_ivp(
            slope,
            (first, first + there_and_back),
            state,
            "DOP853",
            dense_output=True,
            events=parted,
            rtol=1e-10,
            atol=1e-16,
            max_step=there_and_back / 200.0,
        )
        time = np.linspace(first, found.t[-1], 2000)
        times.append(time)
        forces.append(np.array([impact.force(float(y[0] - y[2])) for y in found.sol(time).T]))
        state = found.y[:, -1]
        segments.append(found.sol)
        if found.status == 1:
            return Struck(np.concatenate(times), np.concatenate(forces), float(state[1]))


def struck_beam(impact: Impact, beam: FineBeam, duration: float, steps: int) -> Struck:
    """A free beam that is struck across its first end, by modes that answer a force linear in time exactly.

    The force at the end of every step solves one scalar equation. The error falls with the square of the step.

    Args:
        impact: of the mass.
        beam: undamped.
        duration: until when [s]; the contact must have ended.
        steps: number of steps.
    """
    h = duration / steps
    omega, row = beam.frequencies, beam.first_end[0]
    cosine, sine = np.cos(omega * h), np.sin(omega * h) / omega
    # Answers of value and rate to the loads 1 and t / h.
    constant, ramp = (1.0 - cosine) / omega**2, (h - sine) / (omega**2 * h)
    constant_rate, ramp_rate = sine, (1.0 - cosine) / (omega**2 * h)
    rigid = 4.0 / beam.beam.mass
    flexible = float(row**2 @ ramp)
    y, v = np.zeros(beam.modes), np.zeros(beam.modes)
    end, end_rate, place, speed, force = 0.0, 0.0, 0.0, impact.speed, 0.0
    forces = np.zeros(steps + 1)
    gain = h * h / 6.0 * (1.0 / impact.mass + rigid) + flexible
    for n in range(1, steps + 1):
        free_y = cosine * y + sine * v
        free_v = cosine * v - omega**2 * sine * y
        base = constant - ramp
        depth = (
            place
            + h * speed
            - h * h / 3.0 * force / impact.mass
            - (end + h * end_rate + h * h / 3.0 * rigid * force)
            - float(row @ free_y)
            - float(row**2 @ base) * force
        )
        new = _hertz_against_flexibility(impact, depth, gain, force)
        y = free_y + row * (base * force + ramp * new)
        v = free_v + row * ((constant_rate - ramp_rate) * force + ramp_rate * new)
        place += h * speed - h * h * (force / 3.0 + new / 6.0) / impact.mass
        speed -= 0.5 * h * (force + new) / impact.mass
        end += h * end_rate + h * h * (force / 3.0 + new / 6.0) * rigid
        end_rate += 0.5 * h * (force + new) * rigid
        forces[n] = force = new
    return Struck(np.linspace(0.0, duration, steps + 1), forces, speed)


def _hertz_against_flexibility(impact: Impact, depth: float, gain: float, guess: float) -> float:
    """Force F = K (depth - gain F)^1.5, by Newton's method; `depth` is that without the force."""
    if depth <= 0.0:
        return 0.0
    # By the root of the depth, whose equation x^2 + gain K x^3 = depth has one positive solution.
    x = min(math.sqrt(depth), max(guess / impact.stiffness, 0.0) ** (1.0 / 3.0) + 1e-12 + math.sqrt(depth) * 1e-3)
    for _ in range(60):
        value = x * x * (1.0 + gain * impact.stiffness * x) - depth
        change = value / (x * (2.0 + 3.0 * gain * impact.stiffness * x))
        x = max(x - change, 1e-3 * x)
        if abs(change) <= 1e-14 * x:
            break
    return impact.stiffness * x**3
