"""The table of reward terms: physical quantities for which an episode is charged, and their prices."""

import math
import sys
from collections.abc import Callable, Iterable, Mapping
from dataclasses import MISSING, dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from solar_env.array.parameters.checks import Rule, check_rows, number
from solar_env.environment.task.control import last_latch, missed_deadline
from solar_env.environment.task.task import PRESENT, VERSIONS, Version
from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.integrators.formulations import view_joint_of
from solar_env.mechanics.numerics.jit import kernel
from solar_env.support.markdown import markdown_table
from solar_env.support.values import changed, check_name, is_number, plain, unknown_name

# Codes of the charged quantities, which `reading` computes from the state.
PEAK_IMPACT, SLIDING_WORK, MISSED_DEADLINE, ATTITUDE_DISTURBANCE, POSTLOCK_SLIDING_WORK = range(5)
MOTOR_WORK, PRELATCH_PEAK, TIME, LATENESS, OPENING = range(5, 10)
# Forms of a price by name, with their codes for `cost`.
FORMS = {"linear": 0, "decades": 1}
LINEAR, DECADES = FORMS.values()
# How a charged quantity follows from a measure at the ends of the control periods: it is the latest value (of a
# measure that never falls), the greatest magnitude, or the sum of the magnitudes of the changes.
LATEST, GREATEST, CHANGES = range(3)
# Columns of a term's account: the quantity charged so far, and the latest value of the measure.
FIGURE, READING = range(2)


_POSITIVE = Rule(math.ulp(0.0), sys.float_info.max, "of a term of the reward must be positive and finite")
_NOT_NEGATIVE = Rule(0.0, sys.float_info.max, "of a term of the reward must be finite and not negative")


@dataclass(frozen=True)
class Price:
    """The price of a physical quantity q. With x = `min(q / scale, bound)` the cost is `weight * x` in the form
    "linear", and `weight * log10(1 + x)` in the form "decades".

    Attributes:
        scale: amount of the quantity for which x is 1, in the quantity's unit.
        weight: factor on the cost; 0 leaves the term out.
        bound: greatest x.
        form: "linear" or "decades".
    """

    scale: float = number(MISSING, _POSITIVE)
    weight: float = number(1.0, _NOT_NEGATIVE)
    bound: float = number(12.0, _POSITIVE)
    form: str = "linear"

    def __post_init__(self) -> None:
        check_name("the form", self.form, FORMS)
        check_rows(self)

    @property
    def row(self) -> tuple[int, float, float, float]:
        """Tuple (integer code of the form, scale, weight, bound), the last four fields of a `price_type` record."""
        return FORMS[self.form], self.scale, self.weight, self.bound

    @property
    def greatest(self) -> float:
        """Greatest possible cost at this price, reached where the quantity divided by `scale` is `bound`."""
        return self.weight * (self.bound if self.form == "linear" else math.log10(1.0 + self.bound))


class RewardTerm(NamedTuple):
    """A term of the reward: in each step, minus the increase in the cost of a physical quantity.

    Attributes:
        figure, phase, unit: texts for the quantity, the part of the episode in which it costs, and its unit.
        code: integer for the kernel `reading`, which measures the quantity at the end of each step.
        growth: how the quantity since the episode began follows from these measured values: it is the LATEST value, the
            GREATEST magnitude, or the sum of the magnitudes of CHANGES.
        scale: amount by which the quantity is divided in its cost, unless a `Price` gives another. The cost has a
            weight, which is 0 unless the task's version or the environment's keyword `reward` gives one.
        sign: 1 for a quantity that costs, -1 for a quantity that earns.
    """

    name: str
    figure: str
    phase: str
    unit: str
    code: int
    growth: int
    scale: float
    sign: int = 1


_PRELATCH, _POSTLOCK = "up to the first latching", "from the first latching"
_WHOLE, _DEADLINE = "whole episode", "at the end of the episode"
_MISSED = "1 and the mean distance to the lock, in lock angles, if a joint is open"
_WORK = "sliding work, summed over joints"
REWARD_TERMS = (
    RewardTerm("peak_impact", "peak forces, summed over joints", _POSTLOCK, "N", PEAK_IMPACT, LATEST, 500.0),
    # Wear is proportional to the integral of normal force times sliding speed (Archard, J. Appl. Phys. 24 (1953) 981).
    RewardTerm("wear", _WORK, _WHOLE, "J", SLIDING_WORK, LATEST, 0.1),
    # Graded by distance: if no joint latches, a search still sees in which direction the lock lies.
    RewardTerm("missed_deadline", _MISSED, _DEADLINE, "-", MISSED_DEADLINE, LATEST, 1.0),
    RewardTerm("attitude_disturbance", "peak main body spin", _WHOLE, "rad/s", ATTITUDE_DISTURBANCE, GREATEST, 0.01),
    RewardTerm("postlock_wear", _WORK, _POSTLOCK, "J", POSTLOCK_SLIDING_WORK, LATEST, 0.05),
    RewardTerm("motor_work", "magnitudes of the motor's work by period", _WHOLE, "J", MOTOR_WORK, CHANGES, 0.5),
    RewardTerm("prelatch_peak", "peak forces, summed over joints", _PRELATCH, "N", PRELATCH_PEAK, LATEST, 500.0),
    RewardTerm("time", "time", "up to the last latching", "s", TIME, LATEST, 20.0),
    RewardTerm("lateness", "time", "from a control period before the deadline on", "s", LATENESS, LATEST, 1.0),
    # All deployments earn the same amount, but step by step: an agent paid only at the end learns nothing before.
    RewardTerm("opening", "mean opening, in lock angles, which is earned", _WHOLE, "-", OPENING, GREATEST, 1.0, -1),
)

