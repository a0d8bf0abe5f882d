"""Named scenarios: the parameters sampled for each episode, and the quality of sensors and motor."""

import math
import operator
from collections.abc import Callable, Mapping
from typing import NamedTuple

from solar_env.array import ArrayParameters
from solar_env.array.parameters.ranges import Bound, Ranges
from solar_env.environment.hardware import Hardware


class Spread(NamedTuple):
    """Range from which a parameter is sampled, relative to the array's own value.

    Attributes:
        low, high: numbers that give the bounds of the range: of(value, low) and of(value, high).
        of: product, sum or power, as a function of two numbers; the first is the array's own value.
    """

    low: float
    high: float
    of: Callable[[float, float], float] = operator.mul

    def around(self, value: float | tuple[float, ...]) -> tuple[Bound, Bound]:
        """Return the lower and upper bound around a parameter's value; values by joint give bounds by joint."""
        if isinstance(value, tuple):
            return tuple(self.of(entry, self.low) for entry in value), tuple(self.of(x, self.high) for x in value)
        return self.of(value, self.low), self.of(value, self.high)


class Scenario(NamedTuple):
    """A named set of default values, which the keywords of an environment can change.

    Attributes:
        title: name in the environments' ids, before the version of the task.
        parameters: array parameters before random sampling.
        spreads: spread of each parameter that is sampled anew for every episode, by name of the parameter.
        hardware: properties of sensors and motors.
    """

    title: str
    parameters: ArrayParameters
    spreads: Mapping[str, Spread]
    hardware: Hardware

    def ranges(self, array: ArrayParameters) -> Ranges:
        """Return the ranges of sampled parameters around an array's values; a fixed main body gets no initial spin."""
        turns = not array.body_fixed
        values = {n: getattr(array, n) for n in self.spreads if turns or n != "initial_spin"}
        several = {n: array.for_each_joint(n) for n, value in values.items() if isinstance(value, tuple)}
        return {n: self.spreads[n].around(value) for n, value in (values | several).items()}


_TENTH = Spread(0.9, 1.1)

SCENARIOS: dict[str, Scenario] = {
    "nominal": Scenario("Deploy", ArrayParameters(), {}, Hardware()),
    # The widths are chosen. They cover hinge tolerances, dry to worn hinges, the scatter of springs and panels, a
    # spacecraft that turns by less than 0.3 degrees per second, and an encoder of 13 bits. Below a restitution of 0.9
    # the contact law of Flores et al. reproduces the restitution; the law of Lankarani and Nikravesh does not.
    "randomised": Scenario(
        title="DeployRandomised",
        parameters=ArrayParameters(contact_law="flores"),
        spreads={
            "clearance": Spread(0.25, 2.5),
            "friction_coefficient": Spread(1.0 / 3.0, 2.0),
            # Gives 0.7 to 0.95 if the restitution is 0.9; a positive power of a restitution is also a restitution.
            "restitution": Spread(math.log(0.7) / math.log(0.9), math.log(0.95) / math.log(0.9), operator.pow),
            "spring_stiffness": _TENTH,
            "cable_stiffness": _TENTH,
            "panel_young": _TENTH,
            "initial_rate": Spread(0.0, 0.01, operator.add),
            "initial_spin": Spread(-0.005, 0.005, operator.add),
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
