"""Texts of warnings about finished runs: each names a quantity, its value, and what to do; empty if all is well.

A run that cannot go on raises (`errors.py`). One that went on, but whose result is worse than its numbers look, warns
with a `SimulationWarning`. Plain Python: describing a mechanism needs no compiler.
"""

import warnings

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


def energy_text(time: float, residual: float, turnover: float, remedy: str) -> str:
    """Whether the energy book closes.

    Args:
        time: [s].
        residual: energy that the books do not account for [J].
        turnover: energy that the run turned over [J].
        remedy: what to do.
    """
    if abs(residual) <= LARGEST_ENERGY_SHARE * turnover:  # false for NaN
        return ""
    verb = "gained" if residual > 0.0 else "lost"
    return (
        f"by t = {time:.6g} s the integration has {verb} {abs(residual):.3g} J that no force accounts for, "
        f"{100.0 * abs(residual) / turnover:.2g} % of the {turnover:.3g} J turned over; {remedy}"
    )


def modal_range_text(time: float, slope: float, spin_ratio: float) -> str:
    """Whether modal panels bend or turn by more than their second order holds for.

    Args:
        time: [s].
        slope: greatest slope of a panel's end against its frame so far [rad].
        spin_ratio: greatest spin of a panel so far over the angular frequency of its lowest bending mode.
    """
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
        f"by t = {time:.6g} s the modal panels {what}: what their second order leaves out is "
        f"{100.0 * max(bent, turned):.2g} % of what it keeps; use beam elements (FlexibleBody, '...:6 elements')"
    )


def constraint_force_text(time: float, defect: float, largest: float) -> str:
    """Whether multipliers are the forces that hold the constraints.

    Args:
        time: [s].
        defect: greatest difference of a multiplier from the force that holds its constraint [N].
        largest: greatest force that acts [N].
    """
    if defect <= LARGEST_FORCE_SHARE * largest:
        return ""
    return (
        f"at t = {time:.6g} s the constraint forces of the integrator are off by {defect:.3g} N where the largest "
        f"force is {largest:.3g} N: with rho_inf near 1 they alternate from step to step, and steps of nanoseconds "
        "magnify rounding; choose rho_inf = 0.8 or another step, or do not use the peak forces of ideal joints"
    )


def impact_step_text(steps: float, needed: int, duration: float) -> str:
    """Whether a fixed step resolves an impact.

    Args:
        steps: per impact.
        needed: steps that keep the error of its exit speed within 1 %.
        duration: of the impact [s].
    """
    if steps >= needed:
        return ""
    return (
        f"an impact of {duration:.3g} s got {steps:.2g} steps, and an exit speed good to 1 % needs {needed}; "
        f"take a fixed step of at most {duration / needed:.2g} s, or give rtol"
    )


def tolerance_text(rtol: float, loosest: float) -> str:
    """Whether a tolerance is too loose for single contacts to be trusted.

    Args:
        rtol: of the integrator.
        loosest: up to which they can be.
    """
    if rtol <= loosest:
        return ""
    return (
        f"at rtol = {rtol:g} a single contact may come out with ten times its force, whatever the energy book says; "
        f"tighten rtol to {loosest:g} or less"
    )


def restitution_text(law: str, asked: float, given: float) -> str:
    """Whether a contact law gives the coefficient of restitution that was asked for.

    The text is rounded, so that Python shows it once for values that are nearly the same.

    Args:
        law: name of the contact law.
        asked, given: exit over entry speed (dimensionless).
    """
    if abs(given - asked) <= LARGEST_RESTITUTION_ERROR:
        return ""
    return (
        f"the contact law {law} turns a restitution of {asked:.1f} into an exit over entry speed of {given:.1f}; "
        "choose contact_law = 'restitution', or the restitution that gives the exit speed you want"
    )
