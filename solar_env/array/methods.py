"""Choice of a deployment's integrator by name or model level, and messages that its kernels must first be compiled."""

import sys
from collections.abc import Iterable
from functools import cache
from pathlib import Path
from typing import Any

from solar_env.array.level import MODELS, ModelLevel
from solar_env.mechanics.integrators.settings import (
    INTEGRATORS,
    GeneralizedAlpha,
    Integrator,
    ModalRadau,
    Rosenbrock,
    RungeKutta,
)

PAPER = "paper"
# Names of integrators on the command line: every integrator, and "paper" for one with the paper's settings.
INTEGRATOR_NAMES = (*INTEGRATORS, PAPER)


def default_integrator(model: str | ModelLevel) -> RungeKutta:
    """Return the default integrator of a model level.

    Panels of ANCF cable elements get the linearly implicit `Rosenbrock`, because their stiff vibrations would limit
    explicit steps. Modal panels get `ModalRadau`, rigid panels `RungeKutta`. The tolerances follow from measured errors
    in angles, latch times and impact statistics (`solar-env study precision`).
    """
    level = ModelLevel.of(model)
    if level.modal:
        return ModalRadau()
    if level.flexible:
        return Rosenbrock(rtol=1e-4)
    return RungeKutta(rtol=2e-6, impact_resolution=12.0) if level.clearance else RungeKutta(rtol=5e-7)


def make_integrator(
    integrator: Integrator | str | None,
    model: str | ModelLevel,
    step: float | None = None,
    rtol: float | None = None,
) -> Integrator:
    """Return the integrator that a user chooses by name or by settings, or the default of the model level.

    Args:
        integrator: settings; None for the default; or a name: "runge-kutta", "rosenbrock" and "modal-radau" adapt their
            steps; "generalized-alpha" (rho_inf = 0.8) takes fixed steps, 1e-4 s by default; "paper" is the latter with
            beta = 1/4, gamma = 1/2.
        model: level of model fidelity or its name, see `ModelLevel`.
        step: fixed step size, or greatest adaptive step size [s].
        rtol: local error tolerance.

    Raises:
        ValueError: `integrator` is unknown or cannot integrate the level's panels, or an option does not apply to it.
    """
    level = ModelLevel.of(model)
    default = default_integrator(level)
    methods: dict[Any, Integrator] = {
        **{name: kind() for name, kind in INTEGRATORS.items()},
        RungeKutta.name: RungeKutta(rtol=1e-5),
        Rosenbrock.name: Rosenbrock(rtol=default.rtol),
        PAPER: GeneralizedAlpha(rho_inf=1.0),
        default.name: default,
        None: default,
    }
    if isinstance(integrator, (RungeKutta, GeneralizedAlpha)):
        chosen = integrator
        if step is not None or rtol is not None:
            raise ValueError(f"rtol = {rtol!r} beside integrator = {integrator!r}: give it in its settings alone")
    elif integrator in methods:
        chosen = methods[integrator]
    else:
        known = (*INTEGRATOR_NAMES, *(f"{kind.__name__}(...)" for kind in INTEGRATORS.values()))
        raise ValueError(f"integrator {integrator!r} is unknown; choose from {', '.join(known)}")
    if level.flexible and level.modal != isinstance(chosen, ModalRadau):
        kind, other = ("modes", "beam elements") if level.modal else ("beam elements", "modes")
        instead = f"{level.name}:6 elements" if level.modal else level.name
        raise ValueError(
            f"integrator = {chosen.name!r} steps panels of {other}, and those of model = {str(level)!r} are of "
            f"{kind}: choose the model {instead!r}, or leave out the integrator"
        )
    return chosen.with_options(step, rtol)


def kernels_are_compiled(integrator: str) -> bool:
    """Return whether the cache has an integrator's kernels for the present sources, or compilation is switched off."""
    import numba

    return bool(numba.config.DISABLE_JIT) or _mark(integrator).exists()


def compilation_note(integrators: Iterable[str]) -> str:
    """Return a remark that kernels of the integrators will be compiled first; empty if all are compiled already."""
    return "" if all(map(kernels_are_compiled, integrators)) else " (compiles kernels first: minutes, this time alone)"


@cache
def announce_compilation(integrator: str) -> None:
    """Print once per process, on standard error, that an integrator's kernels are going to be compiled."""
    if not kernels_are_compiled(integrator):
        told = f"solar_env compiles the kernels of {integrator}: about two minutes, this once; later runs load them"
        print(told, file=sys.stderr, flush=True)


@cache
def mark_compiled(integrator: str) -> None:
    """Record that an integrator's kernels are compiled, by creating a file beside the cached kernels."""
    _mark(integrator).touch()


def _mark(integrator: str) -> Path:
    """Return the path of the file, beside the cached kernels, that marks an integrator's kernels as compiled."""
    from solar_env.mechanics.integrators import run
    from solar_env.mechanics.numerics.jit import cache_folder

    method = make_integrator(integrator, MODELS[0]).name
    return Path(cache_folder(Path(run.__file__).resolve())) / f"{method}.compiled"
