"""Versions of the task, one row each: what the number of an environment's id stands for."""

from collections.abc import Mapping
from typing import Any, NamedTuple

from solar_env.environment.task.task import Task

# Forms of a price, the codes of `reward.cost`: a figure costs `weight * min(figure / scale, bound)`.
BOUNDED = 0


class Version(NamedTuple):
    """A version of the task: limits, times and prices where the keywords of an environment say nothing else.

    Attributes:
        task: limits and times.
        form: of the prices, a code of `reward.cost`.
        prices: of the terms that are charged, in the words of the keyword `reward`.
    """

    task: Task
    form: int
    prices: Mapping[str, Any]


VERSIONS = {
    "v1": Version(
        Task(torque_limit=0.5, control_period=0.1, deadline=20.0, postlock_window=10.0),
        BOUNDED,
        {"peak_impact": 1.0, "wear": 1.0, "missed_deadline": {"weight": 25.0, "bound": 2.0}},
    ),
}
CURRENT_VERSION = "v1"
PRESENT = VERSIONS[CURRENT_VERSION]
