"""Free uniform beams and bars whose ends are loaded: flexibility in closed form, fine series, waves.

Nothing here shares code with the engine: series have thousands of exact modes and exact functions of time, the struck
bar is solved by d'Alembert's waves.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import mpmath
import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

Array = NDArray[np.float64]
Force = Callable[[float], float]


@lru_cache(maxsize=8)
def free_wave_numbers(count: int) -> Array:
    """(count,) roots of cos x cosh x = 1, of forty digits rounded (S. Timoshenko, Vibration Problems, 1937)."""
    with mpmath.workdps(40):
        starts = [(k + mpmath.mpf(1) / 2) * mpmath.pi for k in range(1, count + 1)]
        # From the twentieth on the root is the start in all digits of a double.
        roots = [
            mpmath.findroot(lambda x: mpmath.cos(x) - mpmath.sech(x), x) if k < 20 else x for k, x in enumerate(starts)
        ]
    return np.array([float(x) for x in roots])


def bending_flexibility(length: float, stiffness: float) -> Array:
    """(4, 4) deflection [m] and slope [rad] at both ends by a unit force and moment at each, in the mean-axis frame.

    The loads are held by the inertia of a uniform beam: E I w'''' = -rho A (a + alpha s), w free of mean and mean turn.

    Args:
        length: [m].
        stiffness: E I [N m2].
    """
    x = Polynomial([0.0, 1.0])

    def deflection(shear: float, moment: float, inertia: Polynomial) -> Polynomial:
        w = inertia.integ(4) + shear * x**3 / 6.0 + moment * x**2 / 2.0
        for weight in (Polynomial([1.0]), x - 0.5):
            product, square = (w * weight).integ(), (weight * weight).integ()
            w = w - weight * (product(1.0) - product(0.0)) / (square(1.0) - square(0.0))
        return w

    # Of a beam of length 1 with E I = 1, loaded at x = 0.
    by_force = deflection(1.0, 0.0, -(4.0 - 6.0 * x))
    by_moment = deflection(0.0, -1.0, -12.0 * (x - 0.5))
    columns = []
    for w, other in ((by_force, 1.0), (by_moment, -1.0)):
        own = [w(0.0), w.deriv()(0.0), w(1.0), w.deriv()(1.0)]
        # The same load at the other end is the mirror image; slopes change sign, and moments do.
        mirrored = [w(1.0), -w.deriv()(1.0), w(0.0), -w.deriv()(0.0)]
        columns += [own, [other * value for value in mirrored]]
    unit = np.array([columns[0], columns[2], columns[1], columns[3]]).T
    scale = np.array([length, 1.0, length, 1.0])
    return unit * np.outer(scale, scale) * length / stiffness


def axial_flexibility(length: float, stiffness: float) -> Array:
    """(2, 2) displacement [m] of both ends of a free bar by a unit force at each, about the centre of mass.

    Args:
        length: [m].
        stiffness: E A [N].
    """
    return np.array([[1.0 / 3.0, -1.0 / 6.0], [-1.0 / 6.0, 1.0 / 3.0]]) * length / stiffness


@dataclass(frozen=True)
class FineBeam:
    """A free beam by thousands of modes, each a function of time in closed form.

    Attributes:
        length: [m].
        mass: [kg].
        stiffness: E I [N m2].
        damping: retardation time of the material [s].
        modes: number of bending modes.
    """

    length: float
    mass: float
    stiffness: float
    damping: float = 0.0
    modes: int = 4000

    @property
    def frequencies(self) -> Array:
        """(modes,) [rad/s]."""
        return free_wave_numbers(self.modes) ** 2 * math.sqrt(self.stiffness / self.mass / self.length**3)

    @property
    def first_end(self) -> Array:
        """(2, modes) deflection and slope of the first end by the unit amplitude of mass-normalised modes."""
        x = free_wave_numbers(self.modes)
        low = x[:12]
        sigma = np.ones(self.modes)
        sigma[:12] = (np.cosh(low) - np.cos(low)) / (np.sinh(low) - np.sin(low))
        return np.array([np.full(self.modes, 2.0), -2.0 * sigma * x / self.length]) / math.sqrt(self.mass)

    def step_response(self, load: int, time: float) -> tuple[Array, Array]:
        """Deflection and slope of the first end, and their rates, at a time [s] after a unit load began to act there.

        Args:
            load: 0 for the force, 1 for the moment.
            time: [s].
        """
        omega, ends = self.frequencies, self.first_end
        decay = 0.5 * self.damping * omega**2
        root = np.sqrt((omega**2 - decay**2).astype(complex))
        # Of the sum and the difference of exponentials, which do not overflow where the mode does not oscillate.
        plus, minus = np.exp((-decay + 1j * root) * time), np.exp((-decay - 1j * root) * time)
        sine = ((plus - minus) / (2j * root)).real
        ringing = ((0.5 * (plus + minus)).real + decay * sine) / omega**2
        still = bending_flexibility(self.length, self.stiffness)[:2, load]
        inertia = self.mass * self.length**2 / 12.0
        arm = np.array([-0.5 * self.length, 1.0])
        rigid = np.array([1.0 if load == 0 else 0.0, 0.0]) / self.mass + arm * arm[load] / inertia
        return rigid * 0.5 * time**2 + still - ends @ (ends[load] * ringing), rigid * time + ends @ (ends[load] * sine)

    def left_out(self, kept: int) -> Array:
        """(2,) flexibility of the first end to a force and to a moment there, of the modes above the first `kept`."""
        return np.sum((self.first_end[:, kept:] / self.frequencies[kept:]) ** 2, axis=1)


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
        """[N]."""
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
    rigid = 4.0 / beam.mass
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


def first_frequency(length: float, mass: float, stiffness: float) -> float:
    """Angular frequency [rad/s] of the lowest bending mode of a free beam."""
    return float(free_wave_numbers(1)[0] ** 2 * math.sqrt(stiffness / mass / length**3))


def spin_stiffening() -> float:
    """Share c by which a steady spin raises the squared frequency of a free beam's lowest mode, c spin^2.

    Rayleigh's quotient of the centrifugal tension rho A spin^2 (L^2 / 4 - s^2) / 2 on the slopes, less one for the
    inertia of the turning frame.
    """
    x = float(free_wave_numbers(1)[0])
    # The mode is even about its middle: cosh(x/2) cos(x s) + cos(x/2) cosh(x s), -1/2 < s < 1/2.
    s, weights = np.polynomial.legendre.leggauss(60)
    s, weights = 0.5 * s, 0.5 * weights
    shape = math.cosh(0.5 * x) * np.cos(x * s) + math.cos(0.5 * x) * np.cosh(x * s)
    slope = x * (-math.cosh(0.5 * x) * np.sin(x * s) + math.cos(0.5 * x) * np.sinh(x * s))
    return float(weights @ (0.5 * (0.25 - s**2) * slope**2) / (weights @ shape**2)) - 1.0
