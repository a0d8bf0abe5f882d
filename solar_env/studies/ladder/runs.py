"""The runs of the ladder: a deployment on its springs alone, and under fixed controllers, at one level."""

import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from solar_env.array import ArrayParameters, build
from solar_env.environment.task.task import PRESENT
from solar_env.mechanics.analysis.geometry import centreline
from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.integrators.methods.table import METHODS
from solar_env.mechanics.running.simulation import Simulation
from solar_env.mechanics.running.trajectory import Trajectory
from solar_env.studies.common.levels import Level
from solar_env.studies.common.motion import perturbed

Array = NDArray[np.float64]

SAMPLE_STEP = 0.02  # s, between two places of the tip


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

    @classmethod
    def of_all(cls, runs: Sequence[Self]) -> Self:
        """Runs under several controllers as one."""
        answers = {question: np.concatenate([run.answers[question] for run in runs]) for question in runs[0].answers}
        return cls(answers, sum(run.wall for run in runs), sum(run.evaluations for run in runs))


def deploy(level: Level, member: int, duration: float) -> Outcome:
    """Deploy a member of the ensemble on the springs alone, for a duration [s].

    Returns:
        Every question's answer but the ranking of controllers.

    Raises:
        ValueError: if a joint has not latched.
        SimulationError: if the run cannot go on.
    """
    trajectory = level.deploy(ArrayParameters(), member, duration, SAMPLE_STEP)
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
    details = trajectory.metadata
    parameters = ArrayParameters().with_changes(details["parameters"])
    array = build(parameters, level.model)
    model, _ = METHODS[details["integrator"]].formulation.compile(array)
    return np.asarray(centreline(model, trajectory.coordinates, parameters.joints[-1].panel, 1)[:, -1])


def control(level: Level, member: int, profile: Profile, window: float) -> Outcome:
    """Deploy a member of the ensemble under a controller, up to a time [s] after the last latching.

    Returns:
        "controller-ranking": (1, 2) peak force [N] and sliding work [J] after the first latching, summed over the
        joints as the environment's reward does.

    Raises:
        ValueError: if the controller misses the environment's deadline, so that there is nothing to rank.
        SimulationError: if the run cannot go on.
    """
    array = build(perturbed(ArrayParameters(), member), level.model)
    simulation = Simulation(array, level.integrator(member))
    start = time.perf_counter()
    _drive(simulation, profile, window)
    wall = time.perf_counter() - start
    state, joints = simulation.state, simulation.state.joints
    if not joints["latched"].all():
        raise ValueError(f"{profile.name} with {level.name} misses the deadline")
    work = m.joint_integrals(state.integrals)[:, m.SLIDING_WORK] - joints["lock_sliding_work"]
    measures = np.array([[joints["postlock_peak_force"].sum(), work.sum()]])
    return Outcome({"controller-ranking": measures}, wall, float(state.clock["evaluations"][0]))


def _drive(simulation: Simulation, profile: Profile, window: float) -> None:
    """Simulate up to a time [s] after the last latching, or to the deadline if a joint is still open."""
    if profile.start > 0.0:
        simulation.advance(profile.start)
    simulation.set_motor_torque(PRESENT.task.driven_joint, profile.torque)
    joints = simulation.state.joints
    while not joints["latched"].all() and simulation.time < PRESENT.task.deadline:
        simulation.advance(simulation.time + PRESENT.task.control_period)
    if joints["latched"].all():
        simulation.advance(joints["latch_time"].max() + window)
