"""Sensitivity of an ensemble's quantities to the parameters.

If the parameter file gives ranges, the quantities of the ensemble members are regressed on the members' sampled
parameters. The standardised coefficients follow A. Saltelli et al., "Global Sensitivity Analysis: The Primer" (2008),
section 1.2.5, doi:10.1002/9780470725184. Otherwise each parameter is shifted by a tenth, one at a time.
"""

import contextlib
import math
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from solar_env.array import ArrayParameters, build
from solar_env.array.parameters.ranges import Ranges
from solar_env.mechanics.running.diagnosis import SimulationWarning

Array = NDArray[np.float64]
Shift = tuple[str, float]  # a parameter and its factor
Result = Mapping[str, Any]  # result of a run: its quantities, or its failure

# Constants that only smooth force laws; designers do not choose these.
OF_THE_LAWS = (
    "latch_exponent",
    "latch_ramp_depth",
    "minimum_impact_speed",
    "friction_speed_zero",
    "friction_speed_full",
)
SHARE = 0.1  # fraction of a parameter by which it is shifted
_CONFIDENCE = 0.95
_LEAST = 0.01  # least standardised coefficient that is reported


@dataclass(frozen=True)
class Effects:
    """Effects of parameters on one quantity of one joint, or of the hub.

    Attributes:
        low, high: a number for each parameter. After a regression: low and high end of the 95 % interval of the
            parameter's standardised coefficient. After shifts of one parameter at a time: the quantity's relative
            change when the parameter is lowered (`low`) or raised (`high`) by the fraction SHARE; nan if that run was
            refused, failed or did not latch.
        noise: relative change that slight perturbations of release and tolerance may cause (95 %); 0 for a regression.
        explained: fraction of variance that a regression explains, adjusted for the number of parameters; else nan.
    """

    low: Mapping[str, float]
    high: Mapping[str, float]
    noise: float
    explained: float = np.nan

    def one_sided(self, parameter: str) -> bool:
        """Return whether lowering and raising a parameter change the quantity in one direction, both beyond noise."""
        low, high = self.low[parameter], self.high[parameter]
        return not np.isfinite(self.explained) and low * high > 0.0 and min(abs(low), abs(high)) > self.noise

    @property
    def ranking(self) -> list[str]:
        """Parameters with effects above the noise, or regression intervals that exclude 0; greatest effect first."""
        size = {name: np.nanmax(np.abs([self.low[name], self.high[name], 0.0])) for name in self.low}
        if np.isfinite(self.explained):
            told = [name for name in size if self.low[name] * self.high[name] > 0.0 and size[name] > _LEAST]
            return sorted(told, key=lambda name: -abs(self.low[name] + self.high[name]))
        return sorted((name for name in size if size[name] > self.noise), key=lambda name: -size[name])


@dataclass(frozen=True)
class Sensitivity:
    """Effects of parameters on each quantity of each joint or the hub; if unknown, empty with a reason in `missing`."""

    drawn: bool  # true for a regression on sampled parameters, false for one at a time
    effects: Mapping[str, tuple[Effects, ...]]
    missing: str = ""  # reason why there are no effects


def shifts(parameters: ArrayParameters, model: str) -> dict[Shift | None, ArrayParameters]:
    """Return the nominal parameters (key None), and sets with one continuous parameter times 1 - SHARE or 1 + SHARE.

    The key of such a set is (parameter, factor). Parameters that are 0, and smoothing constants of force laws
    (OF_THE_LAWS), keep their values. Shifts that are invalid, or change nothing at the level `model`, are left out.
    """
    nominal = build(parameters, model)
    found: dict[Shift | None, ArrayParameters] = {None: parameters}
    for name in ArrayParameters.CONTINUOUS:
        entries = parameters.entries(name)
        if None in entries or not any(entries) or name in OF_THE_LAWS:
            continue
        for factor in (1.0 - SHARE, 1.0 + SHARE):
            shifted = tuple(factor * entry for entry in entries) if len(entries) > 1 else factor * entries[0]
            with contextlib.suppress(ValueError), warnings.catch_warnings():
                warnings.simplefilter("ignore", SimulationWarning)  # warnings about values that are only tried
                changed = parameters.with_changes({name: shifted})
                if build(changed, model) != nominal:
                    found[name, factor] = changed
    return found


