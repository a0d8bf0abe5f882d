"""The laws of the torques about a hinge keep what their table says: names, slopes, energies, powers, sums."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest
from helpers import central_difference
from mechanisms import ROUND_SPRING, ROUND_STOP, Vector, chain

from solar_env.array.data_files import write_data
from solar_env.mechanics.arrays import columns
from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.equations.build import compile_mechanism
from solar_env.mechanics.joints.torques.hinge import (
    add_torque_energies,
    hinge_torques,
    may_be_stiff,
    torque_of_motion,
)
from solar_env.mechanics.mechanism.textbook import pendulum
from solar_env.mechanics.running.simulation import simulate
from solar_env.mechanics.running.trajectory import Trajectory

RATE = 0.3


def latched_joint() -> tuple[Any, Any]:
    """A joint with all laws at work beside its lock angle."""
    mechanism = chain(
        np.random.default_rng(0),
        angles=np.array([1.1]),
        eccentricities=np.zeros((1, 2)),
        spring=ROUND_SPRING,
        stop=ROUND_STOP,
    )
    resisted = replace(
        mechanism.joints[0],
        spring_table=((0.0, 0.3), (0.7, -0.1), (1.3, 0.2), (2.0, 0.25)),
        harness=((0.0, -0.02), (2.0, 0.05)),
        damping=0.2,
        friction_torque=0.1,
        friction_ramp_rate=0.4,
    )
    model, state = compile_mechanism(replace(mechanism, joints=(resisted, *mechanism.joints[1:])))
    own = state.joints[0]
    own.latched, own.stop_engaged, own.motor_torque = 1, 1, 0.4
    return model.joints[0], own


def stored(joint: Any, own: Any, angle: float) -> float:
    energies = np.zeros(m.ENERGIES)
    add_torque_energies(joint, own, angle, energies)
    return float(energies.sum())


def test_every_law_has_a_column_and_its_energies_are_in_the_books() -> None:
    assert [law.column for law in columns.TORQUES] == list(range(columns.FIRST_TORQUE, columns.END_OF_TORQUES))
    assert {law.energy for law in columns.TORQUES if law.energy} < set(m.ENERGY_NAMES)
    assert {law.name for law in columns.TORQUES} < {item.name for item in fields(Trajectory)}
    booked = [law.integral for law in columns.TORQUES if law.book]
    assert len(set(booked)) == len(booked) == 5


def test_slopes_and_energies_are_those_of_the_sum() -> None:
    joint, own = latched_joint()

    def total(x: Vector) -> Vector:
        return np.array([torque_of_motion(hinge_torques(joint, own, x[0], x[1]))])

    at = np.array([1.1, RATE])
    torques = hinge_torques(joint, own, *at)
    assert central_difference(total, at)[0] == pytest.approx([torques.by_angle, torques.by_rate], rel=1e-8)
    growth = central_difference(lambda x: np.array([stored(joint, own, x[0])]), np.array([1.1]))[0, 0]
    assert -growth == pytest.approx(torques.spring + torques.harness + torques.latch_elastic, rel=1e-8)
    assert may_be_stiff(joint, own)


def test_a_trajectory_and_its_file_have_every_torque(tmp_path: Any) -> None:
    motion = simulate(pendulum(), 0.02, output_step=0.01)
    torques = [getattr(motion, law.name) for law in columns.TORQUES]
    assert motion.joint_torque == pytest.approx(np.sum(torques, axis=0), abs=0.0)
    assert {law.book for law in columns.TORQUES if law.book} < set(motion.energies)
    write_data(motion, tmp_path / "motion.csv")
    heads = (tmp_path / "motion.csv").read_text(encoding="utf-8").splitlines()[0].split(",")
    assert {f"{law.name}_Nm_1" for law in columns.TORQUES} < set(heads)
