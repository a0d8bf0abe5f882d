"""Contact laws as data in the table `CONTACT_LAWS`, and definitions of the sliding speed.

This plain Python needs no compiler. The kernels that evaluate the laws are in `contact.py`, which also compiles the
static methods of `PowerLaw`. To add a contact law, write a function from `Surfaces` and a coefficient of restitution to
a `PowerLaw`, and enter the function in `CONTACT_LAWS`.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields

from solar_env.mechanics.numerics.checks import require, require_finite, require_signs

# Definitions of the sliding speed: relative speed of the touching material points; speed of the centres across their
# line; or speed at which the contact point moves round, depth / (clearance + depth) times the centres' speed (Eq 35).
SLIDING_READINGS = ("material", "centres", "places")
MATERIAL, CENTRES, PLACES = range(3)
LEAST_CLEARANCE, LARGEST_CLEARANCE = 5e-6, 1e-2  # m, clearance range of Pereira's fit


def impact_defect(d: float, e: float) -> float:
    """Return ln[(1 + d) / (1 - d e)] - d (1 + e): zero if damping factor d gives the exit-to-entry speed ratio e."""
    room = 1.0 - d * e
    return math.log1p(d) - math.log(room) - d * (1.0 + e) if room > 0.0 else math.inf


def bisect(function: Callable[[float], float], low: float, high: float) -> float:
    """Return the root of a function that is negative at `low` and positive at `high`."""
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if function(middle) > 0.0 else (middle, high)
    return low


@dataclass(frozen=True)
class PowerLaw:
    """Normal force F = K depth^n (1 + d rate / v), never attractive; v is the speed at which the contact began.

    K. H. Hunt and F. R. E. Crossley, J. Appl. Mech. 42 (1975) 440, doi:10.1115/1.3423596. The static methods hold for
    positive depths.

    Attributes:
        stiffness: K [N/m^n], whose unit depends on the exponent.
        exponent: n (dimensionless, 1 to 2); 1.5 for the point contact of spheres.
        damping: damping factor d (dimensionless).
    """

    stiffness: float
    exponent: float = 1.5
    damping: float = 0.0

    def __post_init__(self) -> None:
        require_finite(self)
        require_signs(self, positive=("stiffness",), not_negative=("damping",))
        require(1.0 <= self.exponent <= 2.0, self, "exponent", self.exponent, "must lie between 1 and 2")

    def parameters(self) -> tuple[float, ...]:
        """Return (K, n, d, T): the constants of F = K depth^n (1 + d rate / v), and an undamped impact's duration T.

        T is in units of greatest depth divided by impact speed v. It is twice the integral of dx / sqrt(1 - x^(n+1))
        from 0 to 1: 2 sqrt(pi) Gamma(1 + p) / Gamma(1/2 + p) with p = 1 / (n + 1); 2.94328 for n = 1.5 (K. L. Johnson,
        Contact Mechanics, 1985, section 11.4).
        """
        p = 1.0 / (self.exponent + 1.0)
        duration = 2.0 * math.sqrt(math.pi) * math.gamma(1.0 + p) / math.gamma(0.5 + p)
        return (*(getattr(self, item.name) for item in fields(self)), duration)

    def depth_under(self, load: float) -> float:
        """Return the depth [m] at which the contact at rest carries a load [N]."""
        return float((load / self.stiffness) ** (1.0 / self.exponent))

    def exit_speed_ratio(self) -> float:
        """Return an impact's ratio e of exit to entry speed, which depends on the damping factor d alone.

        The equation of motion m depth'' = -F separates into d (1 + e) = ln[(1 + d) / (1 - d e)].
        """
        d = self.damping
        if d < 3e-4:
            return 1.0 - 2.0 / 3.0 * d + 4.0 / 9.0 * d * d  # series, since the terms of the equation cancel
        return bisect(lambda e: impact_defect(d, e), 0.0, min(1.0, 1.0 / d))

    @staticmethod
    def energy(parameters: Sequence[float], depth: float) -> float:
        """Return the elastic energy [J] that a contact with these law `parameters` stores at a positive depth [m]."""
        stiffness, exponent = parameters[0], parameters[1]
        growth = math.sqrt(depth) if exponent == 1.5 else depth ** (exponent - 1.0)
        return 1.0 / (exponent + 1.0) * stiffness * depth * depth * growth

    @staticmethod
    def impact_scales(parameters: Sequence[float], inverse_mass: float, impact_speed: float) -> tuple[float, float]:
        """Return an undamped impact's greatest depth [m] and duration [s], given its inverse effective mass [1/kg]."""
        stiffness, power = parameters[0], parameters[1] + 1.0
        depth = (0.5 * power * impact_speed * impact_speed / (inverse_mass * stiffness)) ** (1.0 / power)
        return depth, parameters[3] * depth / impact_speed


