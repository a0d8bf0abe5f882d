"""Map of modal panels: how soft one may be at a spin, or under a load at its end, before their second order fails.

The panel is one of the array's, softened. On the left it spins freely: its lowest bending frequency beside that of beam
elements, which have the inertia of the turning frame. On the right it is held at one end and loaded across the other:
its deflection beside the elastica's; a softer panel under less load bends alike.
"""

import math

from solar_env.mechanics.mechanism.beams import PANEL
from solar_env.mechanics.mechanism.description import Mechanism
from solar_env.mechanics.running.diagnosis import LARGEST_MODAL_SHARE, SPIN_STIFFENING
from solar_env.studies.stability.maps import Axis, Cell, Kind, StabilityMap, listen, log_range
from solar_env.verification.panels.dynamics import softened, spinning_frequency
from solar_env.verification.panels.mechanisms import modal, start
from solar_env.verification.panels.statics import bent
from solar_env.verification.panels.theory import first_frequency

SPIN, LOAD = "free spin, lowest frequency", "load on a held panel's tip, deflection"
_TOLERANCE = 0.01
_STEPS = 30_000  # far from its range the method needs millions
_FREQUENCY = first_frequency(PANEL.length, PANEL.mass, PANEL.bending_stiffness)
# Slope of the end against mean axes [rad] over P L^2 / (E I), of a cantilever in linear theory.
_SLOPE = 7.0 / 20.0


def _load(softening: float, force: float) -> float:
    """P L^2 / (E I)."""
    return force * softening * PANEL.length**2 / PANEL.bending_stiffness


def _spin_error(softening: float, spin: float) -> float:
    beam = softened(softening)
    start(Mechanism((modal(beam, spin=spin),))).check()
    return _FREQUENCY / math.sqrt(softening) / spinning_frequency(beam, spin) - 1.0


def measure_error(panel: str, softening: float, demand: float) -> Cell:
    """Relative error of a frequency or of a deflection."""

    def run() -> float:
        if panel == SPIN:
            return _spin_error(softening, demand)
        return bent(_load(softening, demand), 0.0, _STEPS)[1]

    return listen(run).cell(lambda error: Cell(Kind.FINE if abs(error) < _TOLERANCE else Kind.WRONG, error))


def warning_limit(panel: str, demand: float) -> float:
    """Softening from which on a run warns, by linear theory."""
    if panel == SPIN:
        return LARGEST_MODAL_SHARE / SPIN_STIFFENING * (_FREQUENCY / demand) ** 2
    return math.sqrt(4.0 * LARGEST_MODAL_SHARE) / (_SLOPE * _load(1.0, demand))


RANGE = StabilityMap(
    name="modal-range",
    title="Modal panels warn before their second order leaves out 1 %",
    x=Axis("softening", "softer than a panel of the array by", (1, 30, 1000), log_range(1.0, 1000.0, 10)),
    y=Axis("demand", "spin [rad/s], load [N]", (0.3, 3.0), log_range(0.1, 10.0, 9)),
    panels=(SPIN, LOAD),
    quantity="relative error",
    advice="Describe panels that turn or bend by more than the warning allows as beam elements (FlexibleBody).",
    measure=measure_error,
    limit=warning_limit,
    limit_label="the run warns from here on",
)
