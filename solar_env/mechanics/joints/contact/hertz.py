"""Elastic point contact of spheres without damping: H. Hertz, J. reine angew. Math. 92 (1881) 156."""

import math

from solar_env.mechanics.joints.contact.power_law import PowerLaw
from solar_env.mechanics.joints.contact.surfaces import Surfaces


def sphere(surfaces: Surfaces, damping: float) -> PowerLaw:
    """Contact of a sphere in a spherical seat, F = K depth^1.5 (1 + d rate / v), K given or from the materials.

    K = 4 / (3 (h_b + h_j)) sqrt(R_b R_j / (R_b - R_j)) [N/m^1.5] with h = (1 - nu^2) / E: W. Goldsmith, Impact (1960);
    Eq 40 of Y. Li, C. Wang and W. Huang, Mech. Syst. Signal Process. 117 (2019) 188.

    Args:
        surfaces: in contact.
        damping: factor d (dimensionless).
    """
    if surfaces.stiffness is not None:
        return PowerLaw(surfaces.stiffness, 1.5, damping)
    bearing, journal = surfaces.bearing_radius, surfaces.journal_radius
    radius = bearing * journal / (bearing - journal)
    return PowerLaw(4.0 / (3.0 * surfaces.compliance) * math.sqrt(radius), 1.5, damping)


def law(surfaces: Surfaces, restitution: float) -> PowerLaw:
    """Hertz's law: it conserves energy, whatever restitution is asked for."""
    return sphere(surfaces, 0.0)
