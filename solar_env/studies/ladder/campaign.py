"""Measurement of the error of every model level in each result of interest, and of the level's computing cost.

Levels range from rigid panels with ideal joints to flexible panels and joints with clearance. A result of interest,
such as "peak-force", is called a question. At every level the array deploys on springs alone and under fixed
controllers. Ensemble means of the results are compared with a finer reference level's means. Every ensemble member has
the same perturbation at all levels, so that common scatter cancels. The error bands are bootstrap bands over the
members (B. Efron, Ann. Statist. 7 (1979) 1), widened for small ensembles (T. C. Hesterberg, Am. Stat. 69 (2015) 371,
doi:10.1080/00031305.2015.1089789).
"""

import math
import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from scipy import stats

from solar_env.array import RELEASE_RATE, ArrayParameters, build, compilation_note
from solar_env.array.ladder import QUESTIONS, Answer
from solar_env.environment.task.task import VERSIONS
from solar_env.mechanics.analysis.geometry import centreline
from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.running.simulation import Simulation
from solar_env.studies.common.bootstrap import resampled_means
from solar_env.studies.common.motion import FINEST, SETTING_SHARE, Level, perturbed
from solar_env.studies.common.tables import Row, provenance, write_table
from solar_env.support.progress import counting_bar

Array = NDArray[np.float64]

FILE = "ladder.csv"
TASK = VERSIONS["v1"].task
RANKING = "controller-ranking"
_COVERAGE = 0.95  # coverage of the bands
SAMPLE_STEP = 0.02  # s; time between two samples of the tip's position
# Controllers without feedback: constant motor torque on the root hinge [N m], positive to open the hinge, and time [s]
# at which the torque sets in. Under these controllers the default array latches between 11 and 19 s.
CONTROLLERS = {
    "springs alone": (0.0, 0.0),
    "constant drive": (0.1, 0.0),
    "light brake": (-0.1, 0.0),
    "strong brake": (-0.28, 0.0),
    "late brake": (-0.3, 11.5),
}


@dataclass(frozen=True)
class Outcome:
    """Results of one ensemble member by name, with the wall time and number of right-hand side evaluations.

    A result is an array (k, d): "wear" has k joints and d = 1, the tip's path k sampled points and d = 2 coordinates.
    """

    answers: dict[str, Array]  # question -> (k, d): k quantities, each a vector of d components
    wall: float  # time taken [s]
    evaluations: float  # number of evaluations of the right-hand side


def deploy(level: Level, member: int, duration: float) -> Outcome:
    """Simulate an ensemble member's deployment at a model level, driven by springs alone, for `duration` [s].

    Return an `Outcome` with a result for each key of QUESTIONS, such as "peak-force", except "controller-ranking".

    Raises:
        ValueError: if a joint has not latched.
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
    """Simulate an ensemble member under every controller, each time until `window` [s] after the last latching.

    Returns:
        An `Outcome` whose `answers` hold, under the key RANKING, an array (controllers, 2): the sum of the joints' peak
        forces [N], and the sum of the joints' sliding work [J], both from the first latching on.

    Raises:
        ValueError: if a controller misses the environment's deadline, so that no ranking exists.
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
    """Apply motor `torque` [N m] from `start` [s]; end `window` [s] after all joints latch, else at TASK's deadline."""
    if start > 0.0:
        simulation.advance(start)
    simulation.set_motor_torque(TASK.driven_joints[0], torque)
    joints = simulation.state.joints
    while not joints["latched"].all() and simulation.time < TASK.deadline:
        simulation.advance(simulation.time + TASK.control_period)
    if joints["latched"].all():
        simulation.advance(joints["latch_time"].max() + window)


@dataclass(frozen=True)
class LadderPlan:
    """Plan of ensembles of slightly perturbed deployments to measure errors and costs of levels of model fidelity."""

    panels: tuple[str, ...] = (
        *(f"{elements} elements" for elements in (1, 2, 4, 6, 12)),
        *(f"{modes} modes" for modes in (8, 32)),
    )
    reference: Level = FINEST  # finer level with which all others are compared
    duration: float = 22.5  # duration of deployments on the springs alone [s]; the joints latch at 12.3 s
    members: int = 16
    ideal_members: int = 3  # members with ideal joints, which have no chaos to average over
    controlled_members: int = 8  # members under each controller
    window: float = 10.0  # time simulated after the last latching under a controller [s]

    @property
    def levels(self) -> tuple[Level, ...]:
        """The model levels, from rigid panels with ideal joints to the reference level."""
        flexible = (Level(f"flexible-{joint}:{panels}") for joint in ("ideal", "clearance") for panels in self.panels)
        return (Level("rigid-ideal"), Level("rigid-clearance"), *flexible, self.reference)

    @property
    def runs(self) -> list[tuple[Level, int, bool]]:
        """Runs (level, ensemble member, whether controlled); levels alternate, so that machine load slows all alike."""
        return [
            (level, member, controlled)
            for most, controlled in ((self.members, False), (self.controlled_members, True))
            for member in range(most)
            for level in self.levels
            if level.panels.clearance or member < self.ideal_members
        ]


FULL = LadderPlan()


