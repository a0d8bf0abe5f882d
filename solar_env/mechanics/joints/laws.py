"""Parameters of the contact law from material and geometry. Plain Python: describing a mechanism needs no compiler."""

from __future__ import annotations

import math


def damping_factor(law: str, restitution: float) -> float:
    """Damping factor d of F = K depth^1.5 (1 + d rate / impact speed) at a restitution coefficient e (dimensionless).

    * "hertz": d = 0, which conserves energy (H. Hertz, 1881);
    * "lankarani-nikravesh": d = 3 (1 - e^2) / 4 (J. Mech. Des. 112 (1990) 369, doi:10.1115/1.2912617);
    * "flores": d = 8 (1 - e) / (5 e) (P. Flores, M. Machado, M. T. Silva and J. M. Martins, Multibody Syst. Dyn. 25
      (2011) 357, doi:10.1007/s11044-010-9237-4).

    Raises:
        ValueError: if the law is unknown or the coefficient lies outside the law's range.
    """
    if law == "hertz":
        return 0.0
    if not 0.0 < restitution <= 1.0:
        raise ValueError(f"restitution = {restitution!r} must lie in (0, 1]")
    if law == "lankarani-nikravesh":
        return 0.75 * (1.0 - restitution**2)
    if law == "flores":
        return 1.6 * (1.0 - restitution) / restitution
    raise ValueError(f"contact law {law!r} is unknown; choose hertz, lankarani-nikravesh or flores")


def exit_speed_ratio(factor: float) -> float:
    """Exit over entry speed e of an impact under F = K depth^1.5 (1 + d rate / impact speed), for d = ``factor`` >= 0.

    The equation of motion separates: d (1 + e) = ln[(1 + d) / (1 - d e)], whatever mass, speed and stiffness. Solved
    by bisection.
    """
    if factor < 1e-6:
        return 1.0 - 2.0 / 3.0 * factor  # where rounding would hide it
    low, high = 0.0, min(1.0, 1.0 / factor)
    for _ in range(60):
        middle = 0.5 * (low + high)
        room = 1.0 - factor * middle
        if room <= 0.0 or math.log1p(factor) - math.log(room) > factor * (1.0 + middle):
            high = middle
        else:
            low = middle
    return low


def hertz_stiffness(
    bearing_radius: float,
    journal_radius: float,
    bearing_young: float,
    bearing_poisson: float,
    journal_young: float,
    journal_poisson: float,
) -> float:
    """Contact stiffness K [N/m^1.5] of a sphere in a spherical seat from radii [m] and materials (paper, Eq 40).

    K = 4 / (3 (h_b + h_j)) sqrt(R_b R_j / (R_b - R_j)) with h = (1 - nu^2) / E; Goldsmith, Impact (1960).

    Raises:
        ValueError: if the journal does not fit into the bearing or a modulus is not positive.
    """
    if not 0.0 < journal_radius < bearing_radius:
        raise ValueError(
            f"journal radius {journal_radius!r} must be positive and below the bearing's {bearing_radius!r}"
        )
    if min(bearing_young, journal_young) <= 0.0:
        raise ValueError(f"Young's moduli must be positive, got {bearing_young!r} and {journal_young!r}")
    compliance = (1.0 - bearing_poisson**2) / bearing_young + (1.0 - journal_poisson**2) / journal_young
    radius = bearing_radius * journal_radius / (bearing_radius - journal_radius)
    return 4.0 / (3.0 * compliance) * math.sqrt(radius)
