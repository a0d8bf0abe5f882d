"""Plans of the charts: extent of the measurements, in full or in two minutes."""

from dataclasses import dataclass, replace

from solar_env.array import MODELS, ArrayParameters
from solar_env.studies.common.motion import Scene, with_panels

# The peer's friction sets in at rest; everything is measured with the same law.
PARAMETERS = ArrayParameters(friction_speed_zero=0.0)
# Springs 25 times as stiff deploy the array in a fifth of the time; the preload keeps the cable taut under them.
FAST_PARAMETERS = replace(PARAMETERS, spring_stiffness=(2.5, 1.875), cable_preload_force=1250.0)


@dataclass(frozen=True)
class Ensemble:
    """A level of the study of convergence, and the size of its ensemble."""

    panels: str  # "6 elements" or "32 modes"; empty for rigid panels
    members: int  # runs with clearance
    tighter: float = 1.0  # divisor of the default tolerance


# Levels from the coarsest to the finest of each family.
LEVELS = (
    Ensemble("", 48),
    *(Ensemble(f"{elements} elements", 16) for elements in (1, 2, 4, 6, 12, 24)),
    Ensemble("48 elements", 6),
    *(Ensemble(f"{modes} modes", 48) for modes in (4, 8, 16, 24, 32, 48)),
    *(Ensemble(f"{modes} modes", 48, tighter) for modes, tighter in ((32, 2.0), (32, 4.0), (48, 10.0))),
)
SHORT_LEVELS = (
    Ensemble("", 2),
    *(Ensemble(f"{elements} elements", 2) for elements in (1, 2, 4)),
    *(Ensemble("8 modes", 2, tighter) for tighter in (1.0, 2.0)),
)


@dataclass(frozen=True)
class ChartPlan:
    """Scenes that a chart simulates, and how often."""

    models: tuple[str, ...] = MODELS
    parameters: ArrayParameters = PARAMETERS
    panels: str = "6 elements"  # parts of flexible panels, where the method does not prescribe them
    duration: float = 13.0  # duration of deployments [s]; beyond the latching
    before_latch: float = 12.0  # time up to which angles are compared [s]
    settings: int | None = None  # number of a method's settings measured, from the coarsest; None for all
    repeats: int = 3  # repeats of every measured time
    ensemble_size: int = 16  # runs of an ensemble side by side, see `motion.perturbed`
    ensemble_duration: float = 16.0  # duration of the deployments in the study of convergence [s]
    levels: tuple[Ensemble, ...] = LEVELS  # levels of that study; the last of beams and of modes are the finest
    side_duration: float = 30.0  # duration of the deployments that are timed side by side [s]

    def deployment(self, model: str) -> Scene:
        """Make the scene of a model's deployment, up to a moment after its latching."""
        return Scene(with_panels(model, self.panels), self.parameters, self.duration, self.before_latch / 120.0)


FULL = ChartPlan()
QUICK = ChartPlan(
    parameters=FAST_PARAMETERS,
    panels="2 elements",
    duration=2.6,
    before_latch=2.2,
    settings=2,
    repeats=1,
    ensemble_size=3,
    ensemble_duration=3.0,
    levels=SHORT_LEVELS,
    side_duration=3.0,
)
