"""Simulation of a whole deployment, from array parameters and a model level to a trajectory."""

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from solar_env.array.construction import build, main_body_frame
from solar_env.array.level import ModelLevel
from solar_env.array.methods import announce_compilation, make_integrator, mark_compiled
from solar_env.array.parameters import ArrayParameters
from solar_env.mechanics.analysis.geometry import centreline
from solar_env.mechanics.equations.formulation import ModelArrays
from solar_env.mechanics.integrators.methods.table import METHODS
from solar_env.mechanics.integrators.settings import Integrator
from solar_env.mechanics.running.simulation import simulate as simulate_mechanism
from solar_env.mechanics.running.trajectory import Trajectory


def simulate(
    parameters: ArrayParameters | Mapping[str, object] | None = None,
    *,
    preset: str = "default",
    model: str | ModelLevel = "rigid-clearance",
    duration: float = 30.0,
    integrator: Integrator | str | None = None,
    rtol: float | None = None,
    output_step: float = 0.01,
    progress: Callable[[float], None] | None = None,
) -> Trajectory:
    """Simulate a deployment from the folded array, by default at rest.

    Args:
        parameters: a parameter set, or changes by name to the preset.
        preset: name of the parameter set that the changes modify, see `ArrayParameters.preset`.
        model: level of model fidelity, such as "flexible-clearance:8 modes", see `ModelLevel`.
        duration: simulated time [s].
        integrator, rtol: settings of an integrator, such as `RungeKutta(rtol=1e-8)`; or the name of an integrator, such
            as "rosenbrock", and a local error tolerance; see `array.methods.make_integrator`.
        output_step: time between samples [s]; independent of the integration step.
        progress: function that is called repeatedly with the simulated time [s]; it does not affect the result.

    Returns:
        The trajectory. With flexible panels and the explicit integrator, its metadata count `stability_bound_steps`:
        steps that numerical stability for the panels' axial vibration kept short. If there are many, a looser tolerance
        does not make the run cheaper.

    Raises:
        ValueError: for an unknown name or a refused value, or if arguments contradict each other.
        SimulationError: if the run cannot continue.

    Warns:
        SimulationWarning: if the result may be inaccurate, see `Simulation.check`; or if the contact law does not
            reproduce the given restitution.
    """
    if not isinstance(parameters, ArrayParameters):
        parameters = ArrayParameters.preset(preset).with_changes(parameters or {})
    level = ModelLevel.of(model)
    method = make_integrator(integrator, level, rtol=rtol)
    announce_compilation(method.name)
    trajectory = simulate_mechanism(
        build(parameters, level),
        duration,
        integrator=method,
        output_step=output_step,
        progress=progress,
        metadata={"model": str(level), "parameters": parameters.to_dict()},
    )
    mark_compiled(method.name)
    return trajectory


def compiled(trajectory: Trajectory) -> tuple[ArrayParameters, ModelArrays]:
    """Rebuild from metadata the array parameters of a deployment, and the compiled model that it simulated."""
    details = trajectory.metadata
    parameters = ArrayParameters().with_changes(details["parameters"])
    mechanism = build(parameters, details["model"])
    return parameters, METHODS[details["integrator"]].formulation.compile(mechanism)[0]


def hub_place(parameters: ArrayParameters, model: ModelArrays, q: NDArray[np.float64]) -> NDArray[np.float64]:
    """Compute the main body's centroid x, y [m] and angle [rad], -pi to pi, (nt, 3), from coordinates `q` (nt, n)."""
    centroid, along, _ = main_body_frame(parameters, centreline(model, q, 0))
    return np.column_stack([centroid, np.arctan2(along[:, 1], along[:, 0])])


def hub_turn(trajectory: Trajectory) -> NDArray[np.float64]:
    """Compute the main body's rotation angle since the first sample, at every sample (nt,) [rad]."""
    angle = np.unwrap(hub_place(*compiled(trajectory), trajectory.coordinates)[:, 2])
    return np.asarray(angle - angle[0])


def panel_deflections(trajectory: Trajectory) -> NDArray[np.float64]:
    """Compute how far the middle of every panel lies off the chord between the panel's ends, at every sample.

    Returns:
        Deflections (nt, panels) [m]; positive to the left, seen from the inner hinge towards the tip.
    """
    parameters, model = compiled(trajectory)
    deflections = []
    for joint in parameters.joints:
        points = centreline(model, trajectory.coordinates, joint.panel, 2)
        chord, arm = points[:, -1] - points[:, 0], points[:, points.shape[1] // 2] - points[:, 0]
        across = chord[:, 0] * arm[:, 1] - chord[:, 1] * arm[:, 0]
        deflections.append(across / np.hypot(chord[:, 0], chord[:, 1]))
    return np.stack(deflections, axis=1)
