"""Table of the integration methods; the run loop, the batches, the warm-up and the tests read it.

A method is one module with its settings, its work arrays and its kernels. At compile time the type of the settings
selects the kernels that a run calls: `attempt_of(settings)`, for example, is the kernel that tries a step. A method
also names its formulation of the equations of motion, which determines the arrays of the model and its state.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from solar_env.mechanics.equations.formulation import Formulation
from solar_env.mechanics.integrators import settings
from solar_env.mechanics.integrators.formulations import ABSOLUTE, FLOATING
from solar_env.mechanics.integrators.methods import generalized_alpha, rosenbrock, stage_steps
from solar_env.mechanics.modal import books
from solar_env.mechanics.modal import method as modal
from solar_env.mechanics.modal.arrays import make_workspace
from solar_env.mechanics.modal.solve import ModalSettings
from solar_env.mechanics.numerics.by_type import chosen_by_type
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.step_size import StepController

Chosen = Any  # an instance of a settings class in `settings.py`
NOT_AT_ALL, AT_SHARE, BY_SOLVING_AGAIN = range(3)


@kernel
def note_no_peaks(model, state, arrays, h, share):
    """Do nothing: force maxima are taken only at the ends of steps."""


@kernel
def resume_nothing(model, state, arrays):
    """Do nothing: the next step starts from the state alone."""


@kernel
def adapt_nothing(model, state, settings, arrays, accepted):
    """Do nothing: the method has only one kind of step."""


@dataclass(frozen=True)
class Kernels:
    """Kernels that a method provides to the run loop (`run.py`), which calls them.

    Of their arguments, `arrays` are the method's work arrays, `h` is the size of the current step [s], and `share` is a
    fraction of the step from 0 to 1. In `arrays`, `trial` describes the step that is tried, and `motion` has depth,
    angle, rates and force of every joint (`arrays/trial.py`). A call means one call of `run.advance`.

    Attributes:
        begin: prepares the arrays for a call, fills `motion`, sets a first step size; False for singular constraints.
        choose: returns the step to try [s] by accuracy, impacts and settings; `remaining` is the time left in the call.
        attempt: tries a step without changing the accepted state; returns the error divided by the tolerance, negative
            if constraints are singular. It may set in `trial` the step to try after a rejection. After a step that was
            shortened to end at an event, the next step's size follows from the error of the step's first try.
        complete: computes the quantities that samples and acceptance need and the attempt has not computed.
        sample: records a sample at a fraction of the step.
        commit: moves the state to a fraction of the step, stores depths and rates in `motion`; False if singular.
        evaluate: fills the rest of `motion` at the accepted state; `changed` tells if an event has changed the forces.
        open_contact: returns a joint's inverse effective mass [1/kg] at the start of contact.
        contact_arcs: returns the arcs (middle, half-width) [rad] along which contact moved on journal and bearing.
        depth, angle: return the penetration [m] and the angle [rad] of a joint at a fraction of the step.
        landing: how steps end at events: NOT_AT_ALL, AT_SHARE (by interpolation) or BY_SOLVING_AGAIN (a shorter step).
        control: controller of the step size, without effect on a fixed step.
        note_peaks: raises the force maxima to the peaks inside the step.
        resume: prepares the next step; called after an accepted step or event, when ended contacts have been recorded.
        adapt: chooses between explicit and linearly implicit steps, after the next step's size is set.
    """

    begin: Callable
    choose: Callable
    attempt: Callable
    complete: Callable
    sample: Callable
    commit: Callable
    evaluate: Callable
    open_contact: Callable
    contact_arcs: Callable
    depth: Callable
    angle: Callable
    landing: int
    control: StepController
    note_peaks: Callable = note_no_peaks
    resume: Callable = resume_nothing
    adapt: Callable = adapt_nothing


@dataclass(frozen=True)
class Method:
    """An integration method, as an entry of the table `METHODS`."""

    order: int  # order of convergence for smooth motion
    kernel_settings: type  # type of the settings that the kernels take; it selects the kernels at compile time
    convert: Callable  # converts the settings that a user has chosen to `kernel_settings`
    arrays: Callable  # allocates the work arrays of a thread for a mechanism's model and state
    kernels: Kernels
    formulation: Formulation = ABSOLUTE


# Step-size controller with proportional and integral control of the error.
_PROPORTIONAL_INTEGRAL = StepController(float(rosenbrock.ORDER), 0.72, 0.4, 1e-10, 0.1, 10.0, 0.0, 0.0)
_IN_STAGES = Method(
    rosenbrock.ORDER,
    rosenbrock.StageSettings,
    rosenbrock.convert_settings,
    rosenbrock.make_stage_arrays,
    Kernels(
        begin=rosenbrock.begin_rosenbrock,
        choose=rosenbrock.choose_rosenbrock,
        attempt=rosenbrock.attempt_rosenbrock,
        complete=stage_steps.complete_nothing,
        sample=stage_steps.sample_stages,
        commit=stage_steps.commit_stages,
        evaluate=stage_steps.evaluate_stages,
        open_contact=stage_steps.open_contact,
        contact_arcs=stage_steps.contact_arcs,
        depth=stage_steps.depth_in_stages,
        angle=stage_steps.angle_in_stages,
        landing=AT_SHARE,
        control=_PROPORTIONAL_INTEGRAL,
        note_peaks=stage_steps.refine_peaks,
        resume=stage_steps.resume_stages,
        adapt=rosenbrock.adapt_rosenbrock,
    ),
)

METHODS: dict[str, Method] = {
    settings.RungeKutta.name: _IN_STAGES,
    settings.Rosenbrock.name: _IN_STAGES,
    settings.ModalRadau.name: Method(
        5,
        ModalSettings,
        modal.convert_settings,
        make_workspace,
        Kernels(
            begin=modal.begin_modal,
            choose=modal.choose_modal,
            attempt=modal.attempt_modal,
            complete=modal.complete_modal,
            sample=books.sample_modal,
            commit=modal.commit_modal,
            evaluate=modal.evaluate_modal,
            open_contact=modal.open_contact,
            contact_arcs=modal.contact_arcs,
            depth=modal.depth_of_modal,
            angle=modal.angle_of_modal,
            landing=BY_SOLVING_AGAIN,
            control=modal.CONTROL,
            note_peaks=books.note_peaks,
            resume=modal.resume_modal,
        ),
        FLOATING,
    ),
    settings.GeneralizedAlpha.name: Method(
        2,
        generalized_alpha.AlphaSettings,
        generalized_alpha.convert_settings,
        generalized_alpha.make_alpha_arrays,
        Kernels(
            begin=generalized_alpha.begin_alpha,
            choose=generalized_alpha.choose_alpha,
            attempt=generalized_alpha.attempt_alpha,
            complete=generalized_alpha.complete_alpha,
            sample=generalized_alpha.sample_alpha,
            commit=generalized_alpha.commit_alpha,
            evaluate=generalized_alpha.evaluate_alpha,
            open_contact=stage_steps.open_contact,
            contact_arcs=stage_steps.contact_arcs,
            depth=generalized_alpha.depth_at_start,
            angle=generalized_alpha.angle_at_start,
            landing=NOT_AT_ALL,
            control=StepController(2.0),
            resume=generalized_alpha.engage_stops,
        ),
    ),
}
_BY_TYPE = {method.kernel_settings: method for method in METHODS.values()}


def method_of(chosen: Chosen) -> Method:
    """Return the method of the settings that a user has chosen.

    Raises:
        ValueError: if no method has settings of this class.
    """
    if type(chosen) not in settings.INTEGRATORS.values():
        names = ", ".join(f"{kind.__name__}(...)" for kind in settings.INTEGRATORS.values())
        raise ValueError(f"integrator = {chosen!r} must be one of {names}")
    return METHODS[chosen.name]


def kernel_of(pick: Callable) -> Callable:
    """Return a function that takes a method's settings and returns `pick(kernels)` for this method's `Kernels`."""
    return chosen_by_type(_BY_TYPE, lambda method: pick(method.kernels))


begin_of = kernel_of(lambda kernels: kernels.begin)
choose_of = kernel_of(lambda kernels: kernels.choose)
attempt_of = kernel_of(lambda kernels: kernels.attempt)
complete_of = kernel_of(lambda kernels: kernels.complete)
sample_of = kernel_of(lambda kernels: kernels.sample)
commit_of = kernel_of(lambda kernels: kernels.commit)
evaluate_of = kernel_of(lambda kernels: kernels.evaluate)
open_contact_of = kernel_of(lambda kernels: kernels.open_contact)
contact_arcs_of = kernel_of(lambda kernels: kernels.contact_arcs)
depth_of = kernel_of(lambda kernels: kernels.depth)
angle_of = kernel_of(lambda kernels: kernels.angle)
landing_of = kernel_of(lambda kernels: kernels.landing)
controller_of = kernel_of(lambda kernels: kernels.control)
note_peaks_of = kernel_of(lambda kernels: kernels.note_peaks)
resume_of = kernel_of(lambda kernels: kernels.resume)
adapt_of = kernel_of(lambda kernels: kernels.adapt)
