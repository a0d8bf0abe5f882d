"""The model of modal panels as a Lagrangian system, in plain NumPy: for tests alone.

Kinetic energy is a constant quadratic form, and all forces are the gradient of one potential. It is taken with complex
steps, so that no force is written down here.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from solar_env.mechanics.arrays.model import CLEARANCE
from solar_env.mechanics.modal.arrays import ModalModel

Complex = NDArray[np.complex128]


class Lagrangian:
    """A mechanism of rigid bodies and modal panels, without friction, damping and ideal joints."""

    def __init__(self, model: ModalModel) -> None:
        self.model = model
        panels = model.panels
        self.axial, self.bending = panels.axial_frequency.shape[1], panels.bending_frequency.shape[1]
        size = sum(3 + (self.axial + self.bending) * (body["panel"] >= 0) for body in model.bodies)
        self.inverse_mass = np.ones(size)
        for body in model.bodies:
            first = body["offset"]
            self.inverse_mass[first : first + 2] = body["inverse_mass"]
            self.inverse_mass[first + 2] = body["inverse_inertia"]

    def attachment(self, q: Complex, number: int) -> tuple[Complex, complex]:
        """Place of an attachment and the angle of its body there."""
        model, attachment = self.model, self.model.attachments[number]
        body = model.bodies[attachment["body"]]
        first, d, end = body["offset"], body["design"], attachment["end"]
        local, turn = np.array([attachment["x"], attachment["y"]], complex), 0.0 + 0.0j
        if body["panel"] >= 0:
            a = q[first + 3 : first + 3 + self.axial]
            b = q[first + 3 + self.axial : first + 3 + self.axial + self.bending]
            low = b[: model.panels.ends.shape[2]]
            local[0] += model.panels.axial_rows[d, end] @ a + 0.5 * low @ model.panels.ends[d, end] @ low
            local[1] += model.panels.bending_rows[d, 2 * end] @ b
            turn = model.panels.bending_rows[d, 2 * end + 1] @ b
        c, s = np.cos(q[first + 2]), np.sin(q[first + 2])
        place = q[first : first + 2] + np.array([c * local[0] - s * local[1], s * local[0] + c * local[1]])
        return place, q[first + 2] + turn

    def potential(self, q: Complex) -> complex:
        """Strain, weight, springs and Hertzian contacts [J]."""
        model, panels, total = self.model, self.model.panels, 0.0 + 0.0j
        for body in model.bodies:
            first, d = body["offset"], body["design"]
            if body["inverse_mass"] > 0.0:
                total -= body["mass"] * (model.gravity @ q[first : first + 2])
            if body["panel"] >= 0:
                a = q[first + 3 : first + 3 + self.axial].copy()
                b = q[first + 3 + self.axial : first + 3 + self.axial + self.bending]
                low = b[: panels.project.shape[2]]
                for k in range(panels.project.shape[1]):
                    a[k] -= 0.5 * low @ panels.project[d, k] @ low
                total += 0.5 * np.sum((panels.axial_frequency[d] * a) ** 2)
                total += 0.5 * np.sum((panels.bending_frequency[d] * b) ** 2)
        for j, joint in enumerate(model.joints):
            outer, outer_angle = self.attachment(q, joint["outboard"])
            inner, inner_angle = self.attachment(q, joint["inboard"])
            angle = joint["sign"] * (outer_angle - inner_angle - model.folded_angle[j])
            total += 0.5 * joint["spring_stiffness"] * (joint["spring_preload_angle"] - angle) ** 2
            assert joint["kind"] == CLEARANCE
            gap = outer - inner
            depth = np.sqrt(gap[0] ** 2 + gap[1] ** 2) - joint["clearance"]
            if depth.real > 0.0:
                total += 0.4 * joint["contact_stiffness"] * depth**2.5
        return total

    def acceleration(self, q: NDArray[np.float64]) -> NDArray[np.float64]:
        """Accelerations of all coordinates."""
        force = np.zeros(q.size)
        for i in range(q.size):
            moved = q.astype(complex)
            moved[i] += 1e-30j
            force[i] = -self.potential(moved).imag / 1e-30
        return self.inverse_mass * force

    def run(
        self, q: NDArray[np.float64], v: NDArray[np.float64], duration: float, rtol: float = 1e-10
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Coordinates and velocities after a time [s]."""
        n = q.size
        found = solve_ivp(
            lambda _, y: np.concatenate([y[n:], self.acceleration(y[:n])]),
            (0.0, duration),
            np.concatenate([q, v]),
            method="DOP853",
            rtol=rtol,
            atol=1e-12,
        )
        return found.y[:n, -1], found.y[n:, -1]

    def energy(self, q: NDArray[np.float64], v: NDArray[np.float64]) -> float:
        """Kinetic energy and potential [J]."""
        moving = self.inverse_mass > 0.0
        kinetic = 0.5 * np.sum(v[moving] ** 2 / self.inverse_mass[moving])
        return float(kinetic + self.potential(q.astype(complex)).real)
