"""Contact of a cylinder in a cylindrical seat with parallel axes: a journal in a long bearing.

C. Pereira, A. Ramalho and J. Ambrosio, Nonlinear Dyn. 63 (2011) 681, doi:10.1007/s11071-010-9830-3, and Multibody Syst.
Dyn. 35 (2015) 277, doi:10.1007/s11044-015-9449-x: a power law fitted to the implicit formula of line contact of
K. L. Johnson (Contact Mechanics, 1985), with a damping that is right for a restitution near 1.
"""

import math

from solar_env.mechanics.joints.contact import lankarani_nikravesh
from solar_env.mechanics.joints.contact.power_law import PowerLaw
from solar_env.mechanics.joints.contact.surfaces import Surfaces

LEAST_CLEARANCE, LARGEST_CLEARANCE = 5e-6, 1e-2  # m, of the fit


def law(surfaces: Surfaces, restitution: float) -> PowerLaw:
    """The law of Pereira, Ramalho and Ambrosio for internal contact.

    F = (0.965 c + 0.0965) L E* / c depth^n (1 + 3 (1 - e^2) / 4 rate / v) with n = Y c^-0.005, in N, mm and MPa, where
    c is the difference of the radii; Y = 1.51 ln(1000 c)^-0.151 for c below 0.34954, else 0.0151 c + 1.151.

    Raises:
        ValueError: if the clearance lies outside the range of the fit, or a stiffness is given.
    """
    clearance = surfaces.bearing_radius - surfaces.journal_radius
    if surfaces.stiffness is not None:
        raise ValueError(
            f"contact_stiffness = {surfaces.stiffness!r} is that of spheres; the law of Pereira et al. takes None and "
            "computes its own from radii, length and materials"
        )
    if not LEAST_CLEARANCE <= clearance <= LARGEST_CLEARANCE:
        raise ValueError(
            f"clearance = {clearance:.6g} m is outside the range of the law of Pereira et al., {LEAST_CLEARANCE:g} to "
            f"{LARGEST_CLEARANCE:g} m; choose another contact_law"
        )
    c = 1e3 * clearance
    y = 1.51 * math.log(1000.0 * c) ** -0.151 if c < 0.34954 else 0.0151 * c + 1.151
    exponent = y * c**-0.005
    # MPa times mm is a thousand times Pa times m over m, mm^n a thousandth of m to the n.
    stiffness = (0.965 * c + 0.0965) * (1e3 * surfaces.length) * (1e-6 / surfaces.compliance) / c * 1e3**exponent
    return PowerLaw(stiffness, exponent, lankarani_nikravesh.damping(restitution))
