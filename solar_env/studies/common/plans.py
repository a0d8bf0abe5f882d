"""Plans of the charts: how much is measured, in full or in two minutes."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from solar_env.array import MODELS, ArrayParameters
from solar_env.studies.common.motion import Scene

# The peer's friction sets in at rest; everything is measured with the same law.
PARAMETERS = ArrayParameters(friction_speed_zero=0.0)
# Springs 25 times as stiff deploy the array in a fifth of the time; the preload keeps the cable taut under them.
FAST_PARAMETERS = replace(PARAMETERS, spring_stiffness=(2.5, 1.875), cable_preload_force=1250.0)


@dataclass(frozen=True)
class Plan:
    """Scenes that a chart simulates, and how often.

    Attributes:
        models: of the array.
        parameters: of the array.
        elements: of each flexible panel.
        duration: of deployments [s]; beyond the latching.
        before_latch: up to which angles are compared [s].
        impacts_duration: how much of the initial phase is looked at for impacts, with rigid and flexible panels [s].
        settings: how many settings of a method are measured, from the coarsest; None for all.
        repeats: of every measured time.
        long_run: a run that takes longer than this is not repeated [s].
        dear: whether methods are measured that take minutes.
        ensemble_size: runs whose hinges differ by `motion.PERTURBATION`.
        ensemble_duration: of these, with rigid and flexible panels [s].
        levels: numbers of elements that are compared; the last one is the reference.
        level_members: runs of an ensemble at each level.
        growth_elements, growth_panels: at which the cost is measured.
        growth_duration: [s].
        side_duration: of the deployments that are timed side by side [s].
    """

    models: tuple[str, ...] = MODELS
    parameters: ArrayParameters = PARAMETERS
    elements: int = 6
    duration: float = 13.0
    before_latch: float = 12.0
    impacts_duration: Mapping[str, float] = field(default_factory=lambda: {"rigid": 1.0, "flexible": 0.15})
    settings: int | None = None
    repeats: int = 3
    long_run: float = 10.0
    dear: bool = True
    ensemble_size: int = 16
    ensemble_duration: Mapping[str, float] = field(default_factory=lambda: {"rigid": 20.0, "flexible": 16.0})
    levels: tuple[int, ...] = (1, 2, 4, 6, 12, 24)
    level_members: int = 6
    growth_elements: tuple[int, ...] = (2, 4, 6, 8, 12, 16, 24, 32, 48)
    growth_panels: tuple[int, ...] = (1, 2, 3, 4, 5, 6, 7, 8)
    growth_duration: float = 0.5
    side_duration: float = 30.0

    def deployment(self, model: str) -> Scene:
        """The deployment of a model up to a moment after its latching."""
        return Scene(model, self.parameters, self.duration, self.before_latch / 120.0, self.elements)

    def initial_phase(self, model: str) -> Scene:
        """The first impacts of a model with clearance."""
        duration = self.impacts_duration[model.partition("-")[0]]
        return Scene(model, self.parameters, duration, duration / 10.0, self.elements, every_contact=True)


FULL = Plan()
QUICK = Plan(
    parameters=FAST_PARAMETERS,
    elements=2,
    duration=2.6,
    before_latch=2.2,
    impacts_duration={"rigid": 0.2, "flexible": 0.05},
    settings=2,
    repeats=1,
    dear=False,
    ensemble_size=3,
    ensemble_duration={"rigid": 4.0, "flexible": 3.0},
    levels=(1, 2, 4),
    level_members=2,
    growth_elements=(2, 4, 8, 16),
    growth_panels=(1, 2, 4),
    growth_duration=0.1,
    side_duration=3.0,
)