@dataclass(frozen=True)
class Surfaces:
    """Radii, length and materials of a journal and its bearing.

    Attributes:
        bearing_radius, journal_radius: radii [m].
        length: axial length of the bearing [m].
        bearing_young, journal_young: moduli of elasticity [Pa].
        bearing_poisson, journal_poisson: Poisson's ratios.
        stiffness: measured stiffness of the contact of spheres [N/m^1.5]; None computes it from radii and materials.
        bracket_stiffness: radial stiffness of the journal's and bearing's brackets in series [N/m]; None if unknown.
    """

    bearing_radius: float
    journal_radius: float
    length: float
    bearing_young: float
    bearing_poisson: float
    journal_young: float
    journal_poisson: float
    stiffness: float | None = None
    bracket_stiffness: float | None = None

    def __post_init__(self) -> None:
        if not 0.0 < self.journal_radius < self.bearing_radius:
            raise ValueError(
                f"journal radius {self.journal_radius!r} must be positive and below the bearing's "
                f"{self.bearing_radius!r}"
            )
        if min(self.bearing_young, self.journal_young) <= 0.0:
            raise ValueError(f"Young's moduli must be positive, got {self.bearing_young!r} and {self.journal_young!r}")

    @property
    def compliance(self) -> float:
        """Inverse of the composite modulus E* [1/Pa]: sum of (1 - nu^2) / E for the two materials."""
        bearing = (1.0 - self.bearing_poisson**2) / self.bearing_young
        return bearing + (1.0 - self.journal_poisson**2) / self.journal_young


def lankarani_damping(restitution: float) -> float:
    """Return the damping factor 3 (1 - e^2) / 4, for restitutions e near 1; even e = 0 leaves 66 % of the speed."""
    return 0.75 * (1.0 - restitution**2)


def flores_damping(restitution: float) -> float:
    """Return the damping factor 8 (1 - e) / (5 e): the exit speed ratio is within 0.04 of the restitution e."""
    return 1.6 * (1.0 - restitution) / restitution


def exact_damping(restitution: float) -> float:
    """Return the damping factor d for which the exit speed ratio is e: d (1 + e) = ln[(1 + d) / (1 - d e)].

    The function inverts `PowerLaw.exit_speed_ratio`; the exit speed errs by less than 2e-11 of the entry speed.
    """
    e = restitution
    if e > 1.0 - 2e-4:
        return 1.5 * (1.0 - e**2) / (1.0 + e**3)  # limit for e near 1, since the terms of the equation cancel
    # Lankarani and Nikravesh's damping factor is a lower bound: it gives a faster exit.
    return bisect(lambda d: impact_defect(d, e), lankarani_damping(e), 1.0 / e)


def sphere(surfaces: Surfaces, damping: float) -> PowerLaw:
    """Return the contact law of a sphere in a spherical seat, F = K depth^1.5 (1 + `damping` * rate / impact speed).

    Unless `surfaces` gives it, K = 4 / (3 (h_b + h_j)) sqrt(R_b R_j / (R_b - R_j)) [N/m^1.5] with h = (1 - nu^2) / E
    and radius R of bearing (b) and journal (j): W. Goldsmith, Impact (1960); Eq 40 of Y. Li, C. Wang and W. Huang,
    Mech. Syst. Signal Process. 117 (2019) 188.
    """
    if surfaces.stiffness is not None:
        return PowerLaw(surfaces.stiffness, 1.5, damping)
    bearing, journal = surfaces.bearing_radius, surfaces.journal_radius
    radius = bearing * journal / (bearing - journal)
    return PowerLaw(4.0 / (3.0 * surfaces.compliance) * math.sqrt(radius), 1.5, damping)


