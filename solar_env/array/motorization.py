"""Motorization: the ratio of driving to resisting torque of each hinge, computed without a simulation.

ECSS-E-ST-33-01C Rev. 2 (2019), clause 4.7.5.3, asks for an actuation torque of twice the sum of a mechanism's
resistances. An uncertainty factor multiplies each resistance; the factor is smaller for a measured resistance.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solar_env.array.parameters import ArrayParameters
from solar_env.array.parameters.ranges import Ranges
from solar_env.array.parameters.rows import JointRow
from solar_env.support.values import check_name, check_positive

Array = NDArray[np.float64]

MARGIN = 2.0
# Uncertainty factors of resistances that have not been measured (table 4-2 of the standard); measured friction and
# measured harness torques have a factor of 1.5.
FACTORS: Mapping[str, float] = {"spring": 1.2, "friction": 3.0, "harness": 3.0, "damper": 3.0, "weight": 1.1}
_ANGLES = 201  # number of angles at which torques are compared
UNHURRIED = 60.0  # s, duration of a steady opening, whose rate gives the damper's torque


@dataclass(frozen=True)
class Motorization:
    """Torques of one hinge by joint angle, or summed torques of all hinges that cable loops couple.

    Attributes:
        name: name of the joint.
        angles: joint angles from the folded position to the lock [rad].
        driving: sum of the opening torques of spring, harness and weight [N m].
        resisting: sum of the resistances [N m].
        asked: driving torque that ECSS-E-ST-33-01C requires [N m].
    """

    name: str
    angles: Array
    driving: Array
    resisting: Array
    asked: Array

    @property
    def ratio(self) -> tuple[float, float]:
        """Least ratio of the driving torque to the torque that ECSS requires, and the joint angle there [rad]."""
        with np.errstate(divide="ignore", invalid="ignore"):
            ratios = np.where(self.asked > 0.0, self.driving / self.asked, np.inf)
        worst = int(np.argmin(ratios))
        return float(ratios[worst]), float(self.angles[worst])

    @property
    def stalls_at(self) -> float | None:
        """First angle before the lock at which the driving torque does not exceed the resistances [rad], or None."""
        stalled = (self.driving <= self.resisting) & (self.angles < self.angles[-1])
        return float(self.angles[np.argmax(stalled)]) if stalled.any() else None

    def __str__(self) -> str:
        """State in a sentence where the hinge stalls, or its least torque ratio."""
        ratio, angle = self.ratio
        if self.stalls_at is not None:
            return f"{self.name}: no torque left from {self.stalls_at:.3g} rad on, without any factor"
        if np.isinf(ratio):
            return f"{self.name}: nothing to overcome"
        short = ", which is too little" if ratio < 1.0 else ""
        return f"{self.name}: {ratio:.2f} times the required torque, least at {angle:.3g} rad{short}"


def listed(hinges: Sequence[Motorization]) -> str:
    """Return one line that states each hinge's least torque ratio or stall angle, with equal hinges listed together."""
    names = dict[str, list[str]]()
    for hinge in hinges:
        names.setdefault(str(hinge).removeprefix(hinge.name), []).append(hinge.name)
    return "; ".join(f"{', '.join(equal)}{told}" for told, equal in names.items())


def motorization(parameters: ArrayParameters, factors: Mapping[str, Any] | None = None) -> tuple[Motorization, ...]:
    """Return a tuple: a `Motorization` (torques) for each hinge, then one per wing if cable loops couple the hinges.

    Args:
        parameters: array parameters. Motor torque and the friction of the journals, which are unloaded, do not count.
        factors: uncertainty factor for each resistance by name, such as "friction"; replaces entries of FACTORS.

    Raises:
        ValueError: a factor is unknown, or not positive.
    """
    for name, value in (factors or {}).items():
        check_name("uncertainty factor", name, FACTORS)
        check_positive(name, value)
    used = {**FACTORS, **(factors or {})}
    hinges = tuple(_hinge(parameters, joint, used) for joint in parameters.joints)
    loops = parameters.panel_count > 1 and min(parameters.for_each_joint("cable_stiffness")) > 0.0
    wings = (hinges[k : k + parameters.panel_count] for k in range(0, len(hinges), parameters.panel_count))
    return (*hinges, *map(_together, wings)) if loops else hinges


