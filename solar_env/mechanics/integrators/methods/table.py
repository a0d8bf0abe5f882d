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
from solar_env.mechanics.integrators.methods import generalized_alpha, rosenbrock, stage_steps
from solar_env.mechanics.modal import books
from solar_env.mechanics.modal import method as modal
from solar_env.mechanics.modal.arrays import make_workspace
from solar_env.mechanics.modal.solve import ModalSettings
from solar_env.mechanics.numerics.by_type import chosen_by_type
from solar_env.mechanics.numerics.jit import kernel
from solar_env.mechanics.numerics.step_size import StepController

Chosen = Any  # one of the settings' classes of `settings.py`
# How steps land on events: not at all, at a share of the step that is interpolated, or by solving a shorter step.
NOT_AT_ALL, AT_SHARE, BY_SOLVING_AGAIN = range(3)


@kernel
def note_no_peaks(model, state, arrays, h, share):
    """Do nothing: force maxima are those at the ends of steps."""


@kernel
def resume_nothing(model, state, arrays):
    """Do nothing: the next step starts from the state alone."""


@kernel
def adapt_nothing(model, state, settings, arrays, accepted):
    """Do nothing: the method has no choice between steps."""


@dataclass(frozen=True)
class Kernels:
    """Kernels that a method offers to the run loop (`run.py`), which passes their arguments.

    `arrays` are the method's, with `trial` and `motion` (`arrays/trial.py`) among them; `h` is the size of the step in
    hand [s], `share` a place in it from 0 to 1.

    Attributes:
        begin: prepares the arrays for a call, fills `motion` and a first step size; False if constraints are singular.
        choose: step to try [s] by accuracy, impacts and the settings, with `remaining` time in the call [s].
        attempt: tries a step from the unchanged accepted state; its error in units of the tolerance, negative if
            constraints are singular. In `trial`, it may name a step to try after a refused one. A step that was cut has
            no error of its own.
        complete: fills what samples and the acceptance need beyond what the attempt left.
        sample: stores a row of the record.
        commit: moves the state to a share of the step and fills depths and their rates in `motion`; False if
            constraints are singular.
        evaluate: fills the rest of `motion` at the accepted state, whose forces an event may have `changed`.
        open_contact: inverse mass [1/kg] that a joint feels as its contact begins.
        contact_arcs: arcs along which the line of centres has moved in the frames of journal and bearing: middle and
            half of each [rad].
        depth, angle: penetration [m] and angle [rad] of a joint at a share of the step.
        landing: how steps land on events.
        control: the controller of the step size, without effect on a fixed step.
        note_peaks: raises the force maxima to those inside the step.
        resume: prepares the next step, after the ends of contacts.
        adapt: changes the method's own choices once the next step's size is set.
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
    """A row of the table.

    Attributes:
        order: of convergence, for smooth motion.
        kernel_settings: type of the settings as the kernels take them; tells the compiler which kernels are meant.
        convert: converts the settings that a user has chosen to the kernels' types.
        arrays: allocates the scratch arrays of a thread for a mechanism's model and state.
        kernels: kernels that make a step.
        formulation: of the equations of motion.
    """

    order: int
    kernel_settings: type
    convert: Callable
    arrays: Callable
    kernels: Kernels
    formulation: Formulation = ABSOLUTE


# Controller by proportional and integral control of the error.
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
    """Return the row of the settings that a user has chosen.

    Raises:
        ValueError: if they are no method's settings.
    """
    if type(chosen) not in settings.INTEGRATORS.values():
        names = ", ".join(f"{kind.__name__}(...)" for kind in settings.INTEGRATORS.values())
        raise ValueError(f"integrator = {chosen!r} must be one of {names}")
    return METHODS[chosen.name]


def kernel_of(pick: Callable) -> Callable:
    """Return a function from kernel settings to `pick` of their method's kernels, resolved at compile time."""
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
