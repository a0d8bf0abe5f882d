"""Quantities that are computed from a simulated deployment, for each joint and for the hub."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from solar_env.studies.loads.runs import Deployment

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Quantity:
    """A quantity of a deployment, with its printed unit and the function that computes its values."""

    name: str
    unit: str  # unit in which the quantity is printed
    read: Callable[[Deployment], Array]  # (joints,) values in SI units, or (1,) of the hub; nan where not known
    scale: float = 1.0  # printed units per SI unit
    needs_latching: bool = True


def _impacts(deployment: Deployment) -> list[NDArray[np.void]]:
    """Return the records of contacts that began after the first latching, one array per joint."""
    trajectory = deployment.trajectory
    later = trajectory.contacts[trajectory.contacts["start_s"] > np.nanmin(trajectory.latch_times)]
    return [later[later["joint"] == joint] for joint in range(len(trajectory.latch_times))]


def _impact_speed(share: float) -> Callable[[Deployment], Array]:
    def read(deployment: Deployment) -> Array:
        speeds = [impacts["impact_speed"] for impacts in _impacts(deployment)]
        return np.array([np.quantile(impacts, share) if len(impacts) else np.nan for impacts in speeds])

    return read


def _turn(deployment: Deployment) -> Array:
    return np.asarray(deployment.place[:, 2] - deployment.place[0, 2])


_DEGREES = 180.0 / np.pi
JOINT_QUANTITIES: Mapping[str, Quantity] = {
    "latch_time": Quantity("latches after", "s", lambda d: d.trajectory.latch_times),
    "latch_rate": Quantity("rate at the latch", "rad/s", lambda d: d.trajectory.latch_rates),
    "latch_torque": Quantity("peak torque of the latch", "N m", lambda d: d.trajectory.peak_latch_torque),
    "peak_force": Quantity("peak pin force", "N", lambda d: d.trajectory.peak_force, needs_latching=False),
    "peak_torque": Quantity("bending moment at the panel's root", "N m", lambda d: d.peak_torque, needs_latching=False),
    "impulse": Quantity("momentum exchanged after latching", "N s", lambda d: d.trajectory.postlock_impulse),
    "impact_count": Quantity("impacts after latching", "", lambda d: np.array([len(x) for x in _impacts(d)], float)),
    "impact_speed_max": Quantity("fastest impact", "mm/s", _impact_speed(1.0), 1e3),
    "impact_speed_median": Quantity("median impact", "mm/s", _impact_speed(0.5), 1e3),
    "sliding_work": Quantity(
        "sliding work, without friction's coefficient", "mJ", lambda d: d.trajectory.postlock_sliding_work, 1e3
    ),
    "wear_depth": Quantity("deepest wear", "fm", lambda d: d.trajectory.wear_depth, 1e15),
}
# A hub feels the force of the root hinge; the hub's acceleration follows from the force.
HUB_QUANTITIES: Mapping[str, Quantity] = {
    "hub_excursion": Quantity("greatest turn", "deg", lambda d: np.abs(_turn(d)).max(keepdims=True), _DEGREES),
    "hub_turn": Quantity("turn at the end", "deg", lambda d: _turn(d)[-1:], _DEGREES),
    "hub_force": Quantity("peak force, over 50 us", "N", lambda d: d.hub_peaks[:1], needs_latching=False),
    "hub_torque": Quantity("peak torque, over 50 us", "N m", lambda d: d.hub_peaks[1:2], needs_latching=False),
    "hub_acceleration": Quantity("peak acceleration, over 50 us", "m/s2", lambda d: d.hub_peaks[2:]),
}
QUANTITIES = {**JOINT_QUANTITIES, **HUB_QUANTITIES}


def read_all(deployment: Deployment) -> dict[str, list[float]]:
    """Return all quantities by name, in SI units; those that need all joints latched are nan if a joint is open."""
    latch_times, found = deployment.trajectory.latch_times, {}
    for name, quantity in QUANTITIES.items():
        told = np.isfinite(latch_times).all() or not quantity.needs_latching
        unknown = np.full(len(latch_times) if name in JOINT_QUANTITIES else 1, np.nan)
        found[name] = np.asarray(quantity.read(deployment) if told else unknown, float).tolist()
    return found
