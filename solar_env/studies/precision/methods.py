"""Simulation methods that the charts compare, each at several steps or tolerances from coarsest to finest.

To add an integrator, add a row to METHODS.
"""

import importlib.util
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

from solar_env.array import MODELS
from solar_env.mechanics.integrators.settings import (
    GeneralizedAlpha,
    Integrator,
    ModalRadau,
    Rosenbrock,
    RungeKutta,
)
from solar_env.studies.common.motion import Motion, Scene, run_ours, with_panels

MISSING_PEER = "Exudyn is not installed, its methods are left out: pip install -e '.[peers]'"

Settings = tuple[float, ...]
Program = Callable[[Scene, float], Motion]


@dataclass(frozen=True)
class Method:
    """A simulation method: a program, and the settings at which the charts measure the program.

    Attributes:
        setting: quantity that is varied: "rtol" or "step" [s].
        program: function from a `Scene` and a setting to a `Motion`; raises SimulationError if the run cannot go on.
        settings: model -> values of the setting; the method is not run on models without an entry.
        peer: true if the method is Exudyn's.
        panels: the only flexible panels that the method can simulate, such as "32 modes"; empty for any panels.
    """

    setting: str
    program: Program
    settings: Mapping[str, Settings]
    peer: bool = False
    panels: str = ""

    @property
    def available(self) -> bool:
        """True if the program that the method needs is installed."""
        return not (self.peer and peer_is_missing())

    def solve(self, scene: Scene, setting: float) -> Motion:
        """Simulate a deployment at a step [s] or tolerance `setting`, and return its `Motion` record.

        If the method can simulate only one kind of flexible panels, they replace the deployment's flexible panels.
        """
        return self.program(self.scene(scene), setting)

    def scene(self, scene: Scene) -> Scene:
        """Return `scene` with its flexible panels replaced by the method's own `panels`, unchanged if that is empty."""
        return replace(scene, model=with_panels(scene.model, self.panels)) if self.panels else scene

    def size(self, scene: Scene) -> str:
        """Return the panels of a run in words: "rigid", "6 elements", "32 modes"."""
        return self.scene(scene).level.size


def ours(make: Callable[[float], Integrator]) -> Program:
    """Return a function that maps a deployment and a step or tolerance to a `Motion`; `make` makes our integrator."""
    return lambda scene, setting: run_ours(scene, make(setting))


def exudyn(solver: str) -> Program:
    """Return a function that simulates a deployment by Exudyn at a given step [s] and returns a `Motion`.

    `solver` is "explicit" or "generalized-alpha". The returned function imports Exudyn when it is called.
    """

    def solve(scene: Scene, setting: float) -> Motion:
        from solar_env.studies.peers.exudyn_runs import run_exudyn

        return run_exudyn(scene, solver, setting)

    return solve


_RIGID, _LOOSE, _FLEXIBLE, _LOOSE_FLEXIBLE = MODELS

_STEPS = {
    _RIGID: (1e-2, 1e-3, 1e-4),
    _LOOSE: (1e-4, 5e-5, 2e-5),
    _FLEXIBLE: (1e-2, 5e-3, 2e-3, 1e-3, 1e-4),
    _LOOSE_FLEXIBLE: (1e-4, 5e-5, 2e-5),
}
METHODS: Mapping[str, Method] = {
    "runge-kutta": Method(
        "rtol",
        ours(lambda rtol: RungeKutta(rtol=rtol)),
        {
            _RIGID: (1e-4, 1e-6, 1e-8, 1e-10, 1e-11, 1e-12),
            _LOOSE: (1e-4, 1e-5, 5e-7, 1e-8, 1e-10, 1e-11, 1e-12),
            _FLEXIBLE: (1e-3, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9),
            _LOOSE_FLEXIBLE: (1e-3, 1e-5, 1e-6, 1e-8, 1e-9),
        },
    ),
    "rosenbrock": Method(
        "rtol",
        ours(lambda rtol: Rosenbrock(rtol=rtol)),
        {_FLEXIBLE: (1e-2, 1e-3, 1e-4, 1e-5, 1e-6), _LOOSE_FLEXIBLE: (1e-2, 1e-3, 1e-4, 1e-5)},
    ),
    "modal-radau": Method(
        "rtol",
        ours(lambda rtol: ModalRadau(rtol=rtol)),
        {
            _LOOSE: (3e-2, 1e-2, 1e-3, 1e-4),
            _FLEXIBLE: (1e-3, 3e-4, 1e-4, 1e-5, 1e-6),
            _LOOSE_FLEXIBLE: (3e-2, 1e-2, 1e-3, 1e-4, 1e-5),
        },
        panels="32 modes",
    ),
    "generalized-alpha": Method("step", ours(lambda step: GeneralizedAlpha(step=step)), _STEPS),
    "paper's scheme": Method("step", ours(lambda step: GeneralizedAlpha(step=step, rho_inf=1.0)), _STEPS),
    "Exudyn generalized-alpha": Method(
        "step",
        exudyn("generalized-alpha"),
        {
            _RIGID: (1e-2, 1e-3, 1e-4),
            _LOOSE: (1e-4, 5e-5, 2e-5),
            _FLEXIBLE: (5e-3, 1e-3, 1e-4),
            _LOOSE_FLEXIBLE: (5e-4, 1e-4),
        },
        peer=True,
    ),
    "Exudyn explicit": Method(
        "step",
        exudyn("explicit"),
        {_RIGID: (5e-2, 1e-2, 1e-3), _LOOSE: (5e-5, 2e-5, 1e-5)},
        peer=True,
    ),
}

# Method and two settings: the finest one gives the reference run, the second finest one shows the reference's error.
Reference = tuple[str, tuple[float, float]]
REFERENCES: Mapping[str, tuple[Reference, ...]] = {
    _RIGID: (("runge-kutta", (1e-12, 1e-11)),),
    _LOOSE: (("runge-kutta", (1e-12, 1e-11)),),
    # Modal panels are a different panel model, which needs its own reference.
    _FLEXIBLE: (("runge-kutta", (1e-9, 1e-8)), ("modal-radau", (1e-6, 1e-5))),
    _LOOSE_FLEXIBLE: (("runge-kutta", (1e-9, 1e-8)), ("modal-radau", (1e-5, 1e-4))),
}


def peer_is_missing() -> bool:
    """Return whether Exudyn is not installed, so that its methods must be left out."""
    return importlib.util.find_spec("exudyn") is None
