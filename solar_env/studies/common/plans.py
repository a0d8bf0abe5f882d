"""Plans of the charts: how much is measured, in full or in two minutes."""

from dataclasses import dataclass, replace

from solar_env.array import MODELS, ArrayParameters, PanelModel, has_flexible_panels
from solar_env.array.panels import ANCF, MODAL
from solar_env.studies.common.motion import BEAMS, Scene

# The peer's friction sets in at rest; everything is measured with the same law.
PARAMETERS = ArrayParameters(friction_speed_zero=0.0)
# Springs 25 times as stiff deploy the array in a fifth of the time; the preload keeps the cable taut under them.
FAST_PARAMETERS = replace(PARAMETERS, spring_stiffness=(2.5, 1.875), cable_preload_force=1250.0)


@dataclass(frozen=True)
class Ensemble:
    """A level of the convergence study: panels, None for rigid ones, and its members with clearance.

    Attributes:
        panels: model of the panels.
        members: runs with clearance.
        tighter: what the default tolerance is divided by.
    """

    panels: PanelModel | None
    members: int
    tighter: float = 1.0


# From the coarsest to the finest of each family. A level without members is a reference of ideal joints alone.
LEVELS = (
    Ensemble(None, 48),
    *(Ensemble(PanelModel(ANCF, elements), 16) for elements in (1, 2, 4, 6, 12, 24)),
    Ensemble(PanelModel(ANCF, 48), 6),
    Ensemble(PanelModel(ANCF, 24), 0, tighter=10.0),
    *(Ensemble(PanelModel(MODAL, modes), 48) for modes in (4, 8, 16, 24, 32, 48)),
    *(Ensemble(PanelModel(MODAL, modes), 48, tighter) for modes, tighter in ((32, 2.0), (32, 4.0), (48, 10.0))),
)
SHORT_LEVELS = (
    Ensemble(None, 2),
    *(Ensemble(PanelModel(ANCF, elements), 2) for elements in (1, 2, 4)),
    *(Ensemble(PanelModel(MODAL, 8), 2, tighter) for tighter in (1.0, 2.0)),
)


@dataclass(frozen=True)
class Durations:
    """Durations of a model with rigid and of one with flexible panels [s]."""

    rigid: float
    flexible: float

    def of(self, model: str) -> float:
        """Duration of a model [s]."""
        return self.flexible if has_flexible_panels(model) else self.rigid


@dataclass(frozen=True)
class ChartPlan:
    """Scenes that a chart simulates, and how often.

    Attributes:
        models: of the array.
        parameters: of the array.
        panels: model of the panels, with methods that have none of their own.
        duration: of deployments [s]; beyond the latching.
        before_latch: up to which angles are compared [s].
        impacts_duration: how much of the initial phase is looked at for impacts.
        settings: how many settings of a method are measured, from the coarsest; None for all.
        repeats: of every measured time.
        dear: whether methods are measured that take minutes.
        ensemble_size: runs of an ensemble, see `motion.perturbed`.
        ensemble_duration: of these.
        levels: that are compared; the last of beams and of modes are the finest of their families.
        block_modes, block_members: numbers of modes at which the residual blocks of modal panels are varied, and runs
            with clearance at each.
        growth_elements, growth_modes, growth_panels: at which the cost is measured.
        growth_duration: [s].
        side_duration: of the deployments that are timed side by side [s].
    """

    models: tuple[str, ...] = MODELS
    parameters: ArrayParameters = PARAMETERS
    panels: PanelModel = BEAMS
    duration: float = 13.0
    before_latch: float = 12.0
    impacts_duration: Durations = Durations(1.0, 0.15)
    settings: int | None = None
    repeats: int = 3
    dear: bool = True
    ensemble_size: int = 16
    ensemble_duration: Durations = Durations(20.0, 16.0)
    levels: tuple[Ensemble, ...] = LEVELS
    block_modes: tuple[int, ...] = (8, 16, 32, 48)
    block_members: int = 16
    growth_elements: tuple[int, ...] = (2, 4, 6, 8, 12, 16, 24, 32, 48)
    growth_modes: tuple[int, ...] = (4, 8, 16, 24, 48, 96)
    growth_panels: tuple[int, ...] = (1, 2, 3, 4, 5, 6, 7, 8)
    growth_duration: float = 0.5
    side_duration: float = 30.0

    def deployment(self, model: str) -> Scene:
        """The deployment of a model up to a moment after its latching."""
        return Scene(model, self.parameters, self.duration, self.before_latch / 120.0, self.panels)

    def initial_phase(self, model: str) -> Scene:
        """The first impacts of a model with clearance."""
        duration = self.impacts_duration.of(model)
        return Scene(model, self.parameters, duration, duration / 10.0, self.panels, every_contact=True)


FULL = ChartPlan()
QUICK = ChartPlan(
    parameters=FAST_PARAMETERS,
    panels=PanelModel(ANCF, 2),
    duration=2.6,
    before_latch=2.2,
    impacts_duration=Durations(0.2, 0.05),
    settings=2,
    repeats=1,
    dear=False,
    ensemble_size=3,
    ensemble_duration=Durations(4.0, 3.0),
    levels=SHORT_LEVELS,
    block_modes=(8,),
    block_members=2,
    growth_elements=(2, 4, 8, 16),
    growth_modes=(8, 16, 32),
    growth_panels=(1, 2, 4),
    growth_duration=0.1,
    side_duration=3.0,
)
