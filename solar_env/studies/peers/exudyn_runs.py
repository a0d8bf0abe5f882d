"""Runs of Exudyn: the solver settings that suit it best, and the motion of a run."""

import math
import time as clock
from typing import Any

import exudyn
import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline

from solar_env.array import has_clearance, has_flexible_panels
from solar_env.mechanics.running.errors import SimulationError
from solar_env.mechanics.running.trajectory import contact_record
from solar_env.studies.common.motion import Motion, Scene, no_contacts
from solar_env.studies.peers.exudyn_beams import joint_angles
from solar_env.studies.peers.exudyn_model import build_peer
from solar_env.studies.peers.exudyn_parts import PeerArray

Array = NDArray[np.float64]
_STAGES = {"RK44": 4, "ExplicitMidpoint": 2}


def run_exudyn(scene: Scene, solver: str, step: float) -> Motion:
    """A scene with one of Exudyn's solvers on one thread.

    Args:
        scene: what moves; of two panels.
        solver: "generalized-alpha" (index 3), or "explicit": for rigid panels, fourth order on a kinematic tree with
            ideal joints, second order with clearance.
        step: [s]; generalized-alpha halves it where Newton's iteration fails.

    Raises:
        ValueError: if the scene has what Exudyn's objects cannot express.
        SimulationError: if the run cannot go on.
    """
    explicit, clearance = solver == "explicit", has_clearance(scene.model)
    array = build_peer(scene, implicit=not explicit)
    name = "GeneralizedAlpha" if not explicit else "ExplicitMidpoint" if clearance else "RK44"
    settings = _settings(scene, step)
    printing, exudyn.config.printToConsole = exudyn.config.printToConsole, False
    begin = clock.perf_counter()
    try:
        done = array.system.SolveDynamic(settings, solverType=getattr(exudyn.DynamicSolverType, name))
    except (RuntimeError, ValueError) as error:
        raise SimulationError(f"Exudyn's {name} at {step:g} s stopped", 0.0, "peer") from error
    finally:
        wall_time = clock.perf_counter() - begin
        exudyn.config.printToConsole = printing
    if not done or not np.isfinite(array.system.systemData.GetODE2Coordinates()).all():
        raise SimulationError(f"Exudyn's {name} at {step:g} s did not reach the end", math.nan, "peer")
    counts = array.system.sys["dynamicSolver"].it
    steps = float(counts.currentStepIndex)
    evaluations = steps * _STAGES[name] if explicit else float(counts.newtonStepsCount) + steps
    contacts, totals = _contacts(array)
    return Motion(
        time=scene.sample_times,
        angles=_angles(array),
        latch_times=np.array(array.latch_times),
        contacts=contacts,
        wall_time=wall_time,
        steps=steps,
        evaluations=evaluations,
        factorizations=0.0 if explicit else float(counts.newtonJacobiCount),
        totals=totals,
    )


def _settings(scene: Scene, step: float) -> Any:
    flexible, clearance = has_flexible_panels(scene.model), has_clearance(scene.model)
    settings = exudyn.SimulationSettings()
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = step if scene.every_contact else scene.sample_step
    settings.parallel.numberOfThreads = 1
    integration = settings.timeIntegration
    integration.verboseMode = 0
    integration.endTime = scene.duration
    integration.numberOfSteps = max(1, round(scene.duration / step))
    integration.generalizedAlpha.spectralRadius = 0.6 if flexible and clearance else 0.9
    integration.generalizedAlpha.computeInitialAccelerations = True
    integration.newton.useModifiedNewton = True
    integration.newton.relativeTolerance = 1e-8
    integration.newton.absoluteTolerance = 1e-7 if flexible else 1e-10
    # Halve the step where Newton's iteration fails: every model with clearance would do so at its first impact.
    integration.adaptiveStep = True
    integration.discontinuous.useRecommendedStepSize = False
    return settings


def _angles(array: PeerArray) -> Array:
    """(nt, 2) joint angles [rad] at the scene's sample times, by Hermite interpolation between the sensors' data."""
    histories = [[array.system.GetSensorStoredData(sensor) for sensor in pair] for pair in array.rotations]
    times, rows = np.unique(histories[0][0][:, 0], return_index=True)

    def at_samples(node: int, column: int, start: float = 0.0) -> Array:
        place, rate = (history[rows, 1 + column] for history in histories[node])
        return np.asarray(CubicHermiteSpline(times, place + start, rate)(array.scene.sample_times))

    if len(histories) == 1:  # a kinematic tree
        first, second = at_samples(0, 3), -at_samples(0, 4)
    elif len(histories) == 3:
        base, inner, outer = (at_samples(node, 2) for node in range(3))
        first, second = inner - base, inner - outer
    else:
        slopes = [(at_samples(node, 2), at_samples(node, 3, start)) for node, start in ((1, -1.0), (2, -1.0), (3, 1.0))]
        first, second = joint_angles(at_samples(0, 2), *slopes)
    return np.unwrap(np.stack([first, second], axis=1), axis=0)


def _contacts(array: PeerArray) -> tuple[NDArray[np.void], dict[str, Array]]:
    """All contacts, and impulse and peak force after the first latching, from samples at every step."""
    if not array.contacts:
        return no_contacts(), {}
    latched = np.nanmin([*array.latch_times, math.inf])
    records: list[tuple[float, ...]] = []
    impulses, peaks = [], []
    for joint, (place, load) in enumerate(array.contacts):
        samples = array.system.GetSensorStoredData(place)
        time, gaps = samples[:, 0], np.hypot(samples[:, 1], samples[:, 2])
        force = np.linalg.norm(array.system.GetSensorStoredData(load)[:, 1:], axis=1)
        records += _contacts_of(joint, time, gaps - array.scene.parameters.by_joint("clearance", joint), force)
        after = time >= latched
        impulses.append(float(np.trapezoid(force[after], time[after])) if after.any() else 0.0)
        peaks.append(float(force[after].max(initial=0.0)))
    table = np.sort(np.array(records, dtype=contact_record), order="start_s")
    return table, {"impulse": np.array(impulses), "peak_force": np.array(peaks)}


def _contacts_of(joint: int, time: Array, depth: Array, force: Array) -> list[tuple[float, ...]]:
    """Records of one joint's contacts: starts by linear interpolation, peaks by a parabola through three samples."""
    inside = depth > 0.0
    starts = np.flatnonzero(~inside[:-1] & inside[1:]) + 1
    records: list[tuple[float, ...]] = []
    for start in starts:
        parted = np.flatnonzero(~inside[start:])
        end = start + int(parted[0]) if len(parted) else len(time) - 1
        share = depth[start - 1] / (depth[start - 1] - depth[start])
        began = time[start - 1] + share * (time[start] - time[start - 1])
        ended = float(time[end]) if len(parted) else math.nan
        records.append((joint, began, ended, math.nan, _peak(force[start - 1 : end + 1]), math.nan, math.nan))
    return records


def _peak(force: Array) -> float:
    top = int(np.argmax(force))
    if not 0 < top < len(force) - 1:
        return float(force[top])
    before, at, after = force[top - 1 : top + 2]
    curvature = before - 2.0 * at + after
    return float(at - 0.125 * (after - before) ** 2 / curvature) if curvature < 0.0 else float(at)