# Terms in which a missed deadline costs at least as much, or earns at most as much, as any other deployment.
_MISSED_TOO = ("missed_deadline", "time", "lateness", "opening")

_CODES, _NUMBERS = ("code", "growth", "sign", "form"), ("scale", "weight", "bound")
_PRICE = [*((name, "i8") for name in _CODES), *((name, "f8") for name in _NUMBERS)]
price_type = np.dtype((np.record, np.dtype(_PRICE, align=True)))


class Quantities(dict[str, float]):
    """Quantities by name for a user's reward function; a wrong name raises a KeyError that suggests the right one."""

    def __missing__(self, name: object) -> float:
        raise KeyError(unknown_name("the quantity", name, self))


Told = Mapping[str, float]
"""The figures of all terms so far, by name and in their units, and "time_s"."""
RewardFunction = Callable[[Told, Told], float]
"""A user's reward: a function of the figures before and after a step."""
OWN = "own"  # name of the only term of a user's reward function


class Reward:
    """The reward of an environment: a task version's prices with changes, or a user's function.

    Args:
        changes: for each changed term by name, a weight, a `Price`, or changed fields of `Price`; or a user's function.
        version: version of the task.

    Attributes:
        prices: price of every term, by name of the term.
        function: the user's function, which gets the quantities of all terms; or None.
        names: names of the charged terms, whose weight is not zero, in the order of `REWARD_TERMS`.
        rows: `price_type` record of each term: code, growth and sign from `RewardTerm`, the rest from `Price`.

    Raises:
        ValueError: for an unknown name or a refused value, or if the price of a missed deadline does not exceed the
            greatest possible sum of the other terms (time, lateness and opening not counted).
    """

    def __init__(
        self, changes: Mapping[str, object] | RewardFunction | None = None, version: Version = PRESENT
    ) -> None:
        self.function = changes if callable(changes) else None
        if callable(changes):
            self.prices = {term.name: Price(1.0, 1.0, sys.float_info.max) for term in REWARD_TERMS}
            self.names: tuple[str, ...] = (OWN,)
            self.rows = self._rows(REWARD_TERMS)
            return
        self.prices = {term.name: Price(term.scale, 0.0) for term in REWARD_TERMS}
        if not isinstance(changes or {}, Mapping):
            raise ValueError(f"reward = {changes!r} must be a mapping of terms to weights or prices, or a function")
        for name, change in (*version.prices.items(), *(changes or {}).items()):
            check_name("the term of the reward", name, self.prices)
            given = vars(change) if isinstance(change, Price) else change
            try:
                given = given if isinstance(given, Mapping) else {"weight": given}
                self.prices[name] = changed("the entry", self.prices[name], given)
            except ValueError as error:
                raise ValueError(f"reward[{name!r}]: {error}") from error
        charged = [term for term in REWARD_TERMS if self.prices[term.name].weight > 0.0]
        self.names, self.rows = tuple(term.name for term in charged), self._rows(charged)
        missed = self.prices["missed_deadline"]
        cost = missed.weight * min(1.0 / missed.scale, missed.bound)
        others = sum(price.greatest for name, price in self.prices.items() if name not in _MISSED_TOO)
        if cost <= others:
            raise ValueError(
                f"missed_deadline costs {cost!r}, which must exceed the {others!r} that all other terms can cost "
                "together, or not deploying would pay: raise its weight, lower the others' weights or bounds, or give "
                "a function"
            )

    def _rows(self, terms: Iterable[RewardTerm]) -> NDArray[np.void]:
        rows = [(term.code, term.growth, term.sign, *self.prices[term.name].row) for term in terms]
        return np.array(rows, dtype=price_type)

    def told(self, time: float, account: NDArray[np.float64]) -> Told:
        """Map "time_s" to `time` [s], and each term's name to its quantity so far, column 0 of `account` (terms, 2)."""
        figures = dict(zip((term.name for term in REWARD_TERMS), account[:, FIGURE].tolist(), strict=True))
        return Quantities(figures, time_s=time)

    def own(self, before: Told, after: Told) -> float:
        """Return the user's reward for the quantities `before` and `after` a step; ValueError if it is not finite."""
        assert self.function is not None
        value: Any = plain(self.function(before, after))
        if not is_number(value) or not math.isfinite(value):
            raise ValueError(
                f"the function of the reward returned {value!r} at {after['time_s']:g} s: return a finite number"
            )
        return float(value)


