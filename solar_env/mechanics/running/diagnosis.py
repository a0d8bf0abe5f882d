"""Warnings about finished runs: each names a quantity, its value, and what to do.

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


def _warn(text: str) -> None:
    # The line of the caller says nothing here: what is wrong is in the text.
    warnings.warn(text, SimulationWarning, stacklevel=2)


def check_energy(time: float, residual: float, turnover: float, remedy: str) -> bool:
    """Warn if the energy book does not close; whether it did warn.

    Args:
        time: [s].
        residual: energy that the books do not account for [J].
        turnover: energy that the run turned over [J].
        remedy: what to do.
    """
    if abs(residual) <= LARGEST_ENERGY_SHARE * turnover:  # false for NaN
        return False
    verb = "gained" if residual > 0.0 else "lost"
    _warn(
        f"by t = {time:.6g} s the integration has {verb} {abs(residual):.3g} J that no force accounts for, "
        f"{100.0 * abs(residual) / turnover:.2g} % of the {turnover:.3g} J turned over; {remedy}"
    )
    return True


def check_modal_range(time: float, slope: float, spin_ratio: float) -> bool:
    """Warn if modal panels bend or turn by more than their second order holds for; whether it did warn.

    Args:
        time: [s].
        slope: greatest slope of a panel's end against its frame so far [rad].
        spin_ratio: greatest spin of a panel so far over the angular frequency of its lowest bending mode.
    """
    # The next term of the shortening of an arc, and the stiffness that the lowest mode gains from the inertia of the
    # turning frame.
    bent, turned = 0.25 * slope * slope, SPIN_STIFFENING * spin_ratio * spin_ratio
    if max(bent, turned) <= LARGEST_MODAL_SHARE:  # false for NaN
        return False
    what = (
        f"have bent by {slope:.3g} rad"
        if bent > turned
        else f"have turned at {spin_ratio:.3g} of their lowest bending frequency"
    )
    _warn(
        f"by t = {time:.6g} s the modal panels {what}: what their second order leaves out is "
        f"{100.0 * max(bent, turned):.2g} % of what it keeps; use beam elements (FlexibleBody, panels='ancf')"
    )
    return True


def check_constraint_forces(time: float, defect: float, largest: float) -> bool:
    """Warn if multipliers are not the forces that hold the constraints; whether it did warn.

    Args:
        time: [s].
        defect: greatest difference of a multiplier from the force that holds its constraint [N].
        largest: greatest force that acts [N].
    """
    if defect <= LARGEST_FORCE_SHARE * largest:
        return False
    _warn(
        f"at t = {time:.6g} s the constraint forces of the integrator are off by {defect:.3g} N where the largest "
        f"force is {largest:.3g} N: with rho_inf near 1 they alternate from step to step, and steps of nanoseconds "
        "magnify rounding; choose rho_inf = 0.8 or another step, or do not use the peak forces of ideal joints"
    )
    return True


def check_impact_steps(steps: float, needed: int, duration: float) -> bool:
    """Warn if a fixed step does not resolve an impact; whether it did warn.

    Args:
        steps: per impact.
        needed: steps that keep the error of its exit speed within 1 %.
        duration: of the impact [s].
    """
    if steps >= needed:
        return False
    _warn(
        f"an impact of {duration:.3g} s got {steps:.2g} steps, and an exit speed good to 1 % needs {needed}; "
        f"take a fixed step of at most {duration / needed:.2g} s, or give rtol"
    )
    return True


def check_tolerance(rtol: float, loosest: float) -> bool:
    """Warn if a tolerance is too loose for single contacts to be trusted; whether it did warn.

    Args:
        rtol: of the integrator.
        loosest: up to which they can be.
    """
    if rtol <= loosest:
        return False
    _warn(
        f"at rtol = {rtol:g} a single contact may come out with ten times its force, whatever the energy book says; "
        f"tighten rtol to {loosest:g} or less"
    )
    return True


def check_restitution(law: str, asked: float, given: float) -> bool:
    """Warn if a contact law does not give the coefficient of restitution that was asked for; whether it did warn.

    The text is rounded, so that Python shows it once for values that are nearly the same.

    Args:
        law: name of the contact law.
        asked, given: exit over entry speed (dimensionless).
    """
    if abs(given - asked) <= LARGEST_RESTITUTION_ERROR:
        return False
    _warn(
        f"the contact law {law} turns a restitution of {asked:.1f} into an exit over entry speed of {given:.1f}; "
        "choose contact_law = 'restitution', or the restitution that gives the exit speed you want"
    )
    return True
