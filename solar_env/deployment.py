"""Simulating a deployment of the array as a whole: parameters and model level in, trajectory out."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from .array import ArrayParameters, build
from .integrators import default_integrator
from .mechanics.integrators import Integrator
from .mechanics.simulation import simulate as simulate_mechanism
from .mechanics.trajectory import Trajectory


def simulate(
    parameters: ArrayParameters | Mapping[str, Any] | None = None,
    *,
    model: str = "rigid-clearance",
    duration: float = 30.0,
    integrator: Integrator | None = None,
    output_step: float = 0.01,
    progress: Callable[[float], None] | None = None,
) -> Trajectory:
    """Simulate a deployment from the folded array at rest.

    Args:
        parameters: a parameter set, or changes to the default one by name.
        model: "rigid-ideal" or "rigid-clearance".
        duration: [s].
        integrator: defaults to :func:`default_integrator` of the model.
        output_step: distance of the samples [s]; independent of the integration step.
        progress: called with the simulated time now and then.

    Raises:
        ValueError: for an unknown model, parameter or value.
        SimulationError: if the run cannot go on.
    """
    if not isinstance(parameters, ArrayParameters):
        parameters = ArrayParameters().with_changes(parameters or {})
    return simulate_mechanism(
        build(parameters, model),
        duration,
        integrator=integrator or default_integrator(model),
        output_step=output_step,
        progress=progress,
        metadata={"model": model, "parameters": parameters.to_dict()},
    )
