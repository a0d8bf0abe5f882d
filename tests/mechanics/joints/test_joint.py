"""Joint forces: power balance, conservation of momentum, springs, stops, cable loops and contact geometry."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from helpers import Forces, central_difference
from mechanisms import ROUND_BEARING, ROUND_STOP, Vector, block, chain

from solar_env.mechanics.arrays import columns
from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.joints.contact import contact_motion
from solar_env.mechanics.joints.joint import penetration
from solar_env.mechanics.joints.laws import SLIDING_READINGS
from solar_env.mechanics.joints.torques.hinge import summed_torque
from solar_env.mechanics.joints.torques.stop import one_sided_stop, stop_energy, stop_torque
from solar_env.mechanics.mechanism.description import CableLoop

# Angle of either joint relative to the latch at 0.9 and the stow stop at 0, both with 0.05 of free play.
SITUATIONS = {
    "free": (0.4, 0.5),
    "in the latch": (1.1, 0.7),
    "deep in the latch": (1.5, 0.2),
    "in the stow stop": (-0.2, -0.6),
}
# Penetration of either joint; the clearance is 0.1.
DEPTHS = {"flying": (-0.03, -0.05), "touching": (0.02, 0.06)}


def random_state(
    seed: int,
    situation: str = "free",
    depths: str = "touching",
    *,
    sliding: str = "material",
    cables: tuple[CableLoop, ...] = (),
    impact_speed: float = 0.5,
) -> Forces:
    """A chain of three bodies in a random motion."""
    rng = np.random.default_rng(seed)
    directions = rng.uniform(-math.pi, math.pi, 2)
    radii = ROUND_BEARING.clearance + np.array(DEPTHS[depths])
    mechanism = chain(
        rng,
        angles=np.array(SITUATIONS[situation]),
        eccentricities=radii[:, None] * np.stack([np.cos(directions), np.sin(directions)], axis=1),
        bearing=replace(ROUND_BEARING, sliding=sliding),
        cables=cables,
    )
    forces = Forces(mechanism, impact_speed)
    states = forces.state.joints
    states["latched"] = "latch" in situation
    states["stop_engaged"] = 1
    states["motor_torque"] = rng.normal(size=2)
    return forces


LOOPS = {
    "no cable": (),
    "taut cable": (CableLoop("joint 0", "joint 1", 1.7, 2.0, 2.0),),
    "couple": (CableLoop("joint 0", "joint 1", 1.7, 2.0, 1.0),),
    "slack cable": (CableLoop("joint 0", "joint 1", 1.7, 2.0, 2.0, preload_torque=0.05),),
    "slack couple": (CableLoop("joint 0", "joint 1", 1.7, 2.0, 1.0, preload_torque=0.05),),
}


@pytest.mark.parametrize(
    ("situation", "depths", "loop"),
    list(product(SITUATIONS, DEPTHS, ["taut cable"])) + [("free", "touching", loop) for loop in LOOPS],
)
@pytest.mark.parametrize("sliding", SLIDING_READINGS)
def test_the_power_of_the_forces_is_work_put_in_less_losses_less_growth_of_stored_energy(
    situation: str, depths: str, loop: str, sliding: str
) -> None:
    for seed in range(3):
        forces = random_state(seed, situation, depths, sliding=sliding, cables=LOOPS[loop])
        q, v = forces.state.q, forces.state.v

        def stored(time: Vector, forces: Forces = forces, q: Vector = q, v: Vector = v) -> Vector:
            energies = dict(zip(m.ENERGY_NAMES, forces.stored(q + time[0] * v, v), strict=True))
            return np.array([sum(energies[law.energy] for law in columns.TORQUES if law.energy) + energies["contact"]])

        growth = central_difference(stored, np.zeros(1))[0, 0]
        force = forces.force(q, v)
        total = columns.total_torque(forces.work.loads)
        assert [summed_torque(forces.work.loads, j) for j in range(2)] == pytest.approx(total, rel=1e-14, abs=1e-14)
        powers = forces.integral_powers().sum(axis=0)
        put_in = sum(powers[law.integral] for law in columns.TORQUES if law.book and not law.lost)
        lost = powers[[m.NORMAL_DISSIPATION, m.FRICTION_DISSIPATION]].sum()
        lost += sum(powers[law.integral] for law in columns.TORQUES if law.lost)
        scale = float(np.abs(force) @ np.abs(v))
        # A stop or a cable limit within the difference's reach would show as a kink; 1e-8 leaves none unnoticed.
        assert force @ v == pytest.approx(put_in - lost - growth, abs=1e-8 * scale)


@pytest.mark.parametrize(("situation", "depths"), list(product(SITUATIONS, DEPTHS)))
@pytest.mark.parametrize("loop", LOOPS)
def test_joint_forces_change_neither_linear_nor_angular_momentum(situation: str, depths: str, loop: str) -> None:
    for seed in range(3):
        forces = random_state(seed, situation, depths, cables=LOOPS[loop])
        q = forces.state.q
        force = forces.force(q, forces.state.v)
        # Power in a motion of the whole mechanism: two translations and a turn about the origin.
        turn = np.stack([-q[1::2], q[0::2]], axis=1).ravel()
        for field in (np.tile([1.0, 0.0], q.size // 2), np.tile([0.0, 1.0], q.size // 2), turn):
            scale = float(np.abs(force) @ np.abs(field))
            assert force @ field == pytest.approx(0.0, abs=1e-14 * scale + 1e-15)


def test_joint_forces_do_no_work_on_the_stretch_of_a_body_by_torques() -> None:
    forces = random_state(3, "in the latch", "flying", cables=LOOPS["couple"])
    q = forces.state.q
    force = forces.force(q, forces.state.v)
    for k in range(0, q.size, 4):
        d = q[k + 2 : k + 4] - q[k : k + 2]
        assert d @ (force[k + 2 : k + 4] - force[k : k + 2]) == pytest.approx(0.0, abs=1e-13 * np.abs(force).max())


@pytest.mark.parametrize("seed", range(3))
def test_the_joint_angle_and_its_rate_are_those_of_the_description(seed: int) -> None:
    rng = np.random.default_rng(seed)
    # The range of the angle reaches pi to either side of its middle, 0.4.
    angles = 0.4 + rng.uniform(-math.pi, math.pi, 3) * 0.999
    mechanism = chain(rng, angles=angles, eccentricities=np.zeros((3, 2)), stop=None)
    forces = Forces(mechanism)
    forces.force(forces.state.q, forces.state.v)
    spins = np.array([body.spin for body in mechanism.bodies])
    signs = np.array([joint.sign for joint in mechanism.joints])
    assert forces.work.loads[:, columns.ANGLE] == pytest.approx(angles, abs=1e-13)
    assert forces.work.loads[:, columns.RATE] == pytest.approx(signs * np.diff(spins), abs=1e-13)
    assert forces.work.loads[:, columns.OUTBOARD_SPIN] == pytest.approx(spins[1:], abs=1e-13)
    assert forces.work.loads[:, columns.INBOARD_SPIN] == pytest.approx(spins[:-1], abs=1e-13)


def test_penetration_is_eccentricity_less_clearance_and_its_rate_the_approach() -> None:
    forces = Forces(block(velocity=(0.3, 0.4), position=(6e-4, 8e-4)))
    joint, markers = forces.model.joints[0], forces.model.markers
    depth, rate = penetration(joint, markers, forces.state.q, forces.state.v)
    assert depth == pytest.approx(0.0, abs=1e-18)
    assert rate == pytest.approx(0.5, rel=1e-14)


def test_a_centred_journal_approaches_the_wall_whichever_way_it_goes() -> None:
    forces = Forces(block(velocity=(-0.3, 0.4)))
    assert penetration(forces.model.joints[0], forces.model.markers, forces.state.q, forces.state.v) == (-1e-3, 0.5)


def contact_of_block(velocity: tuple[float, float], *, sliding: str = "material", spin: float = 0.0) -> Vector:
    """Loads of a block whose journal, centred in the block, is pressed 0.1 deep into the bearing's wall at +x."""
    bearing = replace(ROUND_BEARING, sliding=sliding)
    forces = Forces(block(velocity=velocity, position=(0.2, 0.0), bearing=bearing, spin=spin), impact_speed=1.0)
    forces.force(forces.state.q, forces.state.v)
    return forces.work.loads[0]