def weakest(parameters: ArrayParameters, ranges: Ranges) -> ArrayParameters:
    """Return the array with the weakest springs and the greatest resistances that the ranges allow."""
    ends = {"spring_stiffness": 0, "spring_preload_angle": 0, "hinge_damping": 1, "hinge_friction_torque": 1}
    return parameters.with_changes({name: ranges[name][end] for name, end in ends.items() if name in ranges})


def slowest_damper(parameters: ArrayParameters, duration: float) -> float:
    """Compute the greatest damping [N m s/rad], equal in all hinges, with which each opens within `duration` [s].

    A hinge opens at a steady rate, at which the damping balances its driving torque averaged over the angle.

    Raises:
        ValueError: a hinge has no driving torque.
    """
    hinges = motorization(parameters)[: parameters.joint_count]
    most = min(float(hinge.driving.mean()) * duration / hinge.angles[-1] for hinge in hinges)
    if most <= 0.0:
        raise ValueError("a hinge has no torque, which says nothing of a usual damper; give hinge_damping=LOW,HIGH")
    return float(f"{most:.2g}")


def _hinge(p: ArrayParameters, joint: JointRow, factors: Mapping[str, float]) -> Motorization:
    k, angles = joint.index, np.linspace(0.0, joint.lock_angle, _ANGLES)
    spring = p.by_joint("spring_stiffness", k) * (p.by_joint("spring_preload_angle", k) - angles)
    spring, harness = (
        torque + _tabulated(p.table(name, k), angles)
        for torque, name in ((spring, "spring_torque"), (np.zeros(_ANGLES), "harness_torque"))
    )
    friction, damping, weight = p.friction_torque(k), p.by_joint("hinge_damping", k), _weight(p, k)
    resistances = {
        "spring": np.maximum(-spring, 0.0),
        "friction": np.full(_ANGLES, friction),
        "harness": np.maximum(-harness, 0.0),
        "weight": np.maximum(-weight, 0.0),
        "damper": np.full(_ANGLES, damping * joint.lock_angle / UNHURRIED),
    }
    asked = MARGIN * sum(factors[name] * torque for name, torque in resistances.items())
    driving = sum((np.maximum(torque, 0.0) for torque in (spring, harness, weight)), np.zeros(_ANGLES))
    return Motorization(joint.name, angles, driving, sum(resistances.values(), np.zeros(_ANGLES)), np.asarray(asked))


def _weight(p: ArrayParameters, joint: int) -> Array:
    """Compute the opening torque [N m] on a joint by the weight of the panels beyond, at _ANGLES angles of the joint.

    The angles are evenly spaced from 0 (folded) to the lock angle; all joints have opened by the same fraction of their
    lock angles. The weight that off-loading hangers carry is left out.
    """
    opened = np.array([row.sign * (np.linspace(0.0, row.lock_angle, _ANGLES) - row.fold_angle) for row in p.joints])
    turned = np.concatenate([np.cumsum(wing, axis=0) for wing in np.split(opened, p.wings)])
    turned[p.panel_count :] += np.pi  # a mirrored wing begins at the main body's other side
    panels, gravity = [p.panel(row.index) for row in p.joints], complex(*p.unsupported_gravity)
    torque = np.zeros(_ANGLES)
    place = np.zeros(_ANGLES, dtype=complex)  # position of the panel's inner end relative to the joint
    last = (joint // p.panel_count + 1) * p.panel_count
    for panel, angle in zip(panels[joint:last], turned[joint:last], strict=True):
        along = panel.length * np.exp(1j * angle)
        torque += panel.mass * ((place + along * (panel.centroid / panel.length)).conj() * gravity).imag
        place = place + along
    return p.joints[joint].sign * torque


def _tabulated(table: tuple[tuple[float, float], ...], angles: Array) -> Array:
    from scipy.interpolate import PchipInterpolator

    if len(table) < 2:
        return np.full(angles.shape, table[0][1] if table else 0.0)
    return np.asarray(PchipInterpolator(*np.array(table).T)(angles))


def _together(hinges: tuple[Motorization, ...]) -> Motorization:
    """Return one `Motorization` (torques by angle) for coupled hinges, which open by equal fractions of lock angles.

    The torques of all hinges are added, each multiplied by its hinge's lock angle divided by the first hinge's.
    """
    first = hinges[0].angles
    total = [
        sum(getattr(hinge, name) * (hinge.angles[-1] / first[-1]) for hinge in hinges)
        for name in ("driving", "resisting", "asked")
    ]
    name = f"the wing from {hinges[0].name} on, driven as one by its cables"
    return Motorization(name, first, *map(np.asarray, total))
