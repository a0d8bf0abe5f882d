"""Running a mechanism of rigid bodies and modal panels from Python: `ModalSimulation`."""

import numpy as np
from numpy.typing import NDArray

from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.integrators.recording import RECORDED_LOADS, Recorder, make_recorder
from solar_env.mechanics.mechanism.description import Mechanism
from solar_env.mechanics.modal.arrays import OTHER, ModalState, make_workspace
from solar_env.mechanics.modal.books import stored_energies
from solar_env.mechanics.modal.build import compile_modal
from solar_env.mechanics.modal.driver import advance_modal, start_loads
from solar_env.mechanics.modal.motion import look_at
from solar_env.mechanics.modal.sampling import fill_load_table
from solar_env.mechanics.modal.settings import ModalRadau
from solar_env.mechanics.modal.step import ModalSettings
from solar_env.mechanics.running.accuracy import STEPS_BETWEEN_LOOKS
from solar_env.mechanics.running.diagnosis import check_energy, check_modal_range
from solar_env.mechanics.running.errors import raise_for_status
from solar_env.mechanics.running.in_motion import InMotion

_SMALLEST_ENERGY_SCALE = 1e-9  # J, for a mechanism that starts without energy
# Depth errors of a step over rtol, relative to the depth.
_DEPTH_TOLERANCE = 0.1


