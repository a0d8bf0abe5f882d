"""The runs of the ladder: a deployment on its springs alone, and under fixed controllers, at one level."""

import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from solar_env.array import ArrayParameters, build
from solar_env.environment.task.versions import PRESENT
from solar_env.mechanics.analysis.geometry import centreline
from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.running.simulation import Simulation
from solar_env.studies.common.levels import Level
from solar_env.studies.common.motion import perturbed

Array = NDArray[np.float64]

RANKING = "controller-ranking"
SAMPLE_STEP = 0.02  # s, between two places of the tip
# Constant motor torques on the root hinge [N m], positive opens, and when they set in [s]: controllers that do not
# look. They latch the default array between 11 and 19 s.
CONTROLLERS = {
    "springs alone": (0.0, 0.0),
    "constant drive": (0.1, 0.0),
    "light brake": (-0.1, 0.0),
    "strong brake": (-0.28, 0.0),
    "late brake": (-0.3, 11.5),
}


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
    """Deploy a member of the ensemble on the springs alone, for a duration [s].

    Returns:
        Every question's answer but the ranking of controllers.

    Raises:
        ValueError: if a joint has not latched.
        SimulationError: if the run cannot go on.
    """
    run = level.deploy(ArrayParameters(), member, duration, SAMPLE_STEP)
    if np.isnan(run.latch_times).any():
        raise ValueError(f"{level.name} has not latched within {duration:g} s; simulate longer")
    late = run.contacts[run.contacts["start_s"] > run.latch_times.min()]
    by_joint = {
        "latch-time": run.latch_times,
        "peak-force": run.postlock_peak_force,
        "wear": run.postlock_sliding_work,
        "impact-count": np.bincount(late["joint"], minlength=len(run.latch_times)).astype(float),
        "impulse": run.postlock_impulse,
    }
    answers = {question: values[:, np.newaxis] for question, values in by_joint.items()}
    array = ArrayParameters()
    model = Simulation(build(array, level.model), level.integrator()).model
    answers["tip-motion"] = centreline(model, run.coordinates, array.joints[-1].panel, 1)[:, -1]
    return Outcome(answers, float(run.metadata["wall_time_s"]), float(run.metadata["evaluations"]))


def control(level: Level, member: int, window: float) -> Outcome:
    """Deploy a member of the ensemble under every controller, each up to a time [s] after the last latching.

    Returns:
        RANKING: (controllers, 2) peak force [N] and sliding work [J] after the first latching, summed over the joints
        as the environment's reward does.

    Raises:
        ValueError: if a controller misses the environment's deadline, so that there is nothing to rank.
        SimulationError: if the run cannot go on.
    """
    array, measures, evaluations, wall = build(perturbed(ArrayParameters(), member), level.model), [], 0.0, 0.0
    for name, (torque, start) in CONTROLLERS.items():
        simulation = Simulation(array, level.integrator(member))
        begun = time.perf_counter()
        _drive(simulation, torque, start, window)
        wall += time.perf_counter() - begun
        state, joints = simulation.state, simulation.state.joints
        if not joints["latched"].all():
            raise ValueError(f"{name} with {level.name} misses the deadline")
        work = m.joint_integrals(state.integrals)[:, m.SLIDING_WORK] - joints["lock_sliding_work"]
        measures.append([joints["postlock_peak_force"].sum(), work.sum()])
        evaluations += float(state.clock["evaluations"][0])
    return Outcome({RANKING: np.array(measures)}, wall, evaluations)


def _drive(simulation: Simulation, torque: float, start: float, window: float) -> None:
    """Simulate up to a time [s] after the last latching, or to the deadline if a joint is still open."""
    if start > 0.0:
        simulation.advance(start)
    simulation.set_motor_torque(PRESENT.task.driven_joint, torque)
    joints = simulation.state.joints
    while not joints["latched"].all() and simulation.time < PRESENT.task.deadline:
        simulation.advance(simulation.time + PRESENT.task.control_period)
    if joints["latched"].all():
        simulation.advance(joints["latch_time"].max() + window)
