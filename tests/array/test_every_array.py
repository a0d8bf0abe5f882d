"""Properties of every array that may be asked for: its energy book closes, or the library says that it does not.

The suite tries a few arrays, the same ones every time. Thousands, for hours, with the profile "night":
`pytest tests/array/test_every_array.py --hypothesis-profile night`.
"""

from __future__ import annotations

import copy
import pickle
import warnings
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from helpers import fingerprint
from hypothesis import assume, given, reject
from hypothesis import strategies as st
from mechanisms import turned

from solar_env.array import MODELS, ArrayParameters, build
from solar_env.array.methods import default_integrator
from solar_env.mechanics.arrays.columns import ANGLE
from solar_env.mechanics.integrators.settings import INTEGRATORS
from solar_env.mechanics.joints.laws import CONTACT_LAWS, SLIDING_READINGS
from solar_env.mechanics.mechanism.description import AnyBody, Body, Joint, Mechanism
from solar_env.mechanics.running.batch import Batch
from solar_env.mechanics.running.diagnosis import SimulationWarning
from solar_env.mechanics.running.errors import SimulationError
from solar_env.mechanics.running.simulation import Simulation

NAMES = sorted(set(ArrayParameters.CONTINUOUS) - {"hinge_y", "initial_spin", "initial_rate", "spring_preload_angle"})
DURATION = 0.3  # s
TORQUE = 0.5  # N m, the environment's bound


@st.composite
def arrays(draw: st.DrawFn) -> ArrayParameters:
    """Parameters over the documented space: each within a factor of ten of its default."""
    count = draw(st.integers(1, 8))
    changes: dict[str, Any] = {
        "panel_count": count,
        "body_fixed": draw(st.booleans()),
        "wear_bins": draw(st.sampled_from([1, 7, 360])),
        "hinge_y": draw(st.floats(-0.5, 0.5)),
        "initial_rate": draw(st.lists(st.floats(-0.5, 0.5), min_size=1, max_size=count)),
        "spring_preload_angle": draw(st.lists(st.floats(0.0, 4.0), min_size=1, max_size=count)),
        "contact_law": draw(st.sampled_from(sorted(CONTACT_LAWS))),
        "friction_sliding": draw(st.sampled_from(sorted(SLIDING_READINGS))),
    }
    if not changes["body_fixed"]:
        changes["initial_spin"] = draw(st.floats(-0.1, 0.1))
    if changes["contact_law"] in ("pereira", "bracket"):
        changes["contact_stiffness"] = None
    default = ArrayParameters()
    for name in draw(st.lists(st.sampled_from(NAMES), max_size=8, unique=True)):
        value = getattr(default, name)
        value = value[0] if isinstance(value, tuple) else value
        if value is not None and name not in changes:
            changes[name] = value * 10.0 ** draw(st.floats(-1.0, 1.0))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SimulationWarning)
        try:
            # Nothing that a default says by joint is in the way of another number of joints.
            return ArrayParameters(**{"spring_stiffness": 0.1, **changes})
        except ValueError as error:
            if not any(name in str(error) for name in vars(default)):
                raise
            reject()


def simulation(
    array: ArrayParameters,
    model: str,
    integrator: str | None = None,
    torque: float = 0.0,
    change: Callable[[Mechanism], Mechanism] = lambda mechanism: mechanism,
) -> Simulation:
    if integrator and model.startswith("flexible"):
        model += ":6 elements"
    method = INTEGRATORS[integrator](rtol=1e-4) if integrator else default_integrator(model)
    made = Simulation(change(build(array, model)), replace(method, max_steps=30_000))
    made.set_motor_torque(0, torque)
    return made


def run(made: Simulation, end: float = DURATION) -> bool:
    """Advance; whether the library had a word against it, a documented error or a warning."""
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        try:
            made.advance(end)
            made.check()
        except SimulationError:
            return True
    return bool(told)


METHODS = st.sampled_from([None, "runge-kutta", "rosenbrock"])


@given(arrays(), st.sampled_from(MODELS), METHODS, st.floats(-TORQUE, TORQUE))
def test_the_energy_book_of_every_array_closes_or_the_library_says_that_it_does_not(
    array: ArrayParameters, model: str, integrator: str | None, torque: float
) -> None:
    made = simulation(array, model, integrator, torque)
    told = run(made)
    assert all(np.isfinite(part).all() for part in (made.state.q, made.state.v)) or told
    residual, turnover = made.energy_book()
    assert told or abs(residual) <= 0.01 * turnover


