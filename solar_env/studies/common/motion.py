"""Scenes and levels that studies simulate, motions (the record of a run, whichever program made it), their errors."""

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

# Of the runs of an ensemble: settings of the method, within this share of the nominal one.
SETTING_SHARE = 3e-3


@dataclass(frozen=True)
class Scene:
    """A deployment from rest."""

    model: str  # the level as a word, see `ModelLevel`
    parameters: ArrayParameters
    duration: float  # s
    sample_step: float  # distance of the sampled angles [s]
    forces_kept: bool = False  # whether programs that sample peak contact forces must do so at every step

    @property
    def level(self) -> ModelLevel:
        """The parts of the model's word."""
        return ModelLevel.of(self.model)

    @property
    def sample_times(self) -> Array:
        """(nt,) times of the samples [s], from 0 to the duration."""
        count = math.ceil(self.duration / self.sample_step - 1e-9)
        return np.append(np.arange(count) * self.sample_step, self.duration)


def with_panels(model: str, panels: str) -> str:
    """The word of a model whose flexible panels consist of `panels`, as "6 elements"; rigid ones do of nothing."""
    level = ModelLevel.of(model)
    return f"{level.name}:{panels}" if level.flexible else level.name


@dataclass(frozen=True)
class Motion:
    """A run: nt samples, nj joints; nan where the program that made it does not say.

    Totals (nj,) are what a run comes to after its first latching: "peak_force_N", the greatest contact force or, with
    ideal joints, reaction; "sliding_work_J"; "impacts", their number; and "wear_depth_m", that of the whole run.
    """

    time: Array  # (nt,) [s]
    angles: Array  # (nt, nj) [rad]
    latch_times: Array  # (nj,) [s], nan if not latched
    wall_time: float  # of the integration alone, without compiling or assembling [s]
    steps: float = math.nan
    evaluations: float = math.nan  # of the right-hand side or residual
    factorizations: float = math.nan
    energy_residual: float = math.nan  # energy that the books do not account for, over the energy put in
    totals: dict[str, Array] = field(default_factory=dict)


def perturbed(parameters: ArrayParameters, member: int) -> ArrayParameters:
    """The array of a member of an ensemble: joints released at rates uniform within RELEASE_RATE of the nominal ones.

    Differences in the place of a hinge would not do: the lasting contact of the deployment wipes them out, and at the
    latching all members would be alike. Member 0 is the nominal array.
    """
    rates = RELEASE_RATE * _deviations(member, len(parameters.joints))
    nominal = parameters.for_each_joint("initial_rate")
    return replace(parameters, initial_rate=tuple((nominal + rates).tolist()))


def perturbed_setting(value: float, member: int) -> float:
    """Tolerance or step of a member of an ensemble: uniform within SETTING_SHARE of the nominal, which member 0 has."""
    return value * (1.0 + SETTING_SHARE * float(_deviations(member, 1, stream=1)[0]))


def _deviations(member: int, count: int, stream: int = 0) -> Array:
    """(count,) numbers in [-1, 1], the same for the same member and stream; zero for member 0."""
    return np.random.default_rng([member, stream]).uniform(-1.0, 1.0, count) * (member > 0)


@dataclass(frozen=True)
class Level:
    """A level of the model, simulated with its default integrator.

    Attributes:
        model: the level as a word, see `ModelLevel`.
        tighter: what the tolerance of the integrator is divided by.
    """

    model: str
    tighter: float = 1.0

    @property
    def size(self) -> str:
        """Panels and tolerance in words: "rigid", "6 elements", "32 modes, rtol / 4"."""
        return self.panels.size if self.tighter == 1.0 else f"{self.panels.size}, rtol / {self.tighter:g}"

    @property
    def panels(self) -> ModelLevel:
        """The word's parts."""
        return ModelLevel.of(self.model)

    @property
    def name(self) -> str:
        """The level in words."""
        return f"{self.panels.name}, {self.size}" if self.panels.flexible else self.panels.name

    def integrator(self, member: int = 0) -> RungeKutta:
        """The integrator of a member of an ensemble."""
        default = default_integrator(self.model)
        return replace(default, rtol=perturbed_setting(default.rtol, member) / self.tighter)

    def deploy(self, parameters: ArrayParameters, member: int, duration: float, output_step: float) -> Trajectory:
        """Simulate a member of an ensemble of deployments, see `perturbed`.

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
"""Finer than all levels of the ladder; beams come down to it with 48 elements."""


def run_ours(scene: Scene, integrator: Integrator) -> Motion:
    """A scene with one of our integrators.

    Raises:
        SimulationError: if the run cannot go on.
    """
    with warnings.catch_warnings():  # what the library warns of is measured here
        warnings.simplefilter("ignore", SimulationWarning)
        array = build(scene.parameters, scene.model)
        trajectory = simulate(array, scene.duration, integrator=integrator, output_step=scene.sample_step)
    return from_trajectory(trajectory)


def from_trajectory(trajectory: Trajectory) -> Motion:
    """Motion of a run of our simulator."""
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
    """Greatest difference of a joint angle [rad] at the common samples of a motion and its reference up to a time [s].

    Raises:
        ValueError: if the samples lie at other times.
    """
    if motion.time.shape != reference.time.shape or not np.allclose(motion.time, reference.time, rtol=0.0, atol=1e-9):
        raise ValueError("the samples of the two motions lie at different times")
    counted = reference.time <= until + 1e-9
    return float(np.abs(motion.angles - reference.angles)[counted].max())


def latch_error(motion: Motion, reference: Motion) -> float:
    """Greatest difference of a latch time [s]; inf if a joint that should have latched has not, nan if none should."""
    expected = np.isfinite(reference.latch_times)
    if not expected.any():
        return math.nan
    differences = np.abs(motion.latch_times - reference.latch_times)[expected]
    return float(np.where(np.isnan(differences), math.inf, differences).max())


def force_error(motion: Motion, reference: Motion) -> float:
    """Greatest relative error of a joint's peak force after the first latching; nan where the reference has none."""
    right = reference.totals["peak_force_N"]
    errors = np.abs(motion.totals["peak_force_N"] / np.where(right > 0.0, right, math.nan) - 1.0)
    return math.nan if np.isnan(errors).all() else float(np.nanmax(errors))
