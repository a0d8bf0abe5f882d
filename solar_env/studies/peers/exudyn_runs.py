"""Runs of Exudyn, with solver settings that suit the deployments best, and their conversion to `Motion` records."""

import math
import time as clock
from typing import Any

import exudyn
import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline

from solar_env.mechanics.running.errors import SimulationError
from solar_env.studies.common.motion import Motion, Scene
from solar_env.studies.peers.exudyn_arrays import build_peer
from solar_env.studies.peers.exudyn_parts import PeerArray

Array = NDArray[np.float64]
_STAGES = {"RK44": 4, "ExplicitMidpoint": 2}


def run_exudyn(scene: Scene, solver: str, step: float) -> Motion:
    """Simulate a deployment with one of Exudyn's solvers on one thread, at a step [s]; return the `Motion` record.

    "generalized-alpha" (index 3) halves the step where Newton's iteration fails. "explicit", for rigid panels only, has
    fourth order (on a kinematic tree) with ideal joints, and second order with clearance.
    """
    explicit, clearance = solver == "explicit", scene.level.clearance
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
    return Motion(
        time=scene.sample_times,
        angles=_angles(array),
        latch_times=np.array(array.latch_times),
        wall_time=wall_time,
        steps=steps,
        evaluations=evaluations,
        factorizations=0.0 if explicit else float(counts.newtonJacobiCount),
        totals=_peak_forces(array),
    )


def _settings(scene: Scene, step: float) -> Any:
    flexible, clearance = scene.level.flexible, scene.level.clearance
    settings = exudyn.SimulationSettings()
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = step if scene.forces_kept else scene.sample_step
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
    # Halve the step where Newton's iteration fails: at the full step it fails at the first impact in a clearance.
    integration.adaptiveStep = True
    integration.discontinuous.useRecommendedStepSize = False
    return settings


def _angles(array: PeerArray) -> Array:
    """Return (nt, 2) joint angles [rad] at the deployment's sample times, by Hermite interpolation of sensor data."""
    values = []
    for node, column, rest in array.watched:
        places, rates = (array.system.GetSensorStoredData(sensor) for sensor in array.sensors[node])
        times, rows = np.unique(places[:, 0], return_index=True)
        spline = CubicHermiteSpline(times, places[rows, 1 + column] + rest, rates[rows, 1 + column])
        values.append(spline(array.scene.sample_times))
    return np.unwrap(np.stack(array.angles(*values), axis=1), axis=0)


def _peak_forces(array: PeerArray) -> dict[str, Array]:
    """Return the joints' peak contact forces [N] after the first latching, over all steps; empty if not recorded."""
    if not array.contacts:
        return {}
    latched = np.nanmin([*array.latch_times, math.inf])
    samples = [array.system.GetSensorStoredData(sensor) for sensor in array.contacts]
    forces = [np.linalg.norm(rows[rows[:, 0] >= latched, 1:], axis=1).max(initial=0.0) for rows in samples]
    return {"peak_force_N": np.array(forces)}
