"""The methods that are charted, by name, each at several steps or tolerances from the coarsest to the finest.

A further integrator is one more row of METHODS.
"""

import importlib.util
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

from solar_env.array import MODELS
from solar_env.mechanics.integrators.settings import (
    GeneralizedAlpha,
    Integrator,
    ModalRadau,
    Rosenbrock,
    RungeKutta,
)
from solar_env.studies.common.motion import Motion, Scene, run_own, with_panels
from solar_env.studies.peers.scipy_methods import run_scipy

MISSING_PEER = "Exudyn is not installed, its methods are left out: pip install -e '.[peers]'"

Settings = tuple[float, ...]
Program = Callable[[Scene, float], Motion]


@dataclass(frozen=True)
class Method:
    """A way to simulate a scene.

    Attributes:
        name: in tables and legends.
        setting: what is varied: "rtol" or "step" [s].
        program: scene and setting to motion; raises SimulationError if the run cannot go on.
        settings: model -> values of the setting; a model that is not there is left out.
        dear: model -> further values, long runs that only the full chart makes.
        needs: distribution that must be installed besides the project.
        panels: what the only flexible panels consist of that it takes, as "32 modes"; empty for those of the scene.
    """

    name: str
    setting: str
    program: Program
    settings: Mapping[str, Settings]
    dear: Mapping[str, Settings] = field(default_factory=dict)
    needs: str | None = None
    panels: str = ""

    @property
    def available(self) -> bool:
        """Whether what the method needs is installed."""
        return self.needs is None or importlib.util.find_spec(self.needs) is not None

    def solve(self, scene: Scene, setting: float) -> Motion:
        """A scene with the method's panels.

        Raises:
            SimulationError: if the run cannot go on.
        """
        return self.program(self.scene(scene), setting)

    def scene(self, scene: Scene) -> Scene:
        """The scene with the method's panels."""
        return replace(scene, model=with_panels(scene.model, self.panels)) if self.panels else scene

    def size(self, scene: Scene) -> str:
        """Panels of a run in words: "rigid", "6 elements", "32 modes"."""
        return self.scene(scene).level.size


def own(make: Callable[[float], Integrator]) -> Program:
    """A solver from one of the project's integrators, made from a setting."""
    return lambda scene, setting: run_own(scene, make(setting))


def scipy(name: str) -> Program:
    """A solver from one of SciPy's integrators."""
    return lambda scene, rtol: run_scipy(scene, name, rtol)


def exudyn(solver: str) -> Program:
    """A solver from one of Exudyn's, see `exudyn_runs`; loaded when it runs."""

    def solve(scene: Scene, setting: float) -> Motion:
        from solar_env.studies.peers.exudyn_runs import run_exudyn

        return run_exudyn(scene, solver, setting)

    return solve


def _by_model(
    rigid_ideal: Settings = (),
    rigid_clearance: Settings = (),
    flexible_ideal: Settings = (),
    flexible_clearance: Settings = (),
) -> dict[str, Settings]:
    named = zip(MODELS, (rigid_ideal, rigid_clearance, flexible_ideal, flexible_clearance), strict=True)
    return {model: settings for model, settings in named if settings}


