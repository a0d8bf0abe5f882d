"""Parameters of the array: what is refused, presets, and the bearings that they describe."""

from __future__ import annotations

import json
import math
import re
import warnings
from dataclasses import fields
from typing import Any

import numpy as np
import pytest

from solar_env.array import MODELS, ArrayParameters, build
from solar_env.array.methods import default_integrator
from solar_env.mechanics.mechanism.description import Stop
from solar_env.mechanics.running.diagnosis import SimulationWarning
from solar_env.mechanics.running.simulation import Simulation

NUMBERS = [f.name for f in fields(ArrayParameters) if not isinstance(f.default, (str, bool)) and f.default != ()]
PER_JOINT = ArrayParameters.BY_JOINT


def refused(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=re.escape(message)):
        ArrayParameters().with_changes(changes)


def test_the_defaults_are_the_papers_table() -> None:
    p = ArrayParameters()
    assert (p.body_mass, p.body_inertia) == (1500.0, 250.0)
    assert p.panel(0).mass == pytest.approx(6.0, rel=1e-14)
    assert (p.spring_stiffness, p.spring_preload_angle) == ((0.1, 0.075), (math.pi / 2, math.pi))
    assert (p.restitution, p.contact_stiffness, p.friction_coefficient) == (0.9, 7.39e10, 0.15)
    assert (p.journal_radius, p.clearance) == (0.01, 2e-4)


@pytest.mark.parametrize("name", NUMBERS)
def test_what_is_not_a_finite_number_is_refused_by_name(name: str) -> None:
    for value in (math.nan, math.inf, -math.inf, "1", [], [[1.0]], True):
        with pytest.raises(ValueError, match=f"^{name} = "):
            ArrayParameters().with_changes({name: value})


POSITIVE = (
    "body_mass", "body_inertia", "body_size", "panel_length", "panel_width", "panel_thickness", "panel_density",
    "panel_young", "cable_wheel_radius", "journal_radius", "bearing_width", "clearance", "contact_stiffness",
    "panel_count", "wear_bins", "restitution", "minimum_impact_speed", "journal_young", "bearing_young",
    "latch_stiffness", "latch_ramp_depth", "panel_area_mass", "panel_bending_stiffness",
)  # fmt: skip
NOT_NEGATIVE = (
    "panel_damping", "cable_stiffness", "cable_preload_force", "cable_torque_ratio", "friction_coefficient",
    "wear_coefficient", "spring_stiffness", "hinge_x", "friction_speed_zero", "latch_gap", "latch_damping",
    "hinge_damping", "hinge_friction_torque", "release_time",
)  # fmt: skip


def test_what_must_be_positive_or_must_not_be_negative_is_refused_otherwise_by_name_and_value() -> None:
    for name in POSITIVE:
        kind = int if isinstance(getattr(ArrayParameters(), name), int) else float
        for value in (kind(0), kind(-1)):
            refused({name: value}, f"{name} = {value!r} must")
    for name in NOT_NEGATIVE:
        refused({name: -0.1}, f"{name} = -0.1 must")
        assert getattr(ArrayParameters().with_changes({name: 0.0}), name) == 0.0