def test_the_wall_pushes_back_and_friction_opposes_the_sliding() -> None:
    loads = contact_of_block((0.1, 5.0))
    normal = 50.0 * 0.1**1.5 * (1.0 + 0.7 * 0.1)
    assert loads[columns.NORMAL] == pytest.approx(normal, rel=1e-12)
    assert loads[columns.TANGENTIAL] == pytest.approx(-0.4 * normal, rel=1e-12)
    assert loads[columns.FORCE_X : columns.FORCE_Y + 1] == pytest.approx([-normal, -0.4 * normal], rel=1e-12)


@pytest.mark.parametrize(
    ("sliding", "velocity", "spin", "share"),
    [
        # Rim speed 0.3 m * 20 rad/s: above the full speed of 3 m/s, where a journal spins in place.
        ("material", (0.0, 0.0), 20.0, 1.0),
        ("centres", (0.0, 0.0), 20.0, 0.0),
        # On the ramp from 0.2 to 3 m/s; the journal's spin counts for nothing.
        ("centres", (0.0, 1.6), 20.0, 0.5),
        # By the share of the depth in the distance of the centres, 0.1 of 0.2 m: half of 5 m/s.
        ("places", (0.1, 5.0), 20.0, (0.5 * 5.0 - 0.2) / (3.0 - 0.2)),
        # A journal that rolls: rim speed of minus that of the centre at the contact.
        ("material", (0.0, 4.0), -4.0 / 0.3, 0.0),
        ("centres", (0.0, 4.0), -4.0 / 0.3, 1.0),
    ],
)
def test_friction_follows_the_sliding_speed_of_its_reading(
    sliding: str, velocity: tuple[float, float], spin: float, share: float
) -> None:
    loads = contact_of_block(velocity, sliding=sliding, spin=spin)
    normal = 50.0 * 0.1**1.5 * (1.0 + 0.7 * velocity[0])
    assert loads[columns.TANGENTIAL] == pytest.approx(-0.4 * share * normal, rel=1e-12)


