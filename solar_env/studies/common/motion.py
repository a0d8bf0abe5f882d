"""Deployments to simulate in studies, levels of model fidelity, results of runs, and errors against reference runs."""

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
    """A deployment from the folded configuration, to be simulated by this library or by another program."""

    model: str  # name of the model level, see `ModelLevel`
    parameters: ArrayParameters
    duration: float  # s
    sample_step: float  # time between sampled angles [s]
    forces_kept: bool = False  # whether a program that samples contact forces must sample them at every step

    @property
    def level(self) -> ModelLevel:
        """The model level (kind of panels and joints) that the attribute `model` names."""
        return ModelLevel.of(self.model)

    @property
    def sample_times(self) -> Array:
        """(nt,) times of the samples [s], from 0 to the duration."""
        count = math.ceil(self.duration / self.sample_step - 1e-9)
        return np.append(np.arange(count) * self.sample_step, self.duration)


def with_panels(model: str, panels: str) -> str:
    """Return a model name with its flexible panels replaced by `panels`, such as "6 elements"; rigid stays rigid."""
    level = ModelLevel.of(model)
    return f"{level.name}:{panels}" if level.flexible else level.name


@dataclass(frozen=True)
class Motion:
    """Record of a run with nt samples and nj joints; a number that the program does not report is nan.

    `totals` maps names to (nj,) values. From the first latching on: "peak_force_N", the greatest contact force (with
    ideal joints the greatest reaction), "sliding_work_J", and the number of "impacts". Whole run: "wear_depth_m".
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
    """Return an ensemble member's parameters: initial joint rates sampled uniformly within RELEASE_RATE of the nominal.

    Member 0 has the nominal parameters. A slightly moved hinge would not do: lasting contact erases the difference.
    """
    rates = RELEASE_RATE * _deviations(member, len(parameters.joints))
    nominal = parameters.for_each_joint("initial_rate")
    return replace(parameters, initial_rate=tuple((nominal + rates).tolist()))


def perturbed_setting(value: float, member: int) -> float:
    """Return a tolerance or step, varied at random by a fraction SETTING_SHARE at most; member 0 has `value` itself."""
    return value * (1.0 + SETTING_SHARE * float(_deviations(member, 1, stream=1)[0]))


def _deviations(member: int, count: int, stream: int = 0) -> Array:
    """Return (count,) random numbers in [-1, 1], seeded by ensemble member and stream; zeros for member 0."""
    return np.random.default_rng([member, stream]).uniform(-1.0, 1.0, count) * (member > 0)


@dataclass(frozen=True)
class Level:
    """A model level with a tolerance, simulated with the level's default integrator.

    Attributes:
        model: name of the model level, such as "flexible-clearance:32 modes", see `ModelLevel`.
        tighter: divisor of the integrator's default tolerance.
    """

    model: str
    tighter: float = 1.0

    @property
    def size(self) -> str:
        """Panels and tolerance of the level in words: "rigid", "6 elements", "32 modes, rtol / 4"."""
        return self.panels.size if self.tighter == 1.0 else f"{self.panels.size}, rtol / {self.tighter:g}"

    @property
    def panels(self) -> ModelLevel:
        """`ModelLevel` of the name `model`: rigid or flexible panels, ideal joints or clearance, modes or elements."""
        return ModelLevel.of(self.model)

    @property
    def name(self) -> str:
        """Level in words, such as "rigid-ideal", or "flexible-clearance, 32 modes, rtol / 4" if `tighter` is 4."""
        return f"{self.panels.name}, {self.size}" if self.panels.flexible else self.panels.name

    def integrator(self, member: int = 0) -> RungeKutta:
        """Return the default integrator at this level's tolerance; ensemble members after 0 vary it by up to 0.3 %."""
        default = default_integrator(self.model)
        return replace(default, rtol=perturbed_setting(default.rtol, member) / self.tighter)

    def deploy(self, parameters: ArrayParameters, member: int, duration: float, output_step: float) -> Trajectory:
        """Return the trajectory of an ensemble's run `member` over `duration` [s], sampled every `output_step` [s].

        Initial joint rates and integration tolerances of members differ at random; member 0 has the nominal ones.

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
    """Simulate a scene with one of this library's integrators, without its warnings; return the `Motion`.

    Raises:
        SimulationError: if the run cannot go on.
    """
    with warnings.catch_warnings():  # the study measures the errors that the library warns of
        warnings.simplefilter("ignore", SimulationWarning)
        array = build(scene.parameters, scene.model)
        trajectory = simulate(array, scene.duration, integrator=integrator, output_step=scene.sample_step)
    return from_trajectory(trajectory)


def from_trajectory(trajectory: Trajectory) -> Motion:
    """Convert a trajectory of this library's simulator to a `Motion` record."""
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
    """Return the greatest error of latch times [s]: inf if one is missing, nan if the reference has no latching."""
    expected = np.isfinite(reference.latch_times)
    if not expected.any():
        return math.nan
    differences = np.abs(motion.latch_times - reference.latch_times)[expected]
    return float(np.where(np.isnan(differences), math.inf, differences).max())


def force_error(motion: Motion, reference: Motion) -> float:
    """Return the greatest relative error of a joint's peak force after latching; nan if the reference has no force."""
    right = reference.totals["peak_force_N"]
    errors = np.abs(motion.totals["peak_force_N"] / np.where(right > 0.0, right, math.nan) - 1.0)
    return math.nan if np.isnan(errors).all() else float(np.nanmax(errors))
