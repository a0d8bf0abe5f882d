"""Maps of modal panels: how soft they may be before their second order fails.

The first is of one panel of the array's, softened. On the left it spins freely: its lowest bending frequency beside
that of beam elements, which have the inertia of the turning frame. On the right it is held at one end and loaded across
the other: its deflection beside the elastica's; a softer panel under less load bends alike.

The second is of whole deployments of softened panels on springs of several strengths, with ideal joints: the impulse on
the joints from the latch on beside that of beam elements. Their result converges with the square of the elements'
length: the one compared with is extrapolated from two meshes (L. F. Richardson, 1911, doi:10.1098/rsta.1911.0009).
"""

import math
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solar_env.array import ArrayParameters
from solar_env.array.deployment import simulate
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

_ARRAY = ArrayParameters()
_LATCH_TIME = 12.3  # s, of the array as it is
_OBSERVED = 1.3  # of latch times
_MESHES = (12, 24)
_MESH_RTOL, _MODAL_RTOL = 1e-5, 2e-5
_IMPULSE_TOLERANCE = 0.03  # of levels


def _impulses(softening: float, strength: float, **panels: Any) -> NDArray[np.float64]:
    """Impulses on the joints from the latch to a few seconds after it [N s]."""
    springs = tuple(strength * stiffness for stiffness in _ARRAY.for_each_joint("spring_stiffness"))
    softer = replace(_ARRAY, panel_young=_ARRAY.panel_young / softening, spring_stiffness=springs)
    duration = _OBSERVED * _LATCH_TIME / math.sqrt(strength)
    return np.asarray(simulate(softer, model="flexible-ideal", duration=duration, **panels).postlock_impulse)


def measure_deployment(panel: str, softening: float, strength: float) -> Cell:
    """Greatest relative difference of an impulse from that of beam elements."""

    def run() -> float:
        coarse, fine = (_impulses(softening, strength, elements=count, rtol=_MESH_RTOL) for count in _MESHES)
        extrapolated = (4.0 * fine - coarse) / 3.0
        differences = _impulses(softening, strength, panels="modal", rtol=_MODAL_RTOL) / extrapolated - 1.0
        return float(differences[np.abs(differences).argmax()])

    return listen(run).cell(lambda error: Cell(Kind.FINE if abs(error) < _IMPULSE_TOLERANCE else Kind.WRONG, error))


DEPLOYMENT = StabilityMap(
    name="modal-array",
    title="Deployments of softened modal panels agree with beam elements until they warn",
    x=Axis("softening", "panels softer than the array's by", (10, 300), (1, 3, 10, 30, 100, 300, 1000)),
    y=Axis("strength", "springs stronger than the array's by", (1.0,), (0.1, 0.3, 1.0, 3.0, 10.0)),
    panels=("ideal joints, impulse from the latch on",),
    quantity="relative difference",
    advice="Describe panels that bend by more than the warning allows as beam elements (panels='ancf').",
    measure=measure_deployment,
)
