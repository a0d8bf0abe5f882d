"""The integrator of a deployment: by name, or the model's default."""

from dataclasses import replace

from solar_env.array.models import has_clearance, has_flexible_panels
from solar_env.array.panels import MODAL, PanelModel
from solar_env.mechanics.integrators.settings import (
    INTEGRATORS,
    GeneralizedAlpha,
    Integrator,
    ModalRadau,
    Rosenbrock,
    RungeKutta,
)

PAPER = "paper"
_LANDING_SPEED = 0.03  # m/s
# Names on the command line: every method, and the paper's choice of one.
INTEGRATOR_NAMES = (*INTEGRATORS, PAPER)


def default_integrator(model: str, panels: PanelModel | None = None) -> RungeKutta:
    """The integrator that a model gets when none is named.

    Linearly implicit with panels of beam elements, whose stiff vibrations would bound explicit steps; that of modal
    panels is their own. The tolerances come from measured errors: angles, latch times and statistics of impacts
    (`solar-env study precision`).
    """
    if has_flexible_panels(model):
        modal = PanelModel.of(model, panels).kind == MODAL
        return _modal_radau(model) if modal else Rosenbrock(rtol=1e-4)
    return RungeKutta(rtol=2e-6, impact_resolution=12.0) if has_clearance(model) else RungeKutta(rtol=5e-7)


def landing_integrator(model: str, panels: PanelModel | None = None) -> RungeKutta:
    """The integrator of arrays that a motor may land softly: the default, but for modal panels with clearance.

    Contacts are slower then than those of a passive deployment, and what an error of the usual size takes from the
    vibrations of the panels is a twentieth of the sliding work of a soft landing.
    """
    default = default_integrator(model, panels)
    slow = isinstance(default, ModalRadau) and has_clearance(model)
    return replace(default, velocity_scale=_LANDING_SPEED) if slow else default


def _modal_radau(model: str) -> ModalRadau:
    # Peak forces and impacts of the passive array converge at 2.5e-3 already, its deepest wear at 1e-3.
    return ModalRadau(rtol=1e-3 if has_clearance(model) else 2e-4)


def _settings(name: str, model: str) -> Integrator:
    """The method `name` with the settings that suit a model."""
    default = default_integrator(model, PanelModel.of(model, integrator=name))
    if name == default.name:
        return default
    suited: dict[str, Integrator] = {
        RungeKutta.name: RungeKutta(rtol=1e-5),
        Rosenbrock.name: Rosenbrock(rtol=default.rtol),
        ModalRadau.name: _modal_radau(model),
        PAPER: GeneralizedAlpha(rho_inf=1.0),
    }
    return suited[name] if name in suited else INTEGRATORS[name]()


def given_integrator(integrator: Integrator | str | None, model: str, rtol: float | None) -> Integrator | None:
    """The method that a user has given by name or by settings, None if it is left to the model.

    Args:
        integrator: settings, a name that `make_integrator` takes, or None.
        model: one of `array.MODELS`.
        rtol: local error tolerance in place of a named method's usual one.

    Raises:
        ValueError: if the name is unknown, if it is no method, or if `rtol` does not apply or is given twice.
    """
    if integrator is None:
        return None
    if isinstance(integrator, str):
        return make_integrator(integrator, model, rtol=rtol)
    if type(integrator) not in INTEGRATORS.values():
        names = ", ".join(f"{kind.__name__}(...)" for kind in INTEGRATORS.values())
        raise ValueError(f"integrator = {integrator!r} must be one of {', '.join(INTEGRATOR_NAMES)}, or {names}")
    if rtol is not None:
        raise ValueError(
            f"rtol = {rtol!r} beside integrator = {integrator!r}: give the tolerance in its settings alone"
        )
    return integrator


def make_integrator(name: str, model: str, step: float | None = None, rtol: float | None = None) -> Integrator:
    """An integrator by name, as the command line takes it.

    Args:
        name: of a method ("runge-kutta", "rosenbrock", "dop853" and "modal-radau" adapt their steps, which `step`
            bounds; "generalized-alpha", rho_inf = 0.8, takes a fixed `step` or adapts to `rtol`) or "paper"
            (generalized-alpha with beta = 1/4, gamma = 1/2 and a fixed step, 1e-4 s by default).
        model: one of `array.MODELS`.
        step: [s].
        rtol: local error tolerance.

    Raises:
        ValueError: if the name is unknown or an option does not apply.
    """
    if name not in INTEGRATOR_NAMES:
        raise ValueError(f"integrator {name!r} is unknown; choose from {', '.join(INTEGRATOR_NAMES)}")
    if name == PAPER and rtol is not None:
        raise ValueError("rtol does not apply to the integrator 'paper', whose step is fixed; give a step")
    return _settings(name, model).with_options(step, rtol)