REFUSED: tuple[tuple[dict[str, Any], str], ...] = (
    ({"panel_count": 101}, "panel_count = 101 must lie between 1 and 100"),
    ({"wear_bins": 360.0}, "wear_bins = 360.0 must be a whole number"),
    ({"clearance": 0.0}, "clearance = 0.0 must be positive; for no clearance choose an ideal model"),
    ({"clearance": (1e-4, -1e-4)}, "clearance = (0.0001, -0.0001) must be positive"),
    ({"clearance": 0.02}, "clearance = 0.02 must be below journal_radius"),
    ({"restitution": 1.1}, "restitution = 1.1 must lie in (0, 1]"),
    ({"contact_law": "dubowsky"}, "contact law 'dubowsky' is unknown"),
    ({"contact_law": 3}, "contact_law = 3 must be of type str"),
    ({"friction_sliding": "paper"}, "friction_sliding = 'paper' must be one of material, centres, places"),
    ({"body_fixed": 1}, "body_fixed = 1 must be of type bool"),
    ({"body_fixed": True, "initial_spin": 0.1}, "initial_spin = 0.1 needs a body that is not fixed"),
    ({"journal_poisson": -1.0}, "journal_poisson = -1.0 must lie in (-1, 0.5]"),
    ({"bearing_poisson": 0.51}, "bearing_poisson = 0.51 must lie in (-1, 0.5]"),
    ({"friction_speed_zero": 1e-2}, "friction_speed_zero = 0.01 must be below friction_speed_full = 0.001"),
    ({"friction_speed_zero": (1e-4, 2e-3)}, "friction_speed_zero = (0.0001, 0.002) must be below"),
    ({"body_mass": None}, "body_mass = None must be a finite number"),
    ({"clearence": 1e-4}, "parameter 'clearence' is unknown; did you mean 'clearance'?"),
    # What no number of a computer can hold.
    ({"panel_length": 1e-21}, "panel_length = 1e-21 must be positive, at least 1e-20"),
    ({"contact_stiffness": (1e-300, 1e10)}, "contact_stiffness = (1e-300, 10000000000.0) must be positive, at least"),
    ({"hinge_y": -1e21}, "hinge_y = -1e+21 must be at most 1e+20, in magnitude"),
    ({"initial_spin": 10**400}, "must be at most 1e+20, in magnitude"),
    ({"clearance": 1e-19}, "clearance = 1e-19 is lost in rounding beside journal_radius = 0.01; for no clearance"),
    ({"panel_thickness": 1e9}, "panel_thickness = 1000000000.0 is out of proportion to panel_length = 1.5"),
    ({"body_mass": 1e-12}, "body_inertia = 250.0 makes, with body_mass = 1e-12, a radius of gyration of 1.58e+07 m"),
)


def test_other_values_without_sense_are_refused_by_name_and_rule() -> None:
    for changes, message in REFUSED:
        refused(changes, message)
    assert ArrayParameters(hinge_y=1e-33, initial_rate=-1e-300).hinge_y == 1e-33
    ArrayParameters(friction_speed_zero=(1e-4, 2e-3), friction_speed_full=(1e-3, 3e-3))


LEVELS = [*MODELS, "flexible-ideal:6 elements", "flexible-clearance:6 elements"]


def said_of(parameters: ArrayParameters, level: str) -> str:
    """What is said of an array that cannot be, and nothing of one that can."""
    try:
        Simulation(build(parameters, level), default_integrator(level))
    except ValueError as error:
        return str(error)
    return ""


@pytest.mark.filterwarnings("ignore:the contact law .* turns a restitution of")
@pytest.mark.filterwarnings("ignore::solar_env.array.parameters.checks.UnitWarning")
@pytest.mark.parametrize("value", [1e-300, 1e-20, 1e20, 1e300])
@pytest.mark.parametrize("name", sorted(ArrayParameters.CONTINUOUS))
def test_an_extreme_value_is_refused_by_name_or_makes_an_array(name: str, value: float) -> None:
    try:
        parameters = ArrayParameters().with_changes({name: value})
    except ValueError as error:
        told = str(error)
    else:
        said = {said_of(parameters, level) for level in LEVELS} - {""}
        if name in ("initial_spin", "initial_rate"):  # too fast for constraints to be met in a computer's numbers
            said = {told for told in said if "the initial velocity violates a constraint" not in told}
        assert not said
        return
    assert name in told
    assert repr(value) in told


@pytest.mark.parametrize("name", [n for n in NUMBERS if n not in PER_JOINT])
def test_only_quantities_by_joint_take_several_entries(name: str) -> None:
    refused({name: (1.0, 1.0)}, f"{name} = (1.0, 1.0) must be a single number")


