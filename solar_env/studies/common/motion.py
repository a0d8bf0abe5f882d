"""Scenes and model levels that studies simulate; motions, which record a run of any program; and errors of motions."""

import math
import warnings
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from solar_env.array import RELEASE_RATE, ArrayParameters, ModelLevel, build, default_integrator
from solar_env.array.deployment import simulate as simulate_array
from solar_env.mechanics.integrators.settings import Integrator, RungeKutta
from solar_env.mechanics.running.diagnosis import SimulationWarning
from solar_env.mechanics.running.simulation import simulate
from solar_env.mechanics.running.trajectory import Trajectory

Array = NDArray[np.float64]

# Greatest relative deviation of an ensemble member's tolerance or step from the nominal setting.
SETTING_SHARE = 3e-3


@dataclass(frozen=True)
class Scene:
    """A deployment to simulate, with any program, from the folded configuration."""

    model: str  # model level as a word, see `ModelLevel`
    parameters: ArrayParameters
    duration: float  # s
    sample_step: float  # time between sampled angles [s]
    forces_kept: bool = False  # whether a program that samples contact forces must sample them at every step

    @property
    def level(self) -> ModelLevel:
        """The model level that the word `model` names."""
        return ModelLevel.of(self.model)

    @property
    def sample_times(self) -> Array:
        """(nt,) times of the samples [s], from 0 to the duration."""
        count = math.ceil(self.duration / self.sample_step - 1e-9)
        return np.append(np.arange(count) * self.sample_step, self.duration)


def with_panels(model: str, panels: str) -> str:
    """Return a model's name with other flexible panels, such as "6 elements"; a rigid model's name stays unchanged."""
    level = ModelLevel.of(model)
    return f"{level.name}:{panels}" if level.flexible else level.name


@dataclass(frozen=True)
class Motion:
    """Record of a run with nt samples and nj joints; a number that the program does not report is nan.

    Totals (nj,) count from the first latching on: "peak_force_N", the greatest contact force or, with ideal joints,
    the greatest reaction; "sliding_work_J"; and "impacts", the number of impacts. "wear_depth_m" counts the whole run.
    """

    time: Array  # (nt,) [s]
    angles: Array  # (nt, nj) [rad]
    latch_times: Array  # (nj,) [s], nan if not latched
    wall_time: float  # time of the integration alone, without compiling or assembling [s]
    steps: float = math.nan
    evaluations: float = math.nan  # evaluations of the right-hand side or residual
    factorizations: float = math.nan
    energy_residual: float = math.nan  # unaccounted energy divided by the energy put in
    totals: dict[str, Array] = field(default_factory=dict)


def perturbed(parameters: ArrayParameters, member: int) -> ArrayParameters:
    """Return a member's parameters, with release rates drawn uniformly within RELEASE_RATE of the nominal rates.

    Varying a hinge's position would not do: the lasting contact during the deployment erases such differences, and all
    members would be alike at the latching. Member 0 has the nominal parameters.
    """
    rates = RELEASE_RATE * _deviations(member, len(parameters.joints))
    nominal = parameters.for_each_joint("initial_rate")
    return replace(parameters, initial_rate=tuple((nominal + rates).tolist()))


def perturbed_setting(value: float, member: int) -> float:
    """Return a member's tolerance or step, uniform within SETTING_SHARE of `value`; member 0 has `value` itself."""
    return value * (1.0 + SETTING_SHARE * float(_deviations(member, 1, stream=1)[0]))


def _deviations(member: int, count: int, stream: int = 0) -> Array:
    """Draw (count,) random numbers in [-1, 1], seeded by member and stream; zeros for member 0."""
    return np.random.default_rng([member, stream]).uniform(-1.0, 1.0, count) * (member > 0)