@pytest.mark.parametrize("distance", [0.05, 0.1], ids=["in flight", "on the very wall"])
@pytest.mark.parametrize(("sliding", "speed"), [("material", 5.0 + 0.3 * 20.0), ("centres", 5.0), ("places", 5.0)])
def test_without_depth_the_places_of_contact_slide_as_the_centres_do(
    distance: float, sliding: str, speed: float
) -> None:
    joint = Forces(block(bearing=replace(ROUND_BEARING, sliding=sliding))).model.joints[0]
    motion = contact_motion(joint, distance, 0.0, 0.3, 5.0, 20.0, 0.0)
    assert motion.depth == pytest.approx(distance - 0.1, abs=1e-15)
    assert (motion.rate, motion.centre_speed, motion.sliding_speed) == pytest.approx((0.3, 5.0, speed), rel=1e-14)


def test_a_centred_journal_has_no_line_of_centres_and_slides_by_its_spin_alone() -> None:
    motion = contact_motion(Forces(block(bearing=ROUND_BEARING)).model.joints[0], 0.0, 0.0, 0.3, 0.4, 20.0, 10.0)
    assert motion[:6] == (-0.1, 0.0, 0.0, 0.0, 0.3, 0.0)
    assert motion.slip == motion.sliding_speed == pytest.approx(0.3 * 10.0, rel=1e-14)


def test_a_journal_in_flight_feels_no_force_even_where_its_path_crosses_the_wall() -> None:
    forces = Forces(block(position=(0.2, 0.0), bearing=ROUND_BEARING), impact_speed=0.0)
    assert not forces.force(forces.state.q, forces.state.v).any()
    assert not forces.integral_powers().any()


def test_sliding_work_and_impulse_grow_with_the_normal_force() -> None:
    forces = Forces(block(velocity=(0.1, 5.0), position=(0.2, 0.0), bearing=ROUND_BEARING), impact_speed=1.0)
    forces.force(forces.state.q, forces.state.v)
    normal = forces.work.loads[0, columns.NORMAL]
    powers = forces.integral_powers()[0]
    assert powers[m.IMPULSE] == normal
    assert powers[m.SLIDING_WORK] == pytest.approx(5.0 * normal, rel=1e-14)


@pytest.mark.parametrize("torque_ratio", [2.0, 1.0])
def test_a_cable_loop_torques_both_its_joints_in_its_torque_ratio(torque_ratio: float) -> None:
    forces = random_state(0, cables=(CableLoop("joint 0", "joint 1", 1.7, 2.0, torque_ratio),))
    forces.force(forces.state.q, forces.state.v)
    first, second = forces.work.loads[:, columns.CABLE_TORQUE]
    a, b = SITUATIONS["free"]
    assert second == pytest.approx(1.7 * (2.0 * a - b), rel=1e-12)
    assert first == pytest.approx(-torque_ratio * second, rel=1e-12)
    cable_power = forces.integral_powers()[:, m.CABLE_WORK]
    expected = second * (2.0 - torque_ratio) * forces.work.loads[0, columns.RATE]
    assert cable_power == pytest.approx([expected, 0.0], rel=1e-12)


def stop_of(situation: str, angle: float, rate: float, *, latched: bool, engaged: bool = True) -> tuple[float, ...]:
    """Stop torque of the first joint, with its elastic part and slopes."""
    forces = random_state(0, situation)
    own = forces.state.joints[0]
    own.latched, own.stop_engaged = int(latched), int(engaged)
    return stop_torque(forces.model.joints[0], own, angle, rate)


