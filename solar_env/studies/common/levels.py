"""Levels of the model: rigid panels, beams of so many elements or so many modes, with ideal joints or clearance."""

from dataclasses import dataclass, replace

from solar_env.array import ArrayParameters, ModelLevel, default_integrator
from solar_env.array.deployment import simulate
from solar_env.mechanics.integrators.settings import RungeKutta
from solar_env.mechanics.running.trajectory import Trajectory
from solar_env.studies.common.motion import perturbed, perturbed_setting


@dataclass(frozen=True)
class Level:
    """A level of the model, simulated with its default integrator.

    Attributes:
        model: the level as a word, see `ModelLevel`.
        tighter: what the tolerance of the integrator is divided by.
    """

    model: str
    tighter: float = 1.0

    @property
    def size(self) -> str:
        """Panels and tolerance in words: "rigid", "6 elements", "32 modes, rtol / 4"."""
        return self.panels.size if self.tighter == 1.0 else f"{self.panels.size}, rtol / {self.tighter:g}"

    @property
    def panels(self) -> ModelLevel:
        """The word's parts."""
        return ModelLevel.of(self.model)

    @property
    def name(self) -> str:
        """The level in words."""
        return f"{self.panels.name}, {self.size}" if self.panels.flexible else self.panels.name

    def integrator(self, member: int = 0) -> RungeKutta:
        """The integrator of a member of an ensemble."""
        default = default_integrator(self.model)
        return replace(default, rtol=perturbed_setting(default.rtol, member) / self.tighter)

    def deploy(self, parameters: ArrayParameters, member: int, duration: float, output_step: float) -> Trajectory:
        """Simulate a member of an ensemble of deployments, see `perturbed`.

        Raises:
            SimulationError: if the run cannot go on.
        """
        return simulate(
            perturbed(parameters, member),
            model=self.model,
            duration=duration,
            integrator=self.integrator(member),
            output_step=output_step,
        )


FINEST = Level("flexible-clearance:48 modes", tighter=10.0)
"""Finer than all levels of the ladder; beams come down to it with 48 elements."""