@dataclass(frozen=True)
class Level:
    """A level of the model, simulated with its default integrator.

    Attributes:
        model: the level as a word, see `ModelLevel`.
        tighter: divisor of the integrator's tolerance.
    """

    model: str
    tighter: float = 1.0

    @property
    def size(self) -> str:
        """Panels and tolerance of the level in words: "rigid", "6 elements", "32 modes, rtol / 4"."""
        return self.panels.size if self.tighter == 1.0 else f"{self.panels.size}, rtol / {self.tighter:g}"

    @property
    def panels(self) -> ModelLevel:
        """The model level, without the tolerance, that the word `model` names."""
        return ModelLevel.of(self.model)

    @property
    def name(self) -> str:
        """Model, panels and tolerance of the level in words."""
        return f"{self.panels.name}, {self.size}" if self.panels.flexible else self.panels.name

    def integrator(self, member: int = 0) -> RungeKutta:
        """Return the default integrator at this level's tolerance, slightly varied for an ensemble member."""
        default = default_integrator(self.model)
        return replace(default, rtol=perturbed_setting(default.rtol, member) / self.tighter)

    def deploy(self, parameters: ArrayParameters, member: int, duration: float, output_step: float) -> Trajectory:
        """Simulate an ensemble member's deployment at this level, with parameters from `perturbed`.

        Raises:
            SimulationError: if the run cannot go on.
        """
        return simulate_array(
            perturbed(parameters, member),
            model=self.model,
            duration=duration,
            integrator=self.integrator(member),
            output_step=output_step,
        )


FINEST = Level("flexible-clearance:48 modes", tighter=10.0)
"""Reference level, finer than all levels of the ladder; beams of 48 elements agree with it."""


def run_ours(scene: Scene, integrator: Integrator) -> Motion:
    """Simulate a scene with one of our integrators.

    Raises:
        SimulationError: if the run cannot go on.
    """
    with warnings.catch_warnings():  # the study measures the errors that the library warns of
        warnings.simplefilter("ignore", SimulationWarning)
        array = build(scene.parameters, scene.model)
        trajectory = simulate(array, scene.duration, integrator=integrator, output_step=scene.sample_step)
    return from_trajectory(trajectory)


def from_trajectory(trajectory: Trajectory) -> Motion:
    """Convert a trajectory of our simulator to a motion record."""
    latched = np.nanmin([*trajectory.latch_times, math.inf])
    late = trajectory.contacts[trajectory.contacts["start_s"] > latched]
    return Motion(
        time=trajectory.time,
        angles=trajectory.angles,
        latch_times=trajectory.latch_times,
        wall_time=float(trajectory.metadata["wall_time_s"]),
        steps=float(trajectory.metadata["steps"]),
        evaluations=float(trajectory.metadata["evaluations"]),
        factorizations=float(trajectory.metadata["factorizations"]),
        energy_residual=trajectory.energy_residual / trajectory.energy_put_in,
        totals={
            "peak_force_N": trajectory.postlock_peak_force,
            "sliding_work_J": trajectory.postlock_sliding_work,
            "impacts": np.bincount(late["joint"], minlength=len(trajectory.latch_times)).astype(float),
            "wear_depth_m": trajectory.wear_depth,
        },
    )


def angle_error(motion: Motion, reference: Motion, until: float) -> float:
    """Return the greatest difference [rad] of joint angles between a motion and its reference, up to `until` [s].

    Raises:
        ValueError: if the samples of the two motions lie at different times.
    """
    if motion.time.shape != reference.time.shape or not np.allclose(motion.time, reference.time, rtol=0.0, atol=1e-9):
        raise ValueError("the samples of the two motions lie at different times")
    counted = reference.time <= until + 1e-9
    return float(np.abs(motion.angles - reference.angles)[counted].max())


def latch_error(motion: Motion, reference: Motion) -> float:
    """Return the greatest error of the latch times [s]: inf if a latching is missing, nan if no joint should latch."""
    expected = np.isfinite(reference.latch_times)
    if not expected.any():
        return math.nan
    differences = np.abs(motion.latch_times - reference.latch_times)[expected]
    return float(np.where(np.isnan(differences), math.inf, differences).max())


def force_error(motion: Motion, reference: Motion) -> float:
    """Return the greatest relative error of a joint's post-latch peak force; nan if the reference has no such force."""
    right = reference.totals["peak_force_N"]
    errors = np.abs(motion.totals["peak_force_N"] / np.where(right > 0.0, right, math.nan) - 1.0)
    return math.nan if np.isnan(errors).all() else float(np.nanmax(errors))