def run_ladder(plan: LadderPlan, announce: Callable[[str], None]) -> list[Row]:
    """Simulate every run of a plan, and call `announce` with a run's name before the run starts.

    Return a table row for every question (key of `QUESTIONS`, such as "wear") and model level, with the columns of
    `solar_env.array.ladder.Answer`.
    """
    done: dict[bool, dict[Level, list[Outcome]]] = {
        controlled: {level: [] for level in plan.levels} for controlled in (False, True)
    }
    for level, member, controlled in plan.runs:
        announce(f"{level.name}, run {member + 1}{', controllers' * controlled}")
        run = control(level, member, plan.window) if controlled else deploy(level, member, plan.duration)
        done[controlled][level].append(run)
    rows: list[Row] = []
    for question in QUESTIONS:
        *levels, (_, reference) = done[question == RANKING].items()
        for level, runs in levels:
            error, half_width = error_of(question, runs, reference)
            answer = Answer(
                question,
                str(level.panels),
                error,
                half_width,
                statistics.median(run.wall for run in runs) / statistics.median(run.wall for run in reference),
                statistics.fmean(run.evaluations for run in runs),
                len(runs),
            )
            rows.append(dict(vars(answer)))
    return rows


def error_of(question: str, found: Sequence[Outcome], reference: Sequence[Outcome]) -> tuple[float, float]:
    """Return a model level's error in the result `question` (a key of QUESTIONS), and half the width of its 95 % band.

    `found` are the level's ensemble members; they are compared with the same members at the reference level. The error
    is relative to the reference's mean, for "tip-motion" to the array's length. For "controller-ranking" it is the
    fraction of controller pairs in the wrong order.
    """
    level, other = (np.stack([run.answers[question] for run in runs]) for runs in (found, reference[: len(found)]))
    if question == RANKING:
        return ranking_error(level, other)
    scale = np.abs(other.mean(axis=0)).sum(axis=-1)
    if question == "tip-motion":
        parameters = ArrayParameters()
        scale = np.full(other.shape[1], sum(parameters.panel(joint.index).length for joint in parameters.joints))
    return mean_error(level, other, scale)


def measure_ladder(plan: LadderPlan, path: Path, console: Console) -> None:
    """Run a plan's simulations, and write errors and costs to the table `path`; the plan FULL takes 15 minutes."""
    with counting_bar(console) as progress:
        methods = [level.integrator().name for level in plan.levels]
        task = progress.add_task(f"loading kernels{compilation_note(methods)}", total=len(plan.runs))
        _warm_up(plan)
        rows = run_ladder(plan, lambda run: progress.update(task, advance=1, description=run))
    made_by = provenance(
        "solar-env ladder",
        reference=plan.reference.name,
        parameters=f"the defaults of ArrayParameters; members released at rates within {RELEASE_RATE:g} rad/s",
        integrators=f"the default of each level; tolerances of members within {SETTING_SHARE:.1%}",
        duration_s=plan.duration,
        window_s=plan.window,
        controllers="; ".join(f"{name} ({torque:g} N m from {s:g} s)" for name, (torque, s) in CONTROLLERS.items()),
    )
    write_table(path, rows, made_by)


def _warm_up(plan: LadderPlan) -> None:
    """Simulate one sample step at every level, so that timings exclude compiling and loading."""
    for level in plan.levels:
        level.deploy(ArrayParameters(), 0, SAMPLE_STEP, SAMPLE_STEP)


def mean_error(level: Array, reference: Array, scale: Array) -> tuple[float, float]:
    """Return the greatest distance between two ensembles' means, and the half-width of a simultaneous 95 % band.

    With 95 % probability no quantity's true distance exceeds the sum of both. `level` and `reference` are (n, k, d)
    results of the same n ensemble members: k quantities, each a vector of d components. Each distance is divided by
    the quantity's scale in `scale` (k,).
    """
    differences = level - reference
    mean = differences.mean(axis=0)
    deviations = _widening(len(level)) * (resampled_means(differences) - mean)
    error, scattered = (np.linalg.norm(vectors, axis=-1) / scale for vectors in (mean, deviations))
    return float(error.max()), float(np.quantile(scattered.max(axis=-1), _COVERAGE))


def _widening(count: int) -> float:
    """Return the factor that corrects a bootstrap 95 % band of the mean for a small number `count` of values."""
    if count == 1:
        return 1.0
    share = 0.5 * (1.0 + _COVERAGE)
    return float(stats.t.ppf(share, count - 1) / stats.norm.ppf(share)) * math.sqrt(count / (count - 1))


def ranking_error(level: Array, reference: Array) -> tuple[float, float]:
    """Return the fraction of controller pairs that a model ranks unlike the reference, and its 95 % band's half-width.

    Oppositely ranked pairs count fully (M. G. Kendall, Biometrika 30 (1938) 81), ties half. `level` and `reference` are
    (n, controllers, quantities) results of the same n ensemble members at two model levels. The members' means rank the
    controllers by each quantity; the fraction is averaged over the quantities.
    """
    share = float(discordant_share(level.mean(axis=0), reference.mean(axis=0)))
    resampled = discordant_share(resampled_means(level), resampled_means(reference))
    return share, float(np.quantile(np.abs(resampled - share), _COVERAGE))


def discordant_share(level: Array, reference: Array) -> Array:
    """Return the fraction of controller pairs that two tables rank oppositely, averaged over quantities; ties half.

    The tables have shape (..., controllers, quantities); the result has the leading axes.
    """
    first, second = np.triu_indices(reference.shape[-2], k=1)
    signs = [np.sign(table[..., first, :] - table[..., second, :]) for table in (level, reference)]
    return np.asarray((1.0 - signs[0] * signs[1]).mean(axis=(-2, -1)) / 2.0)