@pytest.mark.parametrize("name", PER_JOINT)
def test_the_last_entry_of_a_quantity_by_joint_holds_for_all_further_joints(name: str) -> None:
    unit = {"latch_exponent": 1.0, "friction_speed_full": 1.0, "friction_speed_zero": 1e-5, "fold_angle": 1.0}
    one, two = (unit.get(name, 1e-3) * factor for factor in (1.0, 1.1))
    one, two = {"latching": (0, 1), "release_after": (0, 1), "lock_angle": (1.0, 1.1)}.get(name, (one, two))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SimulationWarning)
        p = ArrayParameters(panel_count=4).with_changes({name: [one, two]})
        assert p.for_each_joint(name) == (one, two, two, two)
        assert [ArrayParameters().with_changes({name: two}).by_joint(name, j) for j in range(2)] == [two] * 2
        refused({name: (one, two, two)}, f"{name} = {(one, two, two)} has more entries than joints (2)")


def test_hinges_and_loops_that_differ_become_those_of_the_mechanism() -> None:
    p = ArrayParameters(
        panel_count=3, cable_stiffness=(20.0, 30.0), latch_gap=(0.0, 0.01, 0.02), latch_stiffness=(1e3, 2e3),
        latch_exponent=(1.0, 1.5), latch_ramp_depth=(1e-3, 2e-3), latch_damping=(10.0, 5.0), restitution=(0.9, 0.8),
        contact_stiffness=(7e10, 6e10), friction_coefficient=(0.1, 0.2),
        friction_speed_zero=(0.0, 1e-4), friction_speed_full=(1e-3, 2e-3),
        contact_law="restitution",
    )  # fmt: skip
    mechanism = build(p)
    assert [cable.stiffness for cable in mechanism.cables] == [20.0, 30.0]
    assert [cable.wheel_radius for cable in mechanism.cables] == [None] * 2
    assert build(p.with_changes({"cable_bearing_forces": True})).cables[0].wheel_radius == 0.05
    assert [joint.stop for joint in mechanism.joints] == [
        Stop(0.0, 1e3, 1.0, 1e-3, 10.0), Stop(0.01, 2e3, 1.5, 2e-3, 5.0), Stop(0.02, 2e3, 1.5, 2e-3, 5.0),
    ]  # fmt: skip
    bearings = [joint.bearing for joint in mechanism.joints]
    assert [bearing.contact.stiffness for bearing in bearings] == [7e10, 6e10, 6e10]
    ratios = [bearing.contact.exit_speed_ratio() for bearing in bearings]
    assert ratios == pytest.approx([0.9, 0.8, 0.8], rel=1e-6)
    assert [bearing.friction_coefficient for bearing in bearings] == [0.1, 0.2, 0.2]
    assert [bearing.friction_speeds for bearing in bearings] == [(0.0, 1e-3), (1e-4, 2e-3), (1e-4, 2e-3)]
    assert ArrayParameters().with_changes(json.loads(json.dumps(p.to_dict()))) == p


def test_changes_leave_the_original_alone_and_may_be_lists() -> None:
    p = ArrayParameters()
    changed = p.with_changes({"clearance": [1e-4, 3e-4], "body_mass": 900.0})
    assert (changed.clearance, changed.body_mass) == ((1e-4, 3e-4), 900.0)
    assert p == ArrayParameters()


@pytest.mark.parametrize(
    ("name", "given", "kept"),
    [
        ("clearance", np.array([1e-4, 2e-4]), (1e-4, 2e-4)),
        ("clearance", [np.float64(1e-4), 2e-4], (1e-4, 2e-4)),
        ("clearance", np.array(1e-4), 1e-4),
        ("initial_rate", np.array([0, 1]), (0, 1)),
        ("body_mass", np.float32(900.5), 900.5),
        ("body_mass", np.float64(900.5), 900.5),
        ("contact_stiffness", np.float32(2.0**36), 2.0**36),
        ("panel_count", np.int64(3), 3),
        ("wear_bins", np.int32(90), 90),
        ("body_fixed", np.bool_(True), True),
        ("contact_law", np.str_("flores"), "flores"),
    ],
)
def test_numpys_numbers_and_arrays_are_taken_as_pythons(name: str, given: Any, kept: Any) -> None:
    for p in (ArrayParameters(**{name: given}), ArrayParameters().with_changes({name: given})):
        value = getattr(p, name)
        assert value == kept
        assert type(value) is type(kept)
        if isinstance(kept, tuple):
            assert [type(entry) for entry in value] == [type(entry) for entry in kept]
        assert ArrayParameters().with_changes(json.loads(json.dumps(p.to_dict()))) == p
        assert hash(p) == hash(ArrayParameters(**{name: kept}))


