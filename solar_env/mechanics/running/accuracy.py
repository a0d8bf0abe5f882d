"""Looks after the accuracy of a run, and warns (`diagnosis.py`) where it is less than it seems."""

from collections.abc import Callable
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.equations.formulation import Formulation
from solar_env.mechanics.integrators.settings import Integrator
from solar_env.mechanics.joints.contact.normal_force import impact_scales
from solar_env.mechanics.running.diagnosis import (
    constraint_force_text,
    energy_text,
    impact_step_text,
    modal_range_text,
    tolerance_text,
    warn,
)

# Between looks at a run that goes on call by call: a look takes as long as some hundred steps.
STEPS_BETWEEN_LOOKS = 10_000
# After a change of integrator or step, while multipliers settle, constraint forces are looked at in every call.
_SETTLING_CALLS = 30


class Watched(Protocol):
    """Part of a simulation that the watch looks at."""

    integrator: Integrator
    model: Any
    state: Any

    @property
    def formulation(self) -> Formulation:
        """Formulation of the equations of motion."""

    @property
    def time(self) -> float:
        """Time [s]."""

    def energy_book(self) -> tuple[float, float]:
        """Energy that the books do not account for, and the energy turned over [J]."""

    def constraint_force_defect(self) -> tuple[float, float]:
        """Greatest error of a multiplier, and the greatest force [N]."""


class AccuracyWatch:
    """Looks at a simulation now and then, and tells every shortcoming once."""

    def __init__(self, simulation: Watched) -> None:
        self._simulation = simulation
        self._told: set[str] = set()
        self._steps = 0
        self._integrator: Integrator | None = None
        self._settling = 0

    def after_call(self) -> None:
        """Look after a call to advance: for a few microseconds, and now and then more closely."""
        simulation = self._simulation
        self.check_impacts()
        if simulation.integrator.settles_forces:
            if simulation.integrator is not self._integrator:
                self._integrator, self._settling = simulation.integrator, _SETTLING_CALLS
            if self._settling > 0:
                self._settling -= 1
                self._check_forces()
        if abs(simulation.state.clock["steps"][0] - self._steps) >= STEPS_BETWEEN_LOOKS:
            self.check()

    def check(self) -> None:
        """Look at everything; see `Simulation.check`."""
        simulation = self._simulation
        self._steps = int(simulation.state.clock["steps"][0])
        chosen = simulation.integrator
        self.check_impacts()
        self._tolerance_text()
        if chosen.settles_forces:
            self._check_forces()
        self._tell("energy", lambda: energy_text(simulation.time, *simulation.energy_book(), chosen.remedy))
        self.check_range()

    def check_range(self) -> None:
        """Look at whether modal panels have left the range that their second order holds for."""
        run = self._simulation
        self._tell("range", lambda: modal_range_text(run.time, *run.formulation.modal_range(run.model, run.state)))

    def check_impacts(self, contacts: NDArray[np.void] | None = None) -> None:
        """Look at whether a fixed step resolves the impacts: the latest of every joint, or those of a contact table."""
        simulation = self._simulation
        needed = simulation.integrator.steps_needed_per_impact
        if needed is None:
            return
        durations = simulation.state.joints["contact_duration"]
        struck = durations > 0.0
        if not struck.any():
            return
        if contacts is not None:
            durations = durations * _shortest_over_latest(simulation.model.joints, contacts)
        shortest = float(durations[struck].min())
        steps = shortest / float(simulation.state.clock["last_step"][0])
        self._tell("impacts", lambda: impact_step_text(steps, needed, shortest))

    def _tolerance_text(self) -> None:
        simulation = self._simulation
        rtol, loosest = simulation.integrator.rtol, simulation.integrator.loosest_in_contact
        if rtol is not None and simulation.state.joints["contact_starts"].any():
            self._tell("tolerance", lambda: tolerance_text(rtol, loosest))

    def _check_forces(self) -> None:
        run = self._simulation
        if run.state.clock["steps"][0] > 0:
            self._tell("forces", lambda: constraint_force_text(run.time, *run.constraint_force_defect()))

    def _tell(self, what: str, look: Callable[[], str]) -> None:
        """Warn of a shortcoming, once."""
        text = "" if what in self._told else look()
        if text:
            self._told.add(what)
            warn(text)


def _shortest_over_latest(joints: NDArray[np.void], contacts: NDArray[np.void]) -> NDArray[np.float64]:
    """(joints,) predicted duration of the hardest contact, which is the shortest, over that of the latest one."""
    ratios = np.ones(joints.size)
    for j in np.unique(contacts["joint"]):
        speeds = contacts["impact_speed"][contacts["joint"] == j]
        # At the same mass: the ratio does not depend on it.
        shortest, latest = (impact_scales(joints[j], 1.0, speed)[1] for speed in (speeds.max(), speeds[-1]))
        ratios[j] = shortest / latest
    return ratios


def limits_of_the_laws(
    joints: NDArray[np.void],
    contacts: NDArray[np.void],
    penetration: NDArray[np.float64],
    normal: NDArray[np.float64],
    tangential: NDArray[np.float64],
) -> dict[str, Any]:
    """How often contact and friction left the range in which their laws mean something, for a trajectory's metadata.

    Args:
        joints: (nj,) of the model.
        contacts: table of contacts.
        penetration: (nt, nj) [m].
        normal, tangential: (nt, nj) contact forces [N].
    """
    slow = contacts["impact_speed"] <= joints["minimum_impact_speed"][contacts["joint"]]
    loose = joints["kind"] == m.CLEARANCE
    pressed = normal[:, loose] > 0.0
    coulomb = joints["friction_coefficient"][loose] * normal[:, loose]
    creeping = pressed & (np.abs(tangential[:, loose]) < 0.999 * coulomb)
    cut_off = (penetration[:, loose] > 0.0) & ~pressed
    return {
        "slow_contacts": int(slow.sum()),
        "creeping_share": float(creeping.sum() / max(pressed.sum(), 1)),
        "cut_off_share": float(cut_off.sum() / max(cut_off.sum() + pressed.sum(), 1)),
    }
