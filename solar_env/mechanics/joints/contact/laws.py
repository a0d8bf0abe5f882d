"""Table of the contact laws by name. Plain Python: describing a mechanism needs no compiler."""

from collections.abc import Callable

from solar_env.mechanics.joints.contact import flores, hertz, lankarani_nikravesh, pereira, restitution
from solar_env.mechanics.joints.contact.power_law import PowerLaw
from solar_env.mechanics.joints.contact.surfaces import Surfaces

# All forms of force: each has a code, checked attributes and `parameters`, `depth_under` and `exit_speed_ratio`.
ContactLaw = PowerLaw

CONTACT_LAWS: dict[str, Callable[[Surfaces, float], ContactLaw]] = {
    "lankarani-nikravesh": lankarani_nikravesh.law,
    "flores": flores.law,
    "hertz": hertz.law,
    "restitution": restitution.law,
    "pereira": pereira.law,
}


def contact_law(name: str, surfaces: Surfaces, coefficient: float) -> ContactLaw:
    """The contact law of a name between two surfaces, at a coefficient of restitution in (0, 1].

    Raises:
        ValueError: if the law is unknown, or the restitution or the surfaces lie outside the law's range.
    """
    if name not in CONTACT_LAWS:
        raise ValueError(f"contact law {name!r} is unknown; choose from {', '.join(CONTACT_LAWS)}")
    if not 0.0 < coefficient <= 1.0:
        raise ValueError(f"restitution = {coefficient!r} must lie in (0, 1]")
    return CONTACT_LAWS[name](surfaces, coefficient)