def cylinder(surfaces: Surfaces, restitution: float) -> PowerLaw:
    """Return the contact law of a cylinder in a cylindrical seat with parallel axes: a journal in a long bearing.

    F = K depth^n (1 + d rate / v) with impact speed v and d = 3 (1 - e^2) / 4, where e is the restitution. In N, mm and
    MPa, K = (0.965 c + 0.0965) L E* / c and n = Y c^-0.005. Here c is the difference of the radii, L the bearing's
    length, E* the composite modulus; Y = 1.51 ln(1000 c)^-0.151 for c below 0.34954, else 0.0151 c + 1.151. This law
    fits K. L. Johnson's implicit line contact (Contact Mechanics, 1985): C. Pereira, A. Ramalho and J. Ambrosio,
    Nonlinear Dyn. 63 (2011) 681, doi:10.1007/s11071-010-9830-3; Multibody Syst. Dyn. 35 (2015) 277,
    doi:10.1007/s11044-015-9449-x.

    Raises:
        ValueError: if the clearance lies outside the range of the fit, or `surfaces.stiffness` is given.
    """
    clearance = surfaces.bearing_radius - surfaces.journal_radius
    _refuse_stiffness(surfaces, "the law of Pereira et al. takes None and computes its own from radii and materials")
    if not LEAST_CLEARANCE <= clearance <= LARGEST_CLEARANCE:
        raise ValueError(
            f"clearance = {clearance:.6g} m is outside the range of the law of Pereira et al., {LEAST_CLEARANCE:g} to "
            f"{LARGEST_CLEARANCE:g} m; choose another contact_law"
        )
    c = 1e3 * clearance
    y = 1.51 * math.log(1000.0 * c) ** -0.151 if c < 0.34954 else 0.0151 * c + 1.151
    exponent = y * c**-0.005
    # In N, mm and MPa as in the fit; the last factor turns N/mm^n into N/m^n.
    stiffness = (0.965 * c + 0.0965) * (1e3 * surfaces.length) * (1e-6 / surfaces.compliance) / c * 1e3**exponent
    return PowerLaw(stiffness, exponent, lankarani_damping(restitution))


def bracket(surfaces: Surfaces, restitution: float) -> PowerLaw:
    """Return the contact law of surfaces far stiffer than the brackets that carry the bearing and the journal.

    F = K depth (1 + d rate / v) with stiffness K of both brackets in series, damping factor d, and speed v at the start
    of contact; the surfaces' own depth is neglected. For example, 337 N move a bracket of 1e7 N/m by 34 um, but press a
    steel sphere of radius 4 mm only 2.5 um into a brass seat with 25 um of clearance. The restitution is exact.

    Raises:
        ValueError: if `surfaces.bracket_stiffness` is None, or `surfaces.stiffness`, which is for spheres, is given.
    """
    if surfaces.bracket_stiffness is None:
        raise ValueError("bracket_stiffness = None must be a stiffness [N/m] for the law of brackets")
    _refuse_stiffness(surfaces, "the law of brackets takes None, and bracket_stiffness instead")
    return PowerLaw(surfaces.bracket_stiffness, 1.0, exact_damping(restitution))


def _refuse_stiffness(surfaces: Surfaces, remedy: str) -> None:
    if surfaces.stiffness is not None:
        raise ValueError(f"contact_stiffness = {surfaces.stiffness!r} holds for spheres; {remedy}")


CONTACT_LAWS: dict[str, Callable[[Surfaces, float], PowerLaw]] = {
    # H. M. Lankarani and P. E. Nikravesh, J. Mech. Des. 112 (1990) 369, doi:10.1115/1.2912617.
    "lankarani-nikravesh": lambda surfaces, e: sphere(surfaces, lankarani_damping(e)),
    # P. Flores, M. Machado, M. T. Silva and J. M. Martins, Multibody Syst. Dyn. 25 (2011) 357.
    "flores": lambda surfaces, e: sphere(surfaces, flores_damping(e)),
    # H. Hertz, J. reine angew. Math. 92 (1881) 156: this law conserves energy at any requested restitution.
    "hertz": lambda surfaces, e: sphere(surfaces, 0.0),
    "restitution": lambda surfaces, e: sphere(surfaces, exact_damping(e)),
    "pereira": cylinder,
    "bracket": bracket,
}


def contact_law(name: str, surfaces: Surfaces, coefficient: float) -> PowerLaw:
    """Return the contact law called `name` for two surfaces and a coefficient of restitution in (0, 1].

    Raises:
        ValueError: if the law is unknown, or the restitution or the surfaces lie outside the law's range.
    """
    if name not in CONTACT_LAWS:
        raise ValueError(f"contact law {name!r} is unknown; choose from {', '.join(CONTACT_LAWS)}")
    if not 0.0 < coefficient <= 1.0:
        raise ValueError(f"restitution = {coefficient!r} must lie in (0, 1]")
    return CONTACT_LAWS[name](surfaces, coefficient)
