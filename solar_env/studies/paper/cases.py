"""Deployments and four-bar linkage that the paper shows, and their simulation."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

from solar_env.array import MODELS, ArrayParameters, ModelLevel
from solar_env.mechanics.integrators.settings import RungeKutta
from solar_env.mechanics.mechanism import four_bar
from solar_env.mechanics.running.simulation import simulate as simulate_mechanism
from solar_env.mechanics.running.trajectory import Trajectory
from solar_env.studies.common.motion import Level, with_panels

DURATION = 30.0  # s, duration of the deployments
OUTPUT_STEP = 5e-3  # s
MEMBERS = 6  # members of an ensemble
JOINTS = (0, 1)
PANELS = "6 elements"  # beam elements in absolute nodal coordinates, as in the paper
# Suffix of the names, and prefix of the table columns, of cases with the contact stiffness of Eq 40.
EQ_40_CASE, EQ_40 = "-eq-40", "eq_40_"


_SIZES = {1: (1e-4, 2e-4), 2: (2e-4, 1e-4)}  # m; clearances of both joints in the paper's distribution models 1 and 2
# Deployments by name: the level of the model, and the parameters that differ from the `paper` preset.
CASES: Mapping[str, tuple[str, Mapping[str, object]]] = {
    **{model: (model, {}) for model in MODELS},
    **{f"distribution-{n}": ("rigid-clearance", {"clearance": sizes}) for n, sizes in _SIZES.items()},
    # The distribution models again, with each joint's contact stiffness from Eq 40.
    **{
        f"distribution-{n}{EQ_40_CASE}": ("rigid-clearance", {"clearance": sizes, "contact_stiffness": None})
        for n, sizes in _SIZES.items()
    },
}


def is_flexible(case: str) -> bool:
    """Return whether the deployment named `case` has flexible panels."""
    return ModelLevel.of(CASES[case][0]).flexible


# One member of an ensemble: all deployments by name.
Member = Mapping[str, Trajectory]
Value = float | str | None
# Parameters that differ from the `paper` preset, with their values.
Changes = tuple[tuple[str, Value], ...]


@dataclass(frozen=True)
class CaseRun:
    """A deployment to simulate: its name in CASES, the ensemble member, and changes to the `paper` preset."""

    case: str
    member: int = 0
    changes: Changes = ()


def simulate_run(run: CaseRun) -> Trajectory:
    """Return a run's trajectory; ensemble members above 0 have slightly other initial joint rates and tolerance."""
    model, changes = CASES[run.case]
    parameters = ArrayParameters.preset("paper").with_changes(dict(run.changes)).with_changes(changes)
    return Level(with_panels(model, PANELS)).deploy(parameters, run.member, DURATION, OUTPUT_STEP)


# The paper does not publish all data of its four-bar linkage. Here the linkage has the links of the default
# crank-rocker, 1 kg per metre, and the clearance and contact law of the array's joints. The sliding speed is the
# material points' speed: with the joint centres' speed, friction would drive the crank. The axis of Fig 5, 2.00 to
# 2.08 s, is the 26th turn at 12.5 turns per second; the turn ends with the paper's 416,000 steps of 5e-6 s.
FOUR_BAR_PIN = "crank-coupler"
FOUR_BAR_RATE = 2.0 * math.pi * 12.5  # rad/s
FOUR_BAR_TURNS = (6, 16, 26)
FOUR_BAR_WIDTH = 0.02  # m, width of the bearing
SAMPLES_PER_TURN = 720


def simulate_four_bar(turns: int, with_clearance: bool) -> Trajectory:
    """Return the trajectory of `turns` crank turns from centred journals; clearance only at the crank-coupler pin."""
    array = ArrayParameters()
    bearing = replace(array.bearing(0), width=FOUR_BAR_WIDTH)
    mechanism = four_bar(crank_rate=FOUR_BAR_RATE, clearances={FOUR_BAR_PIN: bearing} if with_clearance else None)
    mechanism = replace(mechanism, wear_bins=array.wear_bins)
    turn = 2.0 * math.pi / FOUR_BAR_RATE
    return simulate_mechanism(
        mechanism, turns * turn, integrator=RungeKutta(rtol=1e-6), output_step=turn / SAMPLES_PER_TURN
    )