@pytest.mark.parametrize(
    ("angle", "rate", "latched", "engaged", "torque"),
    [
        # Held from both sides of the lock angle, at 0.9 with a play of 0.05.
        (0.9 + 0.05 + 0.2, 0.0, True, True, -3.0 * 0.2**1.5),
        (0.9 - 0.05 - 0.2, 0.0, True, True, 3.0 * 0.2**1.5),
        *((angle, 5.0, True, True, 0.0) for angle in (0.86, 0.9, 0.94)),
        # One that has not latched swings through; a stop that is not engaged exerts none.
        (1.5, 3.0, False, True, 0.0),
        (1.5, 3.0, True, False, 0.0),
        # Of two stops that a joint is past, the deeper one acts: the latch holds a joint that is folded back.
        (-0.05 - 0.2, 0.0, False, True, 3.0 * 0.2**1.5),
        (-0.05 - 0.2, 0.0, True, True, 3.0 * 1.1**1.5),
    ],
)
def test_a_stop_holds_a_joint_that_is_latched_or_stowed(
    angle: float, rate: float, latched: bool, engaged: bool, torque: float
) -> None:
    found = stop_of("free", angle, rate, latched=latched, engaged=engaged)
    assert found[0] == pytest.approx(torque)
    assert torque != 0.0 or found == (0.0, 0.0, 0.0, 0.0)


def stop_row() -> np.record:
    row = np.zeros(1, dtype=m.joint_type)
    for name in ("gap", "stiffness", "exponent", "ramp_depth", "damping"):
        row[f"stop_{name}"] = getattr(ROUND_STOP, name)
    return row[0]


def test_a_stop_sets_in_smoothly_and_never_pulls() -> None:
    row = stop_row()
    assert one_sided_stop(row, 0.0, 5.0) == (0.0, 0.0, 0.0, 0.0)
    assert one_sided_stop(row, 1e-9, 5.0)[0] == pytest.approx(0.0, abs=1e-12)
    assert one_sided_stop(row, 0.1, -100.0) == (0.0, pytest.approx(3.0 * 0.1**1.5), 0.0, 0.0)


def test_the_damping_of_a_stop_is_full_beyond_its_ramp() -> None:
    row = stop_row()
    for depth in (0.3, 0.31, 2.0):
        torque, elastic, _, damping = one_sided_stop(row, depth, 0.4)
        assert damping == 2.0
        assert torque - elastic == pytest.approx(0.8, rel=1e-13)
    # A cubic ramp: half the damping at half its depth.
    assert one_sided_stop(row, 0.15, 0.4)[3] == pytest.approx(1.0, rel=1e-13)


def test_a_stop_that_opens_a_little_too_fast_lets_go_at_once() -> None:
    # Full damping of 2 N m s/rad: a rate of -k depth^e / 2 balances the spring.
    row, depth = stop_row(), 0.4
    balanced = -3.0 * depth**1.5 / 2.0
    assert one_sided_stop(row, depth, balanced - 0.1)[::2] == (0.0, 0.0)
    assert one_sided_stop(row, depth, balanced + 0.1)[0] == pytest.approx(0.2, rel=1e-12)


@pytest.mark.parametrize("depth", [0.05, 0.15, 0.29, 0.4])
@pytest.mark.parametrize("rate", [-0.05, 0.0, 0.7])
def test_the_slopes_of_a_stop_are_those_of_its_torque(depth: float, rate: float) -> None:
    def torque(x: Vector) -> Vector:
        return np.array([one_sided_stop(stop_row(), x[0], x[1])[0]])

    slopes = central_difference(torque, np.array([depth, rate]))[0]
    assert one_sided_stop(stop_row(), depth, rate)[2:] == pytest.approx(slopes, rel=1e-8)


def test_a_stop_stores_energy_where_it_pushes_and_nowhere_else() -> None:
    forces = random_state(0, "free")
    joint, own = forces.model.joints[0], forces.state.joints[0]
    own.latched, own.stop_engaged = 1, 1
    # k depth^(e + 1) / (e + 1) beyond the play of 0.05.
    assert stop_energy(joint, own, 0.9 + 0.05 + 0.2) == pytest.approx(3.0 * 0.2**2.5 / 2.5, rel=1e-12)
    assert stop_energy(joint, own, 0.9) == 0.0
    own.stop_engaged = 0
    assert stop_energy(joint, own, 1.5) == 0.0


def test_a_joint_without_a_stow_stop_folds_as_far_as_it_likes() -> None:
    mechanism = chain(
        np.random.default_rng(0), angles=np.array([-0.6]), eccentricities=np.zeros((1, 2)), spring=None, stow_angle=None
    )
    forces = Forces(mechanism)
    forces.state.joints["stop_engaged"] = 1
    assert not forces.force(forces.state.q, forces.state.v).any()
    forces.state.joints["latched"] = 1
    forces.force(forces.state.q, np.zeros_like(forces.state.v))
    assert forces.work.loads[0, columns.LATCH_TORQUE] == pytest.approx(3.0 * (1.5 - 0.05) ** 1.5, rel=1e-12)
