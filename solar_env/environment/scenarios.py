"""Named scenarios: the parameters drawn for each episode, and the quality of sensors and motor."""

import math
from typing import NamedTuple

from solar_env.array import ArrayParameters
from solar_env.array.parameters.ranges import Bound, Ranges
from solar_env.environment.hardware import Hardware


class Scenario(NamedTuple):
    """Values that the keywords of an environment change.

    Attributes:
        title: in the ids of its environments, followed by the version of the task.
        parameters: of the array, before anything is drawn.
        randomize: parameter -> (low, high), drawn anew for every episode; bounds by joint from the root on.
        hardware: sensors and motor.
    """

    title: str
    parameters: ArrayParameters
    randomize: Ranges
    hardware: Hardware


def _around(value: float | tuple[float, ...], share: float) -> tuple[Bound, Bound]:
    """Bounds at a share below and above a nominal value."""
    low, high = 1.0 - share, 1.0 + share
    if isinstance(value, tuple):
        return tuple(low * entry for entry in value), tuple(high * entry for entry in value)
    return low * value, high * value


_NOMINAL = ArrayParameters()

SCENARIOS: dict[str, Scenario] = {
    "nominal": Scenario("Deploy", ArrayParameters(), {}, Hardware()),
    # Widths are chosen: hinges within their tolerances and from dry to worn, springs and panels as they come, a
    # spacecraft that turns by less than 0.3 degrees a second, an encoder of 13 bits. The law of Flores et al. gives the
    # restitution that it is asked for, which Lankarani and Nikravesh's does not below 0.9.
    "randomised": Scenario(
        title="DeployRandomised",
        parameters=ArrayParameters(contact_law="flores"),
        randomize={
            "clearance": (0.05e-3, 0.5e-3),
            "friction_coefficient": (0.05, 0.3),
            "restitution": (0.7, 0.95),
            "spring_stiffness": _around(_NOMINAL.spring_stiffness, 0.1),
            "cable_stiffness": _around(_NOMINAL.cable_stiffness, 0.1),
            "panel_young": _around(_NOMINAL.panel_young, 0.1),
            "initial_rate": (0.0, 0.01),
            "initial_spin": (-0.005, 0.005),
        },
        hardware=Hardware(
            angle_noise=5e-4,
            rate_noise=1e-3,
            encoder_resolution=2.0 * math.pi / 2**13,
            sensor_delay=1,
            motor_lag=0.1,
            torque_rate_limit=1.0,
        ),
    ),
}
