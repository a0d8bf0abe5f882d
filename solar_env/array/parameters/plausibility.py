"""Values that no spacecraft has: most likely a slip of units, of which a warning tells before anything is simulated."""

import math
import warnings
from collections.abc import Callable
from typing import Any, NamedTuple

from solar_env.mechanics.running.diagnosis import SimulationWarning


class UnitWarning(SimulationWarning):
    """A parameter is so large or small that it was probably given in another unit."""


class Plausible(NamedTuple):
    """Magnitudes that a parameter has on spacecraft, with room to spare.

    Attributes:
        low, high: in the unit; 0 is plausible for whatever may be 0.
        unit: which is meant.
        slip: units that are easily given instead.
    """

    low: float
    high: float
    unit: str
    slip: str


_LENGTH = Plausible(0.005, 50.0, "m", "mm")
_MODULUS = Plausible(1e5, 5e12, "Pa", "MPa or GPa")
_SPEED = Plausible(1e-9, 1.0, "m/s", "mm/s")
PLAUSIBLE = {
    "body_mass": Plausible(0.05, 1e6, "kg", "g or t"),
    "body_inertia": Plausible(1e-5, 1e9, "kg m2", "kg mm2"),
    "hinge_x": Plausible(0.0, 50.0, "m", "mm"),
    "hinge_y": Plausible(0.0, 50.0, "m", "mm"),
    "body_size": _LENGTH,
    "panel_length": _LENGTH,
    "panel_width": _LENGTH,
    "panel_thickness": Plausible(1e-5, 0.5, "m", "mm"),
    "panel_density": Plausible(1.0, 3e4, "kg/m3", "g/cm3"),
    "panel_young": _MODULUS,
    "latch_ramp_depth": Plausible(0.0, 2.0 * math.pi, "rad", "degrees"),
    "clearance": Plausible(1e-9, 1e-2, "m", "mm"),
    "journal_radius": Plausible(1e-4, 0.5, "m", "mm"),
    "cable_wheel_radius": Plausible(1e-4, 5.0, "m", "mm"),
    "bearing_width": Plausible(1e-4, 50.0, "m", "mm"),
    "journal_young": _MODULUS,
    "bearing_young": _MODULUS,
    "minimum_impact_speed": _SPEED,
    "friction_speed_zero": _SPEED,
    "friction_speed_full": _SPEED,
    "wear_coefficient": Plausible(0.0, 1e-6, "m2/N", "mm3/(N m)"),
    "initial_spin": Plausible(0.0, 10.0, "rad/s", "degrees per second"),
    "initial_rate": Plausible(0.0, 10.0, "rad/s", "degrees per second"),
}

# Names and rounded values that were told in this process: the same array is described over and over in an ensemble.
_told: set[tuple[str, str]] = set()


def warn_of_implausible(entries: Callable[[str], tuple[Any, ...]]) -> None:
    """Warn, once a process, of each value beyond what spacecraft have.

    Args:
        entries: of a parameter by its name; all numbers, or None.

    Warns:
        UnitWarning: naming the parameter, its value, and the unit that is meant.
    """
    for name, usual in PLAUSIBLE.items():
        for value in entries(name):
            if value is None or value == 0.0 or usual.low <= abs(value) <= usual.high:
                continue
            key = name, f"{value:.2g}"
            if key in _told:
                break
            large = abs(value) > usual.high
            bound = f"large for a spacecraft (over {usual.high:.3g}" if large else f"small (under {usual.low:.3g}"
            text = (
                f"{name} = {value:g} {usual.unit} is implausibly {bound} {usual.unit}); give it in {usual.unit}, "
                f"not in {usual.slip}"
            )
            warnings.warn(text, UnitWarning, stacklevel=2)
            _told.add(key)
            break
