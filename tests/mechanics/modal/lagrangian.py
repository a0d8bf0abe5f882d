"""The model of modal panels as a Lagrangian system, in plain NumPy: for tests alone.

Kinetic energy is a constant quadratic form, and all forces are the gradient of one potential. It is taken with complex
steps, so that no force is written down here.
"""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from solar_env.mechanics.arrays.model import CLEARANCE
from solar_env.mechanics.modal.arrays import ModalModel
from solar_env.mechanics.modal.foreshortening import quadratic_forms

Complex = NDArray[np.complex128]


class Lagrangian:
    """A mechanism of rigid bodies and modal panels, without friction, damping and ideal joints."""

    def __init__(self, model: ModalModel) -> None:
        self.model = model
        panels = model.panels
        # Groups: bending modes that are even and odd about the middle, then axial ones; by turns, from the lowest on.
        self.groups = [slice(*pair) for pair in itertools.pairwise(panels.first)]
        size = sum(3 + panels.frequency.shape[1] * (body["panel"] >= 0) for body in model.bodies)
        bending, axial = panels.coupled[:2].sum(), panels.coupled[2:].sum()
        panelled = [body for body in model.bodies if body["panel"] >= 0]
        self.forms = [quadratic_forms(body["length"], body["mass"], bending, axial) for body in panelled]
        self.inverse_mass = np.ones(size)
        for body in model.bodies:
            first = body["offset"]
            self.inverse_mass[first : first + 2] = body["inverse_mass"]
            self.inverse_mass[first + 2] = body["inverse_inertia"]

    def amplitudes(self, q: Complex, body: np.void) -> tuple[list[Complex], tuple[Complex, Complex]]:
        """Amplitudes by group; foreshortening, projected on the lowest axial modes, and the rest of it at the ends."""
        first, coupled = body["offset"] + 3, self.model.panels.coupled
        groups = [q[first + group.start : first + group.stop] for group in self.groups]
        low = np.empty((coupled[0] + coupled[1], *q.shape[1:]), q.dtype)
        low[::2], low[1::2] = groups[0][: coupled[0]], groups[1][: coupled[1]]
        rows = self.model.panels.shapes[body["design"]].T
        rest = [
            rows[part][count:].T @ group[count:]
            for part, group, count in zip(self.groups[:2], groups[:2], coupled[:2], strict=True)
        ]
        low = np.concatenate([low, *rest])
        forms = self.forms[body["panel"]]
        return groups, tuple(0.5 * np.einsum("i...,kij,j...->k...", low, form, low) for form in forms)

    def attachment(self, q: Complex, number: int) -> tuple[Complex, Complex, Complex]:
        """Place (x, y) of an attachment and the angle of its body there."""
        model, attachment = self.model, self.model.attachments[number]
        body = model.bodies[attachment["body"]]
        first, d, sign = body["offset"], body["design"], 1.0 - 2.0 * attachment["end"]
        x, y, turn = attachment["x"] + 0.0 * q[0], attachment["y"] + 0.0 * q[0], 0.0 * q[0]
        if body["panel"] >= 0:
            groups, (_, ends) = self.amplitudes(q, body)
            values = [model.panels.shapes[d, :, part] @ group for part, group in zip(self.groups, groups, strict=True)]
            x = x + values[2][0] + sign * values[3][0] + ends[attachment["end"]]
            y = y + values[0][0] + sign * values[1][0]
            turn = sign * values[0][1] + values[1][1]
        c, s = np.cos(q[first + 2]), np.sin(q[first + 2])
        return q[first] + c * x - s * y, q[first + 1] + s * x + c * y, q[first + 2] + turn

    def potential(self, q: Complex) -> Complex:
        """Strain, weight, springs, loops and Hertzian contacts [J]; further axes of `q` are others."""
        model, panels, total = self.model, self.model.panels, 0.0 * q[0]
        for body in model.bodies:
            first, d = body["offset"], body["design"]
            if body["inverse_mass"] > 0.0:
                total = total - body["mass"] * (model.gravity @ q[first : first + 2])
            if body["panel"] >= 0:
                groups, (projections, _) = self.amplitudes(q, body)
                stretched = [group.copy() for group in groups]
                for k, projection in enumerate(projections):
                    stretched[2 + (k + 1) % 2][k // 2] -= projection
                for part, group in zip(self.groups, stretched, strict=True):
                    total = total + 0.5 * panels.frequency[d, part] ** 2 @ group**2
        for j, joint in enumerate(model.joints):
            x, y, outer_angle = self.attachment(q, joint["outboard"])
            inner_x, inner_y, inner_angle = self.attachment(q, joint["inboard"])
            angle = joint["sign"] * (outer_angle - inner_angle - model.folded_angle[j])
            total = total + 0.5 * joint["spring_stiffness"] * (joint["spring_preload_angle"] - angle) ** 2
            assert joint["kind"] == CLEARANCE
            depth = np.sqrt((x - inner_x) ** 2 + (y - inner_y) ** 2) - joint["clearance"]
            pressed = np.where(depth.real > 0.0, depth, 0.0)
            total = total + 0.4 * joint["contact"][0] * pressed * pressed * np.sqrt(pressed)
        for cable in model.cables:
            stretch, length = self.mismatch(q, cable)
            if cable["wheel_radius"] == 0.0:
                total = total + 0.5 * cable["stiffness"] * stretch**2
                continue
            radius, offset, rest = cable["wheel_radius"], cable["strand_offset"], cable["rest_distance"]
            stiffness, tension = 0.5 * cable["stiffness"] / radius**2, cable["preload_torque"] / radius
            straight = np.sqrt(length**2 - offset**2) + offset * np.arcsin(offset / length)
            longer = straight - np.sqrt(rest**2 - offset**2) - offset * np.arcsin(offset / rest)
            for strand in (longer + radius * stretch, longer - radius * stretch):
                taut = np.where(tension + stiffness * strand.real > 0.0, strand, -tension / stiffness)
                total = total + tension * taut + 0.5 * stiffness * taut**2
        return total

    def mismatch(self, q: Complex, cable: np.void) -> tuple[Complex, Complex]:
        """Of a loop's wheels, whose angles count from its chord, short of a quarter turn; and the chord's length."""
        model, (a, b) = self.model, (self.model.joints[cable["joint_a"]], self.model.joints[cable["joint_b"]])
        pulls = cable["wheel_radius"] > 0.0
        ends = (a["inboard"], b["outboard"]) if pulls else (a["outboard"], b["inboard"])
        (ax, ay, _), (bx, by, _) = (self.attachment(q, number) for number in ends)
        turn = q[model.bodies[model.attachments[a["outboard"]]["body"]]["offset"] + 2]
        x = np.cos(turn) * (bx - ax) + np.sin(turn) * (by - ay)
        y = np.cos(turn) * (by - ay) - np.sin(turn) * (bx - ax)
        chord = turn + np.arctan(y / x)
        (_, _, base), (_, _, last) = (self.attachment(q, number) for number in (a["inboard"], b["outboard"]))
        inner = a["sign"] * (chord - base - model.folded_angle[cable["joint_a"]])
        outer = b["sign"] * (last - chord - model.folded_angle[cable["joint_b"]])
        return cable["wheel_ratio"] * inner - outer, np.sqrt(x * x + y * y)

    def acceleration(self, q: NDArray[np.float64]) -> NDArray[np.float64]:
        """Accelerations of all coordinates."""
        moved = q[:, None] + 1e-30j * np.eye(q.size)
        return -self.inverse_mass * self.potential(moved).imag / 1e-30

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
