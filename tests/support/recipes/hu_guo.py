"""Contact law of S. Hu and X. Guo, Multibody Syst. Dyn. 35 (2015) 131, doi:10.1007/s11044-015-9453-z."""

from solar_env.mechanics.joints.contact.hertz import sphere
from solar_env.mechanics.joints.contact.power_law import PowerLaw
from solar_env.mechanics.joints.contact.surfaces import Surfaces


def law(surfaces: Surfaces, restitution: float) -> PowerLaw:
    """The law of Hu and Guo between spheres, with the damping factor d = 3 (1 - e) / (2 e)."""
    return sphere(surfaces, 1.5 * (1.0 - restitution) / restitution)
