"""Warnings of runs that went on, but whose result is worse than its numbers look.

Each text names a quantity, its value, and what to do, and is empty if all is well. A run that cannot go on raises
(`errors.py`). Plain Python: describing a mechanism needs no compiler.
"""

import warnings
from typing import Any

# Of the energy that a run turned over: what the books may fail to account for.
LARGEST_ENERGY_SHARE = 0.01
# Of the largest force: what the multipliers may differ from the forces that hold the constraints.
LARGEST_FORCE_SHARE = 0.1
# What a modal panel's second order may leave out, over what it keeps.
LARGEST_MODAL_SHARE = 0.01
# Of the squared frequency of a free beam's lowest mode: how much a spin raises it, over the squared spin.
SPIN_STIFFENING = 2.05
# What a contact law's exit over entry speed may differ from the coefficient of restitution that was asked for.
LARGEST_RESTITUTION_ERROR = 0.05


class SimulationWarning(UserWarning):
    """A run went on, but its result is less accurate than it looks; the message says which, by how much, what to do."""


def warn(text: str) -> None:
    """Give a warning; an empty text is none."""
    if text:
        # The line of the caller says nothing here: what is wrong is in the text.
        warnings.warn(text, SimulationWarning, stacklevel=2)


def shortcomings(run: Any) -> dict[str, str]:
    """Texts by subject about a `Simulation` so far."""
    return {
        "energy": energy_shortcoming(run),
        "forces": force_shortcoming(run),
        "impacts": _impact_shortcoming(run),
        "range": range_shortcoming(run),
        "tolerance": _tolerance_shortcoming(run),
    }


def energy_shortcoming(run: Any) -> str:
    """Whether the energy book closes."""
    residual, turnover = run.energy_book()
    if abs(residual) <= LARGEST_ENERGY_SHARE * turnover:  # false for NaN
        return ""
    verb = "gained" if residual > 0.0 else "lost"
    return (
        f"by t = {run.time:.6g} s the integration has {verb} {abs(residual):.3g} J that no force accounts for, "
        f"{100.0 * abs(residual) / turnover:.2g} % of the {turnover:.3g} J turned over; {run.integrator.remedy}"
    )


def range_shortcoming(run: Any) -> str:
    """Whether modal panels bend or turn by more than their second order holds for."""
    slope, spin_ratio = run.formulation.modal_range(run.model, run.state)
    # The next term of the shortening of an arc, and the stiffness that the lowest mode gains from the inertia of the
    # turning frame.
    bent, turned = 0.25 * slope * slope, SPIN_STIFFENING * spin_ratio * spin_ratio
    if max(bent, turned) <= LARGEST_MODAL_SHARE:  # false for NaN
        return ""
    what = (
        f"have bent by {slope:.3g} rad"
        if bent > turned
        else f"have turned at {spin_ratio:.3g} of their lowest bending frequency"
    )
    return (
        f"by t = {run.time:.6g} s the modal panels {what}: what their second order leaves out is "
        f"{100.0 * max(bent, turned):.2g} % of what it keeps; use beam elements (FlexibleBody, '...:6 elements')"
    )


def force_shortcoming(run: Any) -> str:
    """Whether the multipliers of generalized-alpha are the forces that hold the constraints."""
    if not run.integrator.settles_forces or run.state.clock["steps"][0] == 0:
        return ""
    defect, largest = run.constraint_force_defect()
    if defect <= LARGEST_FORCE_SHARE * largest:
        return ""
    return (
        f"at t = {run.time:.6g} s the constraint forces of the integrator are off by {defect:.3g} N where the largest "
        f"force is {largest:.3g} N: with rho_inf near 1 they alternate from step to step, and steps of nanoseconds "
        "magnify rounding; choose rho_inf = 0.8 or another step, or do not use the peak forces of ideal joints"
    )


def _impact_shortcoming(run: Any) -> str:
    """Whether a fixed step resolves the latest impact of every joint."""
    needed, durations = run.integrator.steps_needed_per_impact, run.state.joints["contact_duration"]
    struck = durations > 0.0
    if needed is None or not struck.any():
        return ""
    duration = float(durations[struck].min())
    steps = duration / float(run.state.clock["last_step"][0])
    if steps >= needed:
        return ""
    return (
        f"an impact of {duration:.3g} s got {steps:.2g} steps, and an exit speed good to 1 % needs {needed}; "
        f"take a fixed step of at most {duration / needed:.2g} s, or another method"
    )


def _tolerance_shortcoming(run: Any) -> str:
    """Whether a tolerance is too loose for single contacts to be trusted."""
    rtol, loosest = run.integrator.rtol, run.integrator.loosest_in_contact
    if rtol is None or rtol <= loosest or not run.state.joints["contact_starts"].any():
        return ""
    return (
        f"at rtol = {rtol:g} a single contact may come out with ten times its force, whatever the energy book says; "
        f"tighten rtol to {loosest:g} or less"
    )


def restitution_text(law: str, asked: float, given: float) -> str:
    """Whether a contact law gives the coefficient of restitution that was asked for.

    The text is rounded, so that Python shows it once for values that are nearly the same.
    """
    if abs(given - asked) <= LARGEST_RESTITUTION_ERROR:
        return ""
    return (
        f"the contact law {law} turns a restitution of {asked:.1f} into an exit over entry speed of {given:.1f}; "
        "choose contact_law = 'restitution', or the restitution that gives the exit speed you want"
    )