def one_at_a_time(runs: Mapping[Shift | None, Result], alike: Mapping[str, Array]) -> Sensitivity:
    """Return a `Sensitivity`: each quantity's relative changes by joint when one parameter at a time is shifted.

    Args:
        runs: Shift (parameter, factor) -> result of the array with this parameter shifted; None -> the nominal array's.
        alike: Quantity -> (members, joints) values of slightly perturbed nominal arrays, whose scatter is the noise.
    """
    nominal = runs[None]
    if "failed" in nominal:
        return Sensitivity(False, {}, "the run of the nominal array failed")
    names = list(dict.fromkeys(shift[0] for shift in runs if shift))
    effects = {}
    for quantity, figures in nominal["quantities"].items():
        base = np.array(figures, dtype=float)
        with np.errstate(invalid="ignore", divide="ignore"):
            changes = {
                shift: np.array(run["quantities"][quantity], dtype=float) / base - 1.0
                for shift, run in runs.items()
                if shift and "failed" not in run
            }
            deviation = (
                alike[quantity].std(axis=0, ddof=1) / np.abs(base) if len(alike[quantity]) > 1 else np.nan * base
            )
        noise = math.sqrt(2.0) * float(stats.norm.ppf(0.5 * (1.0 + _CONFIDENCE))) * deviation
        unknown = np.full(base.shape, np.nan)
        low, high = (
            {name: changes.get((name, factor), unknown) for name in names} for factor in (1.0 - SHARE, 1.0 + SHARE)
        )
        effects[quantity] = tuple(
            Effects(
                {name: float(change[j]) for name, change in low.items()},
                {name: float(change[j]) for name, change in high.items()},
                float(noise[j]),
            )
            for j in range(len(base))
        )
    return Sensitivity(False, effects)


def _drawn(ranges: Ranges) -> list[tuple[str, int | None]]:
    """List the sampled values as (parameter, index of the joint), with None for a parameter that is not by joint."""
    return [
        (name, j if isinstance(low, tuple) else None)
        for name, (low, high) in ranges.items()
        for j in np.flatnonzero(np.subtract(high, low)).tolist()
    ]


def fewest_runs(ranges: Ranges) -> int:
    """Return the least number of runs from which a regression finds the effects of all values sampled from `ranges`."""
    return len(_drawn(ranges)) + 3


def regression(ranges: Ranges, members: Sequence[ArrayParameters], values: Mapping[str, Array]) -> Sensitivity:
    """Return a `Sensitivity`: 95 % intervals of standardised coefficients when quantities are regressed on parameters.

    `ranges` are the ranges of the sampled parameters, `members` the parameters of each ensemble member, and `values`
    the (members, joints) values of each quantity, nan where unknown.
    """
    columns = {
        name if j is None else f"{name}, joint {j + 1}": np.array([member.entries(name)[j or 0] for member in members])
        for name, j in _drawn(ranges)
    }
    if len(members) < (fewest := fewest_runs(ranges)):
        reason = f"{len(columns)} values are drawn, whose effects take {fewest} runs or more (--runs)"
        return Sensitivity(True, {}, reason)
    effects = {quantity: tuple(_regressed(columns, y) for y in table.T) for quantity, table in values.items()}
    return Sensitivity(True, effects)


def _regressed(columns: Mapping[str, Array], y: Array) -> Effects:
    """Regress a quantity's (n,) values `y` on parameters, and return `Effects` with the coefficients' 95 % intervals.

    `columns` maps each parameter's name to its (n,) values. Coefficients are standardised; nan in `y` is left out.
    """
    known = np.isfinite(y)
    count, freedom = int(known.sum()), int(known.sum()) - len(columns) - 1
    unknown = dict.fromkeys(columns, np.nan)
    if freedom < 2 or np.ptp(y[known]) == 0.0:
        return Effects(unknown, unknown, 0.0)
    x = np.column_stack([values[known] for values in columns.values()])
    x, z = (x - x.mean(axis=0)) / x.std(axis=0), (y[known] - y[known].mean()) / y[known].std()
    inverse = np.linalg.pinv(x.T @ x)
    coefficients = inverse @ x.T @ z
    variance = float(np.sum((z - x @ coefficients) ** 2)) / freedom
    half = float(stats.t.ppf(0.5 * (1.0 + _CONFIDENCE), freedom)) * np.sqrt(variance * np.diag(inverse))
    explained = 1.0 - variance * (count - 1) / count
    low, high = (dict(zip(columns, (coefficients + sign * half).tolist(), strict=True)) for sign in (-1.0, 1.0))
    return Effects(low, high, 0.0, explained)
