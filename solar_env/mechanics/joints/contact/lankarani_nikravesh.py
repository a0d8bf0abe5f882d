"""Contact law of H. M. Lankarani and P. E. Nikravesh, J. Mech. Des. 112 (1990) 369, doi:10.1115/1.2912617."""

from solar_env.mechanics.joints.contact.hertz import sphere
from solar_env.mechanics.joints.contact.power_law import PowerLaw
from solar_env.mechanics.joints.contact.surfaces import Surfaces


def damping(restitution: float) -> float:
    """Damping factor d = 3 (1 - e^2) / 4: right for a restitution e near 1, and never below an exit speed of 0.66."""
    return 0.75 * (1.0 - restitution**2)


def law(surfaces: Surfaces, restitution: float) -> PowerLaw:
    """The law of Lankarani and Nikravesh between spheres."""
    return sphere(surfaces, damping(restitution))