# fmt: off
METHODS: tuple[Method, ...] = (
    Method(
        "runge-kutta", "rtol", own(lambda rtol: RungeKutta(rtol=rtol)),
        _by_model((1e-4, 1e-6, 1e-8, 1e-10, 1e-11, 1e-12), (1e-4, 1e-5, 5e-7, 1e-8, 1e-10, 1e-11, 1e-12),
                  (1e-3, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9), (1e-3, 1e-5, 1e-6, 1e-8, 1e-9)),
    ),
    Method(
        "rosenbrock", "rtol", own(lambda rtol: Rosenbrock(rtol=rtol)),
        _by_model((), (), (1e-2, 1e-3, 1e-4, 1e-5, 1e-6), (1e-2, 1e-3, 1e-4, 1e-5)),
    ),
    Method(
        "modal-radau", "rtol", own(lambda rtol: ModalRadau(rtol=rtol)),
        _by_model((), (3e-2, 1e-2, 1e-3, 1e-4), (1e-3, 3e-4, 1e-4, 1e-5, 1e-6), (3e-2, 1e-2, 1e-3, 1e-4, 1e-5)),
        panels="32 modes",
    ),
    Method(
        "generalized-alpha", "step", own(lambda step: GeneralizedAlpha(step=step)),
        _by_model((1e-2, 1e-3, 1e-4), (1e-4, 5e-5, 2e-5, 1e-5), (1e-2, 5e-3, 2e-3, 1e-3, 1e-4), (1e-4, 5e-5, 2e-5)),
    ),
    Method(
        "generalized-alpha, adaptive", "rtol", own(lambda rtol: GeneralizedAlpha(rtol=rtol)),
        _by_model((1e-3, 1e-5, 1e-7), (1e-4, 1e-5, 1e-6, 1e-7), (1e-3, 1e-4, 1e-5), (1e-3, 1e-4)),
    ),
    Method(
        "paper's scheme", "step", own(lambda step: GeneralizedAlpha(step=step, rho_inf=1.0)),
        _by_model((1e-2, 1e-3, 1e-4), (1e-4, 5e-5, 2e-5), (1e-2, 1e-3, 1e-4), (1e-4, 5e-5)),
    ),
    Method(
        "SciPy DOP853", "rtol", scipy("DOP853"),
        _by_model((1e-4, 1e-6, 1e-8, 1e-11, 1e-12)),
        dear=_by_model((), (1e-6, 1e-9, 1e-11, 1e-12), (1e-8,), (1e-8,)),
    ),
    Method(
        "SciPy Radau", "rtol", scipy("Radau"),
        _by_model((1e-3, 1e-5, 1e-7, 1e-9), (), (1e-2, 1e-3, 1e-4, 1e-5)), dear=_by_model((), (1e-4, 1e-6)),
    ),
    Method(
        "Exudyn generalized-alpha", "step", exudyn("generalized-alpha"),
        _by_model((1e-2, 1e-3, 1e-4), (1e-4, 5e-5, 2e-5), (5e-3, 1e-3)),
        dear=_by_model(flexible_ideal=(1e-4,), flexible_clearance=(5e-4, 1e-4)), needs="exudyn",
    ),
    Method(
        "Exudyn explicit", "step", exudyn("explicit"),
        _by_model((5e-2, 1e-2, 1e-3), (5e-5, 2e-5, 1e-5)), needs="exudyn",
    ),
)
# fmt: on

# Two methods that have no code in common but the forces, each at its two smallest tolerances where that takes no hours.
Pairs = tuple[tuple[str, Settings], ...]
REFERENCES: dict[str, Pairs] = {
    "rigid-ideal": (("runge-kutta", (1e-12, 1e-11)), ("SciPy DOP853", (1e-12, 1e-11))),
    "rigid-clearance": (("runge-kutta", (1e-12, 1e-11)), ("SciPy DOP853", (1e-12, 1e-11))),
    "flexible-ideal": (("runge-kutta", (1e-9, 1e-8)), ("SciPy DOP853", (1e-8,))),
    "flexible-clearance": (("runge-kutta", (1e-9, 1e-8)), ("SciPy DOP853", (1e-8,))),
}
# Modal panels are another model, with one method: its finest run stands for it.
MODAL_REFERENCES: dict[str, Pairs] = {
    "flexible-ideal": (("modal-radau", (1e-6, 1e-5)),),
    "flexible-clearance": (("modal-radau", (1e-5, 1e-4)),),
}
# Of short plans: with clearance what is left is chaos, whatever the method.
SHORT_REFERENCES: dict[str, Pairs] = {
    "rigid-ideal": (("runge-kutta", (1e-12,)), ("SciPy DOP853", (1e-12,))),
    "rigid-clearance": (("runge-kutta", (1e-12,)), ("generalized-alpha, adaptive", (1e-7,))),
    "flexible-ideal": (("runge-kutta", (1e-9,)), ("SciPy DOP853", (1e-8,))),
    "flexible-clearance": (("runge-kutta", (1e-9,)), ("generalized-alpha, adaptive", (1e-4,))),
}


def find_method(name: str) -> Method:
    """A method by its name.

    Raises:
        ValueError: if the name is unknown.
    """
    for method in METHODS:
        if method.name == name:
            return method
    raise ValueError(f"method {name!r} is unknown; choose from {', '.join(m.name for m in METHODS)}")


def peer_is_missing() -> bool:
    """Whether a method must be left out because what it needs is not installed."""
    return any(not method.available for method in METHODS)
