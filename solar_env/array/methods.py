"""Which integrator a deployment gets: by name, or the model's default."""

from __future__ import annotations

from dataclasses import replace

from solar_env.array.parameters import has_flexible_panels
from solar_env.mechanics.integrators.settings import GeneralizedAlpha, Integrator, Rosenbrock, RungeKutta

INTEGRATORS = ("runge-kutta", "rosenbrock", "generalized-alpha", "paper")


def default_integrator(model: str) -> RungeKutta:
    """The integrator that a model gets when none is named.

    Linearly implicit with flexible panels, whose stiff vibrations would bound explicit steps. The tolerances come from
    measured errors: angles, latch times and statistics of impacts (``python -m solar_env chart``).
    """
    if has_flexible_panels(model):
        return Rosenbrock(rtol=1e-4)
    return RungeKutta(rtol=5e-7) if model.endswith("ideal") else RungeKutta(rtol=2e-6, impact_resolution=12.0)


def _adaptive(name: str, model: str) -> RungeKutta:
    """The adaptive integrator ``name`` with the tolerances that suit a model."""
    default = default_integrator(model)
    if name == default.name:
        return default
    return Rosenbrock(rtol=default.rtol) if name == Rosenbrock.name else RungeKutta(rtol=1e-5)


def make_integrator(name: str, model: str, step: float | None = None, rtol: float | None = None) -> Integrator:
    """An integrator by name, as the command line takes it.

    Args:
        name: "runge-kutta" or "rosenbrock" (adaptive; ``step`` bounds their steps), "generalized-alpha"
            (rho_inf = 0.8; fixed ``step``, or adaptive to ``rtol``) or "paper" (beta = 1/4, gamma = 1/2, fixed step,
            1e-4 s by default).
        model: one of ``array.MODELS``.
        step: [s].
        rtol: local error tolerance.

    Raises:
        ValueError: if the name is unknown or an option does not apply.
    """
    if name in (RungeKutta.name, Rosenbrock.name):
        default = _adaptive(name, model)
        return replace(
            default, rtol=default.rtol if rtol is None else rtol, max_step=default.max_step if step is None else step
        )
    if name == "generalized-alpha":
        return GeneralizedAlpha(step=1e-4 if step is None else step, rtol=rtol)
    if name == "paper":
        if rtol is not None:
            raise ValueError("rtol does not apply to the integrator 'paper', whose step is fixed; give a step")
        return GeneralizedAlpha(step=1e-4 if step is None else step, rho_inf=1.0)
    raise ValueError(f"integrator {name!r} is unknown; choose from {', '.join(INTEGRATORS)}")