_OF_V1 = Reward(version=VERSIONS["v1"]).prices


def v1_return(figures: Mapping[str, Any]) -> float:
    """Compute the return of a deployment by the rewards of task version 1, from its results `info["deployment"]`.

    A missed deadline costs 25. The further cost of up to 25 by the joints' mean distance to the lock is omitted.
    """
    late = not figures["latched"] or max(figures["latch_times_s"]) > VERSIONS["v1"].task.deadline
    force, work = sum(figures["peak_postlock_force_N"]), sum(figures["sliding_work_J"])
    read = {"peak_impact": force, "wear": work, "missed_deadline": float(late)}
    return -sum(p.weight * min(read[name] / p.scale, p.bound) for name, p in _OF_V1.items() if p.weight > 0.0)


@kernel
def distance_to_lock(model, state):
    """Return the mean over all joints of (distance to the lock) / (lock angle), counted as 0 beyond the lock."""
    total = 0.0
    for j in range(state.joints.size):
        total += max(1.0 - view_joint_of(model)(model, state, j).angle / model.joints[j].lock_angle, 0.0)
    return total / state.joints.size


@kernel
def reading(code, model, state, task):
    """Return the present value of the quantity with this code (`RewardTerm.code`), in its unit."""
    latched = state.clock[0].latched_joints > 0
    if code == MISSED_DEADLINE:
        return 1.0 + distance_to_lock(model, state) if missed_deadline(state, task) else 0.0
    if code == ATTITUDE_DISTURBANCE:
        return view_joint_of(model)(model, state, 0).inboard_spin
    total = 0.0
    if code == MOTOR_WORK:
        for k in range(task.motors.size):
            total += state.integrals[m.INTEGRALS_PER_JOINT * task.motors[k].joint + m.MOTOR_WORK]
        return total
    if code in (TIME, LATENESS):
        latched_at = last_latch(state.joints)
        time = latched_at if latched_at == latched_at else state.clock[0].time
        return time if code == TIME else max(time - (task.deadline - task.control_period), 0.0)
    if code == OPENING:
        return 1.0 - distance_to_lock(model, state)
    for j in range(state.joints.size):
        joint, work = state.joints[j], state.integrals[m.INTEGRALS_PER_JOINT * j + m.SLIDING_WORK]
        if code == PEAK_IMPACT and latched:
            total += joint.postlock_peak_force
        if code == PRELATCH_PEAK:
            total += joint.lock_peak_force if latched else joint.peak_force
        if code == SLIDING_WORK:
            total += work
        if code == POSTLOCK_SLIDING_WORK and latched:
            total += work - joint.lock_sliding_work
    return total


@kernel
def cost(price, figure):
    """Return the unweighted cost x = min(figure / price.scale, price.bound), or log10(1 + x) in the form DECADES."""
    x = min(figure / price.scale, price.bound)
    return x if price.form == LINEAR else math.log10(1.0 + x)


@kernel
def charge(model, state, task, prices, account, terms):
    """Write the reward terms of a control period to `terms` (terms,), update `account`, and return the terms' sum.

    A term is minus the period's increase in the cost of a physical quantity, such as sliding work. Each record of
    `prices` (terms,) says how a quantity is measured and what it costs. `account` (terms, 2) holds each quantity's
    amount so far in the episode, and the value last read from the state; an episode begins with zeros.
    """
    total = 0.0
    for k in range(prices.size):
        price, before = prices[k], account[k, FIGURE]
        now = reading(price.code, model, state, task)
        figure = now
        if price.growth == GREATEST:
            figure = max(before, abs(now))
        elif price.growth == CHANGES:
            figure = before + abs(now - account[k, READING])
        # In this order, equal costs give exactly 0, however a compiler contracts products and sums.
        terms[k] = price.sign * price.weight * (cost(price, before) - cost(price, figure))
        total += terms[k]
        account[k, FIGURE], account[k, READING] = figure, now
    return total


def reward_table() -> str:
    """Return the Markdown table of reward terms for the environment's documentation."""
    prices, rows = Reward().prices, []
    for term in REWARD_TERMS:
        price = prices[term.name]
        figures = (f"{price.scale:g} {term.unit}", f"{price.weight:g}", f"{price.bound:g}", price.form)
        rows.append((f"`{term.name}`", term.figure, term.phase, *figures))
    return markdown_table(("Term", "Figure", "Charged", "Scale", "Weight", "Bound", "Form"), rows)
