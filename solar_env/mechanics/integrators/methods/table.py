"""The table of methods: a row each, from which runs, batches, warm-up and tests follow.

A method is one module with its settings, its scratch arrays and its kernels. The settings' type tells the compiler at
compile time which kernels a run calls: `attempt_of(settings)(...)`. The formulation tells the arrays of a run.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from solar_env.mechanics.equations.formulation import Formulation
from solar_env.mechanics.integrators import settings
from solar_env.mechanics.integrators.formulations import ABSOLUTE, FLOATING
from solar_env.mechanics.integrators.methods import dormand_prince, generalized_alpha, rosenbrock, runge_kutta
from solar_env.mechanics.integrators.step import HERMITE, AdaptiveSettings, Interpolant, adapt_nothing
from solar_env.mechanics.modal.arrays import make_workspace
from solar_env.mechanics.modal.run.driver import begin_modal, convert_settings, take_modal_step
from solar_env.mechanics.modal.step.solve import ModalSettings
from solar_env.mechanics.numerics.by_type import chosen_by_type

Chosen = Any  # one of the settings' classes of `settings.py`


@dataclass(frozen=True)
class AdaptiveKernels:
    """Kernels of a method that the driver of adaptive steps (`adaptive.py`) calls.

    Attributes:
        begin: (model, own arrays): prepares the method's own arrays for a call.
        choose: (model, state, stages, wanted): step to try [s] if `wanted` is what accuracy and impacts allow.
        attempt: (model, state, settings, arrays, h): fills a step; its error in units of the tolerance, negative if
            constraints are singular.
        interpolant: looks between the ends of the step.
        adapt: (model, state, stages, accepted): what the method itself changes once the next step's size is set.
    """

    begin: Any
    choose: Any
    attempt: Any
    interpolant: Interpolant = HERMITE
    adapt: Any = adapt_nothing


@dataclass(frozen=True)
class SteppingKernels:
    """A method with a control of its steps of its own.

    Attributes:
        begin_call: (model, state, settings, recorder, arrays): prepares a call and records its start; a status code.
        take_step: (model, state, settings, recorder, end_time, arrays): takes a step and books it; a status code.
    """

    begin_call: Any
    take_step: Any


@dataclass(frozen=True)
class Method:
    """A row of the table.

    Attributes:
        order: of convergence, for smooth motion.
        kernel_settings: type of the settings as the kernels take them; tells the compiler which kernels are meant.
        convert: the settings that a user has chosen, as the kernels take them.
        arrays: allocates the scratch arrays of a thread for a mechanism's model and state.
        kernels: that make a step.
        formulation: of the equations of motion.
    """

    order: int
    kernel_settings: type
    convert: Callable[[Any], Any]
    arrays: Callable[[Any, Any], Any]
    kernels: AdaptiveKernels | SteppingKernels
    formulation: Formulation = ABSOLUTE


def _adaptive(order: int, kernel_settings: type, arrays: Callable[[Any, Any], Any], *kernels: Any) -> Method:
    def convert(chosen: settings.RungeKutta) -> AdaptiveSettings:
        values = (chosen.rtol, chosen.velocity_scale, chosen.max_step, chosen.impact_resolution)
        # Of other types they would be compiled anew.
        converted: AdaptiveSettings = kernel_settings(*map(float, values), int(chosen.max_steps), float(order))
        return converted

    return Method(order, kernel_settings, convert, arrays, AdaptiveKernels(*kernels))


METHODS: dict[str, Method] = {
    settings.RungeKutta.name: _adaptive(
        4,
        runge_kutta.RungeKuttaSettings,
        runge_kutta.make_runge_kutta_arrays,
        runge_kutta.begin_runge_kutta,
        runge_kutta.choose_runge_kutta,
        runge_kutta.attempt_runge_kutta,
    ),
    settings.Rosenbrock.name: _adaptive(
        4,
        rosenbrock.RosenbrockSettings,
        rosenbrock.make_rosenbrock_arrays,
        rosenbrock.begin_rosenbrock,
        rosenbrock.choose_rosenbrock,
        rosenbrock.attempt_rosenbrock,
        HERMITE,
        rosenbrock.adapt_rosenbrock,
    ),
    settings.DormandPrince.name: _adaptive(
        8,
        dormand_prince.DormandPrinceSettings,
        dormand_prince.make_dormand_prince_arrays,
        dormand_prince.begin_dormand_prince,
        dormand_prince.choose_dormand_prince,
        dormand_prince.attempt_dormand_prince,
        dormand_prince.INTERPOLANT,
    ),
    settings.ModalRadau.name: Method(
        3,
        ModalSettings,
        convert_settings,
        make_workspace,
        SteppingKernels(begin_modal, take_modal_step),
        FLOATING,
    ),
    settings.GeneralizedAlpha.name: Method(
        2,
        generalized_alpha.AlphaSettings,
        generalized_alpha.convert_settings,
        generalized_alpha.make_alpha_arrays,
        SteppingKernels(generalized_alpha.begin_alpha, generalized_alpha.take_alpha_step),
    ),
}
_BY_TYPE = {method.kernel_settings: method for method in METHODS.values()}


def method_of(chosen: Chosen) -> Method:
    """The row of the settings that a user has chosen.

    Raises:
        ValueError: if they are not those of a method.
    """
    if type(chosen) not in settings.INTEGRATORS.values():
        names = ", ".join(f"{kind.__name__}(...)" for kind in settings.INTEGRATORS.values())
        raise ValueError(f"integrator = {chosen!r} must be one of {names}")
    return METHODS[chosen.name]


def kernel_of(pick: Callable[[Any], Any]) -> Callable[[Any], Any]:
    """A function of kernel settings that gives the kernel `pick` takes from their method's; resolved in compiling."""
    return chosen_by_type(_BY_TYPE, lambda method: pick(method.kernels))


begin_of = kernel_of(lambda kernels: kernels.begin)
choose_of = kernel_of(lambda kernels: kernels.choose)
attempt_of = kernel_of(lambda kernels: kernels.attempt)
adapt_of = kernel_of(lambda kernels: kernels.adapt)
complete_of = kernel_of(lambda kernels: kernels.interpolant.complete)
interpolate_of = kernel_of(lambda kernels: kernels.interpolant.state)
integrals_of = kernel_of(lambda kernels: kernels.interpolant.integrals)
depth_of = kernel_of(lambda kernels: kernels.interpolant.depth)
