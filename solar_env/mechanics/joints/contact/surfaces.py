"""The two surfaces that touch in a bearing: what a contact law may depend on."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Surfaces:
    """Radii, length and materials of a journal and its bearing.

    Attributes:
        bearing_radius, journal_radius: [m].
        length: of the bearing along its axis [m].
        bearing_young, journal_young: moduli of elasticity [Pa].
        bearing_poisson, journal_poisson: Poisson's ratios.
        stiffness: that of the contact of spheres [N/m^1.5], as measured; None for the one that radii and materials
            give.
    """

    bearing_radius: float
    journal_radius: float
    length: float
    bearing_young: float
    bearing_poisson: float
    journal_young: float
    journal_poisson: float
    stiffness: float | None = None

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
        """Sum of (1 - nu^2) / E of the two materials [1/Pa], the inverse of their composite modulus E*."""
        bearing = (1.0 - self.bearing_poisson**2) / self.bearing_young
        return bearing + (1.0 - self.journal_poisson**2) / self.journal_young
