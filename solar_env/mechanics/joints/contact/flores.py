"""Contact law of P. Flores, M. Machado, M. T. Silva and J. M. Martins.

Multibody Syst. Dyn. 25 (2011) 357, doi:10.1007/s11044-010-9237-4.
"""

from solar_env.mechanics.joints.contact.hertz import sphere
from solar_env.mechanics.joints.contact.power_law import PowerLaw
from solar_env.mechanics.joints.contact.surfaces import Surfaces


def damping(restitution: float) -> float:
    """Damping factor d = 8 (1 - e) / (5 e): the exit speed is within 0.04 of the restitution e."""
    return 1.6 * (1.0 - restitution) / restitution


def law(surfaces: Surfaces, restitution: float) -> PowerLaw:
    """The law of Flores et al. between spheres."""
    return sphere(surfaces, damping(restitution))
