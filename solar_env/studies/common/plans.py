"""Extent of the measurements of speed against accuracy: a full plan, and a plan of two minutes."""

from dataclasses import dataclass, replace

from solar_env.array import MODELS, ArrayParameters
from solar_env.studies.common.motion import Scene, with_panels

# Exudyn's friction sets in at rest; all programs are measured with the same friction law.
PARAMETERS = ArrayParameters(friction_speed_zero=0.0)
# Springs 25 times as stiff deploy the array in a fifth of the time; the preload keeps the cable taut under them.
FAST_PARAMETERS = replace(PARAMETERS, spring_stiffness=(2.5, 1.875), cable_preload_force=1250.0)


@dataclass(frozen=True)
class Ensemble:
    """A model level of the convergence study, and the size of the ensemble simulated at the level."""

    panels: str  # "6 elements" or "32 modes"; empty for rigid panels
    members: int  # number of runs with clearance
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
    """Plan of the charts of speed against accuracy: deployments to simulate, settings, repeats and ensemble sizes."""

    models: tuple[str, ...] = MODELS
    parameters: ArrayParameters = PARAMETERS
    panels: str = "6 elements"  # flexible panels of methods that do not prescribe the panels
    duration: float = 13.0  # duration of deployments [s], which end after the latching
    before_latch: float = 12.0  # time up to which angles are compared [s]
    settings: int | None = None  # number of a method's settings measured, from the coarsest; None for all
    repeats: int = 3  # repeats of every measured time
    ensemble_size: int = 16  # ensemble members in the study `side_by_side`, see `motion.perturbed`
    ensemble_duration: float = 16.0  # duration of the deployments in the convergence study [s]
    levels: tuple[Ensemble, ...] = LEVELS  # convergence levels; the last beams and the last modes are the finest
    side_duration: float = 30.0  # duration of the deployments that are timed side by side [s]

    def deployment(self, model: str) -> Scene:
        """Return a deployment that ends after latching, at a model level such as "flexible-ideal".

        `model` names the level; flexible panels have the modes or elements that `self.panels` states.
        """
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
