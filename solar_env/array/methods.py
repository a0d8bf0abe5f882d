"""The integrator of a deployment: by name, or the default of the model's level."""

from dataclasses import replace

from solar_env.array.level import ModelLevel
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


def default_integrator(model: str | ModelLevel) -> RungeKutta:
    """The integrator that a level of the model gets when none is named.

    Linearly implicit with panels of beam elements, whose stiff vibrations would bound explicit steps; that of modal
    panels is their own. The tolerances come from measured errors: angles, latch times and statistics of impacts
    (`solar-env study precision`).
    """
    level = ModelLevel.of(model)
    if level.modal:
        return _modal_radau(level.clearance)
    if level.flexible:
        return Rosenbrock(rtol=1e-4)
    return RungeKutta(rtol=2e-6, impact_resolution=12.0) if level.clearance else RungeKutta(rtol=5e-7)


def _modal_radau(clearance: bool) -> ModalRadau:
    # Peak forces and impacts of the passive array converge at 2.5e-3 already, its deepest wear at 1e-3.
    return ModalRadau(rtol=1e-3 if clearance else 2e-4)


def landing_integrator(model: str | ModelLevel) -> RungeKutta:
    """The integrator of arrays that a motor may land softly: the default, but for modal panels with clearance.

    Contacts are slower then than those of a passive deployment, and what an error of the usual size takes from the
    vibrations of the panels is a twentieth of the sliding work of a soft landing.
    """
    level = ModelLevel.of(model)
    default = default_integrator(level)
    return replace(default, velocity_scale=_LANDING_SPEED) if level.modal and level.clearance else default


def check_fits(integrator: Integrator, model: str | ModelLevel) -> Integrator:
    """Return an integrator that steps the panels of a level.

    Raises:
        ValueError: if it does not.
    """
    level = ModelLevel.of(model)
    if level.flexible and level.modal != isinstance(integrator, ModalRadau):
        kind, other = ("modes", "beam elements") if level.modal else ("beam elements", "modes")
        instead = f"{level.name}:6 elements" if level.modal else level.name
        raise ValueError(
            f"integrator = {integrator.name!r} steps panels of {other}, and those of model = {str(level)!r} are of "
            f"{kind}: choose the model {instead!r}, or leave out the integrator"
        )
    return integrator


def given_integrator(integrator: Integrator | str | None, model: str | ModelLevel, rtol: float | None) -> Integrator:
    """The method that a user has given by name or by settings, else the default of the level.

    Args:
        integrator: settings, a name that `make_integrator` takes, or None.
        model: its level.
        rtol: local error tolerance in place of the default's or a named method's usual one.

    Raises:
        ValueError: if the name is unknown, if it is no method, if it does not step the level's panels, or if `rtol`
            does not apply or is given twice.
    """
    if integrator is None:
        return default_integrator(model).with_options(None, rtol)
    if isinstance(integrator, str):
        return make_integrator(integrator, model, rtol=rtol)
    if type(integrator) not in INTEGRATORS.values():
        names = ", ".join(f"{kind.__name__}(...)" for kind in INTEGRATORS.values())
        raise ValueError(f"integrator = {integrator!r} must be one of {', '.join(INTEGRATOR_NAMES)}, or {names}")
    if rtol is not None:
        raise ValueError(
            f"rtol = {rtol!r} beside integrator = {integrator!r}: give the tolerance in its settings alone"
        )
    return check_fits(integrator, model)


def make_integrator(
    name: str, model: str | ModelLevel, step: float | None = None, rtol: float | None = None
) -> Integrator:
    """An integrator by name, as the command line takes it.

    Args:
        name: of a method ("runge-kutta", "rosenbrock" and "modal-radau" adapt their steps, which `step` bounds;
            "generalized-alpha", rho_inf = 0.8, takes a fixed `step`, 1e-4 s by default) or "paper"
            (generalized-alpha with beta = 1/4, gamma = 1/2).
        model: level of the model.
        step: [s].
        rtol: local error tolerance.

    Raises:
        ValueError: if the name is unknown, it does not step the level's panels, or an option does not apply.
    """
    if name not in INTEGRATOR_NAMES:
        raise ValueError(f"integrator {name!r} is unknown; choose from {', '.join(INTEGRATOR_NAMES)}")
    default, clearance = default_integrator(model), ModelLevel.of(model).clearance
    suited: dict[str, Integrator] = {
        RungeKutta.name: RungeKutta(rtol=1e-5),
        Rosenbrock.name: Rosenbrock(rtol=default.rtol),
        ModalRadau.name: _modal_radau(clearance),
        PAPER: GeneralizedAlpha(rho_inf=1.0),
        default.name: default,
    }
    chosen = suited[name] if name in suited else INTEGRATORS[name]()
    return check_fits(chosen, model).with_options(step, rtol)
