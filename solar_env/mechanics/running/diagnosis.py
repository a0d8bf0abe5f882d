"""Warnings about runs that finished, but whose results are worse than they look.

Each text names a quantity, its value and a remedy, and is empty if all is well. A run that cannot go on raises an error
(`errors.py`). The module imports no compiler, because checks of an array's parameters warn through it, too.
"""

import warnings
from typing import Any

LARGEST_ENERGY_SHARE = 0.01  # largest error of the energy balance, divided by the energy turned over in a run
LARGEST_FORCE_SHARE = 0.1  # largest error of multipliers as constraint forces, divided by the largest force
# Largest ratio of the stiffness or shortening that a modal panel's second-order theory leaves out to what it keeps.
LARGEST_MODAL_SHARE = 0.01
SPIN_STIFFENING = 2.05  # rise of the squared frequency of a free beam's lowest mode, divided by the squared spin
# Largest difference between a contact law's ratio of exit to entry speed and the requested restitution.
LARGEST_RESTITUTION_ERROR = 0.05


class SimulationWarning(UserWarning):
    """Warning that a result is less accurate than it looks; the message names the quantity, its error and a remedy."""


def warn(text: str) -> None:
    """Issue a `SimulationWarning` with a text, unless the text is empty."""
    if text:
        # The caller's line would say nothing: the text names the fault.
        warnings.warn(text, SimulationWarning, stacklevel=2)


def shortcomings(run: Any) -> dict[str, str]:
    """Return warning texts about a `Simulation` so far, by subject; a text is empty where all is well."""
    return {
        "energy": energy_shortcoming(run),
        "forces": force_shortcoming(run),
        "impacts": _impact_shortcoming(run),
        "range": range_shortcoming(run),
        "tolerance": _tolerance_shortcoming(run),
    }


def energy_shortcoming(run: Any) -> str:
    """Return a warning if the energy balance is off by over 1 % of the energy stored and lost, else an empty text."""
    residual, turnover = run.energy_book()
    if abs(residual) <= LARGEST_ENERGY_SHARE * turnover:  # false for NaN
        return ""
    verb = "gained" if residual > 0.0 else "lost"
    return (
        f"by t = {run.time:.6g} s the integration has {verb} {abs(residual):.3g} J that no force accounts for, "
        f"{100.0 * abs(residual) / turnover:.2g} % of the {turnover:.3g} J turned over; {run.integrator.remedy}"
    )


def range_shortcoming(run: Any) -> str:
    """Return a warning if modal panels bend or turn beyond their second-order theory's range, else an empty text."""
    slope, spin_ratio = run.formulation.modal_range(run.model, run.state)
    # Effects left out: the next term of an arc's shortening, and the stiffness that the lowest mode gains from the
    # inertia of the turning frame.
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
    """Return a warning if generalized-alpha's multipliers are far from the constraint forces, else an empty text."""
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
    """Return a warning if a fixed step does not resolve the latest impact of some joint, else an empty text."""
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
    """Return a warning if a tolerance is too loose for single contacts to be trusted, else an empty text."""
    rtol, loosest = run.integrator.rtol, run.integrator.loosest_in_contact
    if rtol is None or rtol <= loosest or not run.state.joints["contact_starts"].any():
        return ""
    return (
        f"at rtol = {rtol:g} a single contact may come out with ten times its force, whatever the energy book says; "
        f"tighten rtol to {loosest:g} or less"
    )


def restitution_text(law: str, asked: float, given: float) -> str:
    """Return a warning if a contact law's exit-to-entry speed ratio, `given`, is far from the restitution `asked`.

    Otherwise the text is empty. It rounds numbers, so that Python shows the warning once for nearly equal values.
    """
    if abs(given - asked) <= LARGEST_RESTITUTION_ERROR:
        return ""
    return (
        f"the contact law {law} turns a restitution of {asked:.1f} into a ratio of exit to entry speed of {given:.1f}; "
        "choose contact_law = 'restitution', or the restitution that gives the exit speed you want"
    )