def test_the_papers_preset_differs_in_these_four_parameters_alone() -> None:
    assert ArrayParameters.preset("paper") == ArrayParameters(
        hinge_y=-0.5, cable_torque_ratio=1.0, panel_damping=0.0, wear_coefficient=4e-15
    )
    assert ArrayParameters.preset("default") == ArrayParameters()
    with pytest.raises(ValueError, match="preset 'papper' is unknown; did you mean 'paper'"):
        ArrayParameters.preset("papper")


def test_the_contact_stiffness_is_given_or_follows_from_eq_40_by_joint() -> None:
    assert ArrayParameters().contact(1).stiffness == 7.39e10
    p = ArrayParameters(contact_stiffness=None, clearance=(2e-4, 1e-4))
    assert p.contact(0).stiffness == pytest.approx(7.43e10, abs=0.005e10)
    assert p.contact(1).stiffness > p.contact(0).stiffness == p.bearing(0).contact.stiffness


def test_a_bearing_takes_over_its_parameters() -> None:
    p = ArrayParameters(clearance=(1e-4, 3e-4), contact_law="flores", restitution=0.5, friction_sliding="centres")
    bearing = p.bearing(1)
    assert bearing.clearance == 3e-4
    assert bearing.contact.damping == pytest.approx(1.6, rel=1e-14)
    assert bearing.sliding == "centres"
    assert bearing.friction_speeds == (1e-4, 1e-3)


def test_fittings_and_tables_that_are_none_are_refused_by_name() -> None:
    for given in ((1, 0.2, 1.0), ((3, 0.2, 1.0),), ((1, 2.0, 1.0),), ((1, 0.2, 0.0),), ((1, 0.2),), 5):
        with pytest.raises(ValueError, match=r"^panel_masses = "):
            ArrayParameters(panel_masses=given)
    for given in (5, ((0.0,),), ((0.0, 1.0), (1.0, 1.0)), ((1.0, 0.1), (0.0, 0.2)), ((0.0, math.nan), (4.0, 0.0))):
        with pytest.raises(ValueError, match=r"^harness_torque = "):
            ArrayParameters(harness_torque=given)
    with pytest.raises(ValueError, match=r"release_after = 'joint 1': is a joint that waits for this one"):
        build(ArrayParameters(release_after=1))


def test_dry_friction_turns_round_at_a_hundredth_of_the_rate_at_which_a_spring_opens_a_lone_panel():
    one = ArrayParameters(panel_count=1)
    # Half a spring's k (pi/2)^2 is the energy of 4.5 kg m2.
    assert one.friction_rate(0) == pytest.approx(0.01 * math.sqrt(0.1 * (math.pi / 2) ** 2 / 4.5), rel=1e-12)
    table = ArrayParameters(panel_count=1, spring_stiffness=0.0, spring_torque=((0.0, 0.1), (math.pi / 2, 0.3)))
    assert table.friction_rate(0) == pytest.approx(0.01 * math.sqrt(2.0 * 0.1 * math.pi / 4.5), rel=1e-12)
    assert ArrayParameters(spring_stiffness=0.0).friction_rate(0) > 0.0
    assert ArrayParameters(hinge_friction_rate=0.02).friction_rate(1) == 0.02


def test_angles_that_were_rounded_up_or_down_are_taken():
    ArrayParameters(spring_preload_angle=6.2832, harness_torque=((0.0, 0.1), (3.1415, 0.0)))
    with pytest.raises(ValueError, match=r"must reach from 0 to the lock angle of joint 2, 3\.14159 rad"):
        ArrayParameters(harness_torque=((0.0, 0.1), (3.13, 0.0)))