class ModalSimulation(InMotion[ModalState]):
    """A mechanism of rigid bodies and modal panels in motion; it is used as a `Simulation` is."""

    def __init__(self, mechanism: Mechanism, integrator: ModalRadau | None = None) -> None:
        """Compile `mechanism` and check that its initial state meets the constraints.

        Raises:
            ValueError: if positions or velocities violate a constraint, or if the mechanism has parts that the method
                does not take.
        """
        self.integrator = integrator or ModalRadau()
        self.model, self.state = compile_modal(mechanism)
        self._work = make_workspace(self.model, self.state)
        self._check_initial_state()
        self._engage_stops()
        start_loads(self.model, self.state, self._work)
        energies = self.stored_energies()
        self.state.clock["initial_energy"] = energies.sum()
        self.state.clock["energy_scale"] = max(np.abs(energies).sum(), _SMALLEST_ENERGY_SCALE)
        self._told: set[str] = set()
        self._looked_at = 0
        self._unrecorded = self.make_recorder(np.zeros(0), 0)

    def _motion(self) -> NDArray[np.float64]:
        """(joints, columns) motion of the joints now, as `modal.arrays` names it."""
        look_at(self.model, self.state.q, self.state.v, self._work, OTHER)
        return self._work.motion[OTHER]

    def _check_initial_state(self) -> None:
        motion = self._motion()[self.model.joints["kind"] == m.IDEAL]
        for quantity, unit, first in (("position", "m", 0), ("velocity", "m/s", 2)):
            value = np.abs(motion[:, first : first + 2]).max(initial=0.0)
            if not value < 1e-9 * max(self.model.length_scale, 1.0):
                raise ValueError(
                    f"the initial {quantity} violates a constraint by {value:.3g} {unit}; place the bodies so that "
                    "joints are met"
                )

    def make_recorder(self, times: NDArray[np.float64], contact_capacity: int) -> Recorder:
        """Allocate a recorder for sample times [s] and a number of contacts between two drains."""
        return make_recorder(self.model, self.state, times, contact_capacity)  # type: ignore[arg-type]

    def snapshot(self) -> ModalState:
        """An independent copy of the state, which can be pickled."""
        return ModalState._make(array.copy() for array in self.state)

    def advance(self, end_time: float, recorder: Recorder | None = None) -> None:
        """Advance to `end_time` [s], landing on it.

        Raises:
            ValueError: if `end_time` is not finite or lies before the present time.
            SimulationError: if the run cannot go on; the state stays at the last accepted step.

        Warns:
            SimulationWarning: as `check`, which looks every 10,000 steps.
        """
        self._check_end_time(end_time)
        chosen = self.integrator
        settings = ModalSettings(
            float(chosen.rtol),
            float(chosen.velocity_scale),
            float(chosen.rtol * _DEPTH_TOLERANCE),
            float(chosen.max_step),
            float(chosen.impact_resolution),
            int(chosen.max_steps),
        )
        record = recorder or self._unrecorded
        status = int(advance_modal(self.model, self.state, settings, record, float(end_time), self._work))
        if status not in (m.DONE, m.PAUSED):
            clock = self.state.clock[0]
            raise_for_status(status, self.time, int(clock["failure_joint"]), float(clock["failure_value"]))
        if abs(self.state.clock["steps"][0] - self._looked_at) >= STEPS_BETWEEN_LOOKS:
            self.check()

    def modal_range(self) -> tuple[float, float]:
        """Greatest slope of a panel's end against its frame [rad], and greatest spin over the lowest frequency."""
        slope, spin_ratio, panels = 0.0, 0.0, self.model.panels
        even, odd, end = panels.first[:3]
        for body in self.model.bodies[self.model.bodies["panel"] >= 0]:
            first, d = body["offset"] + 3, body["design"]
            slopes = [
                panels.rows[d, i:k, 1] @ self.state.q[first + i : first + k] for i, k in ((even, odd), (odd, end))
            ]
            slope = max(slope, float(np.abs(slopes).sum()))
            lowest = panels.frequency[d, even:end].min()
            spin_ratio = max(spin_ratio, float(abs(self.state.v[body["offset"] + 2]) / lowest))
        return slope, spin_ratio

    def check(self) -> None:
        """Look at the accuracy of the run so far; every shortcoming is told once.

        Warns:
            SimulationWarning: if the energy book is open by more than 1 % of the energy turned over, or if panels bend
                or turn by more than the second order of the modal panels holds for.
        """
        self._looked_at = int(self.state.clock["steps"][0])
        remedy = f"tighten rtol = {self.integrator.rtol:g}"
        if "energy" not in self._told and check_energy(self.time, *self.energy_book(), remedy):
            self._told.add("energy")
        if "range" not in self._told and check_modal_range(self.time, *self.modal_range()):
            self._told.add("range")

    def joint_loads(self) -> NDArray[np.float64]:
        """(joints, columns) table of angles, rates, forces and torques now; columns are named in `joint.py`."""
        self._motion()
        table = np.zeros_like(self._work.sample)
        fill_load_table(self.model, self.state, self._work, OTHER, self.state.loads, table)
        return table[:, :RECORDED_LOADS]

    def stored_energies(self) -> NDArray[np.float64]:
        """(ENERGIES,) stored energies now [J], in the order of `model.ENERGY_NAMES`."""
        self._motion()
        energies = np.zeros(m.ENERGIES)
        stored_energies(self.model, self.state, self.state.q, self.state.v, self._work, OTHER, energies)
        return energies

    def energy_book(self) -> tuple[float, float]:
        """Energy now that the books do not account for, and the energy that the run turned over so far [J]."""
        integrals = self.state.integrals
        by_joint = m.joint_integrals(integrals).sum(axis=0)
        put_in = by_joint[m.MOTOR_WORK] + by_joint[m.CABLE_WORK]
        lost = by_joint[[m.NORMAL_DISSIPATION, m.FRICTION_DISSIPATION, m.STOP_DISSIPATION]].sum()
        lost += integrals[m.MATERIAL_DISSIPATION]
        stored = self.stored_energies()
        clock = self.state.clock[0]
        turned_over = float(np.abs(stored[: m.GRAVITY]).sum() + abs(lost))
        return float(stored.sum() - clock["initial_energy"] - put_in + lost), max(
            float(clock["energy_scale"]), turned_over
        )

    def momenta(self) -> NDArray[np.float64]:
        """Linear momentum [N s] and angular momentum about the origin [N m s] of the bodies that move."""
        bodies = self.model.bodies[self.model.bodies["inverse_mass"] > 0.0]
        first = bodies["offset"]
        x, y = self.state.q[first], self.state.q[first + 1]
        u, v, spin = self.state.v[first], self.state.v[first + 1], self.state.v[first + 2]
        mass = bodies["mass"]
        angular = mass * (x * v - y * u) + bodies["inertia"] * spin
        return np.array([(mass * u).sum(), (mass * v).sum(), angular.sum()])
