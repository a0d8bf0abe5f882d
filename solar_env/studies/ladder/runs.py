"""The runs of the ladder: a deployment on its springs alone, and under fixed controllers, at one level."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solar_env.array import ArrayParameters, build
from solar_env.array.deployment import simulate
from solar_env.array.ladder import level_name
from solar_env.environment.env import SolarArrayEnv
from solar_env.mechanics.analysis.geometry import centreline
from solar_env.mechanics.equations.build import compile_mechanism
from solar_env.mechanics.running.trajectory import Trajectory
from solar_env.studies.common.motion import perturbed

Array = NDArray[np.float64]

SAMPLE_STEP = 0.02  # s, between two places of the tip


@dataclass(frozen=True)
class Level:
    """A level of the model.

    Attributes:
        model: one of `array.MODELS`.
        elements: of each flexible panel; 0 with rigid panels.
    """

    model: str
    elements: int = 0

    @property
    def name(self) -> str:
        """The level in words."""
        return level_name(self.model, self.elements)

    @property
    def panel_elements(self) -> int:
        """A number of elements that every model takes; rigid ones do not use it."""
        return max(self.elements, 1)


@dataclass(frozen=True)
class Profile:
    """A controller that does not look: a constant motor torque on the root hinge from some time on.

    Attributes:
        name: in words.
        torque: positive opens [N m].
        start: when it sets in [s].
    """

    name: str
    torque: float
    start: float = 0.0


# They latch the default array between 11 and 19 s.
CONTROLLERS = (
    Profile("springs alone", 0.0),
    Profile("constant drive", 0.1),
    Profile("light brake", -0.1),
    Profile("strong brake", -0.28),
    Profile("late brake", -0.3, start=11.5),
)


@dataclass(frozen=True)
class Outcome:
    """Answers and cost of one run, or of one run under each controller.

    Attributes:
        answers: question -> (k, d) quantities that are vectors of d components.
        wall: time taken [s].
        evaluations: of the right-hand side.
    """

    answers: dict[str, Array]
    wall: float
    evaluations: float


def deploy(level: Level, member: int, duration: float) -> Outcome:
    """Deploy a member of the ensemble on the springs alone, for a duration [s], with the level's default integrator.

    Returns:
        Every question's answer but the ranking of controllers.

    Raises:
        ValueError: if a joint has not latched.
        SimulationError: if the run cannot go on.
    """
    trajectory = simulate(
        perturbed(ArrayParameters(), member),
        model=level.model,
        elements=level.panel_elements,
        duration=duration,
        output_step=SAMPLE_STEP,
    )
    if np.isnan(trajectory.latch_times).any():
        raise ValueError(f"{level.name} has not latched within {duration:g} s; simulate longer")
    by_joint = {
        "latch-time": trajectory.latch_times,
        "peak-force": trajectory.postlock_peak_force,
        "wear": trajectory.postlock_sliding_work,
        "impact-count": _impacts_after_latching(trajectory),
        "impulse": trajectory.postlock_impulse,
    }
    answers = {question: values[:, np.newaxis] for question, values in by_joint.items()}
    answers["tip-motion"] = _tip(trajectory, level)
    details = trajectory.metadata
    return Outcome(answers, float(details["wall_time_s"]), float(details["evaluations"]))


def _impacts_after_latching(trajectory: Trajectory) -> Array:
    contacts = trajectory.contacts[trajectory.contacts["start_s"] > trajectory.latch_times.min()]
    return np.bincount(contacts["joint"], minlength=len(trajectory.latch_times)).astype(float)


def _tip(trajectory: Trajectory, level: Level) -> Array:
    """(nt, 2) places of the outermost panel's free end in inertial axes [m]."""
    parameters = ArrayParameters().with_changes(trajectory.metadata["parameters"])
    model, _ = compile_mechanism(build(parameters, level.model, level.panel_elements))
    return np.asarray(centreline(model, trajectory.coordinates, parameters.panel_count, 1)[:, -1])


def control(level: Level, member: int, window: float, announce: Callable[[str], None]) -> Outcome:
    """Deploy a member of the ensemble under every one of CONTROLLERS in the Gymnasium environment.

    Args:
        level, member: what runs.
        window: time simulated after the last latching [s].
        announce: called with the controller's name before each run.

    Returns:
        "controller-ranking": (controllers, 2) peak force [N] and sliding work [J] after the first latching, summed over
        the joints as the environment's reward does.

    Raises:
        ValueError: if a controller misses the deadline, so that there is nothing to rank.
        SimulationError: if a run cannot go on.
    """
    parameters = perturbed(ArrayParameters(), member)
    env = SolarArrayEnv(model=level.model, parameters=parameters, elements=level.panel_elements, postlock_window=window)
    measures, evaluations, wall = [], 0.0, 0.0
    for profile in CONTROLLERS:
        announce(profile.name)
        start = time.perf_counter()
        figures = _episode(env, profile)
        wall += time.perf_counter() - start
        evaluations += float(env.simulation.state.clock["evaluations"][0])
        if not figures["latched"]:
            raise ValueError(f"{profile.name} with {level.name} misses the deadline")
        measures.append([sum(figures["peak_postlock_force_N"]), sum(figures["postlock_sliding_work_J"])])
    return Outcome({"controller-ranking": np.array(measures)}, wall, evaluations)


def _episode(env: SolarArrayEnv, profile: Profile) -> dict[str, Any]:
    """Physical figures of one episode."""
    _, info = env.reset()
    while "deployment" not in info:
        acting = info["time_s"] >= profile.start - 0.5 * env.task.control_period
        _, _, _, _, info = env.step([profile.torque / env.task.torque_limit if acting else 0.0])
    figures: dict[str, Any] = info["deployment"]
    return figures