@given(arrays(), st.sampled_from(MODELS), st.floats(0.05, 0.95))
def test_a_run_goes_on_to_the_same_bits_from_any_saved_state_copy_and_pickle(
    array: ArrayParameters, model: str, share: float
) -> None:
    made = simulation(array, model, torque=TORQUE)
    assume(not run(made, share * DURATION))
    others = [copy.deepcopy(made), pickle.loads(pickle.dumps(made)), simulation(array, model, torque=TORQUE)]
    others[-1].restore(made.snapshot())
    told = [run(each) for each in (made, *others)]
    assert len({fingerprint(each.state) for each in (made, *others)}) == 1
    assert len(set(told)) == 1


@given(arrays(), st.sampled_from(MODELS), st.integers(1, 3))
def test_a_lane_has_the_bits_of_its_simulation_alone(array: ArrayParameters, model: str, threads: int) -> None:
    alone, lanes = simulation(array, model), [simulation(array, model) for _ in range(3)]
    assume(not run(alone))
    batch = Batch(lanes, threads)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        assert not batch.attempt(np.arange(3), np.full(3, DURATION))
    assert {fingerprint(lane.state) for lane in lanes} == {fingerprint(alone.state)}


def elsewhere(mechanism: Mechanism, angle: float = 0.0) -> Mechanism:
    """The same mechanism at another place, turned by an angle about the origin."""

    def move(body: AnyBody) -> AnyBody:
        position = np.array([3.0, -2.0]) + turned(body.position, angle)
        velocity = turned(body.velocity, angle)
        return replace(body, position=tuple(position), velocity=tuple(velocity), angle=body.angle + angle)

    return replace(mechanism, bodies=tuple(move(body) for body in mechanism.bodies))


def mirror_image(mechanism: Mechanism) -> Mechanism:
    """The mechanism seen in a mirror along the x axis."""

    def flip(point: tuple[float, float]) -> tuple[float, float]:
        return point[0], -point[1]

    def mirrored(body: AnyBody) -> AnyBody:
        changes: dict[str, Any] = {"position": flip(body.position), "velocity": flip(body.velocity)}
        if isinstance(body, Body):
            changes["centroid"] = flip(body.centroid)
        return replace(body, angle=-body.angle, spin=-body.spin, **changes)

    def mirrored_joint(joint: Joint) -> Joint:
        points = {"inboard_point": flip(joint.inboard_point), "outboard_point": flip(joint.outboard_point)}
        return replace(joint, sign=-joint.sign, folded_angle=-joint.folded_angle, **points)

    return replace(
        mechanism,
        bodies=tuple(mirrored(body) for body in mechanism.bodies),
        joints=tuple(mirrored_joint(joint) for joint in mechanism.joints),
    )


def from_the_tip(mechanism: Mechanism) -> Mechanism:
    """The mechanism with everything listed in the reverse order."""
    bodies, joints, cables = mechanism.bodies, mechanism.joints, mechanism.cables
    return replace(mechanism, bodies=bodies[::-1], joints=joints[::-1], cables=cables[::-1])


def angles_of(made: Simulation) -> Any:
    return made.joint_loads()[:, ANGLE]


@given(arrays(), st.sampled_from(MODELS))
def test_the_mirror_image_of_an_array_moves_exactly_as_it_does(array: ArrayParameters, model: str) -> None:
    made, image = simulation(array, model), simulation(array, model, change=mirror_image)
    assert run(made) == run(image)
    assert np.array_equal(angles_of(image), angles_of(made))  # but for the sign of zero


def turned_elsewhere(mechanism: Mechanism) -> Mechanism:
    return elsewhere(mechanism, 0.7)


@given(arrays(), st.sampled_from(MODELS), st.sampled_from([elsewhere, turned_elsewhere, from_the_tip]))
def test_an_array_moves_the_same_wherever_it_is_and_in_whatever_order_it_is_described(
    array: ArrayParameters, model: str, change: Callable[[Mechanism], Mechanism]
) -> None:
    made, other = simulation(array, model), simulation(array, model, change=change)
    assume(not run(made, 0.1) and not run(other, 0.1))
    angles = angles_of(other)[::-1] if change is from_the_tip else angles_of(other)
    # Impacts multiply what rounding and the choice of steps change; those without damping most, to 1.0e-3 of 11,000.
    assert angles == pytest.approx(angles_of(made), abs=1e-5 if model.endswith("ideal") else 5e-3)
