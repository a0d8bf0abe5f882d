"""Starts of episodes on the way: states of approaches at a constant rate, saved between two control periods."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from solar_env.array.names import changed
from solar_env.environment.task.task import SLOWEST, STEEPNESS
from solar_env.support.numbers import is_number, is_whole_number, plain

FASTEST = SLOWEST * math.sinh(STEEPNESS)


@dataclass(frozen=True)
class Starts:
    """Where episodes begin: folded, or on the way to the latches at a constant rate of the driven hinge.

    Attributes:
        opening: least and greatest mean opening at which an episode begins, in units of the lock angles.
        rate: slowest and fastest setpoint of the rate loop that has brought the array there [rad/s].
        folded: share of the episodes that begin folded.
        count: approaches that are run, once, when the first episode begins; each has parameters of its own.

    Raises:
        ValueError: on construction, for a value out of range.
    """

    opening: tuple[float, float] = (0.8, 0.98)
    rate: tuple[float, float] = (0.05, 0.16)
    folded: float = 0.2
    count: int = 96

    def __post_init__(self) -> None:
        for name, greatest in (("opening", 0.99), ("rate", FASTEST)):
            pair: Any = getattr(self, name)
            pairs = isinstance(pair, (tuple, list)) and len(pair) == 2 and all(is_number(plain(end)) for end in pair)
            if not pairs or not 0.0 < pair[0] <= pair[1] <= greatest:
                raise ValueError(f"{name} = {pair!r} must be a pair (low, high) above 0, up to {greatest:.3g}")
        if not 0.0 <= self.folded < 1.0:
            raise ValueError(f"folded = {self.folded!r} must be a share from 0, below 1")
        if not is_whole_number(self.count, 1):
            raise ValueError(f"count = {self.count!r} must be a whole number, at least 1")

    @classmethod
    def of(cls, given: Mapping[str, Any]) -> Self:
        """Starts with some values in place of the defaults.

        Raises:
            ValueError: if a name is unknown or a value is refused.
        """
        return changed("starts", cls(), given)


def run_approaches(episodes: Any, starts: Starts) -> list[tuple[float, Any]]:
    """Run approaches at constant rates: openings at which they were stopped, rising, each with its saved episode.

    Args:
        episodes: `Episodes` with a lane for every approach, actions that are rates, and the observation "drive".
        starts: where to stop them.

    Raises:
        ValueError: if none comes there before the deadline.
    """
    generator, going = np.random.default_rng(0), np.arange(starts.count)
    episodes.reset(going, [generator] * starts.count, [{}] * starts.count)
    wanted = generator.uniform(*starts.opening, starts.count)
    actions = np.arcsinh(generator.uniform(*starts.rate, starts.count) / SLOWEST) / STEEPNESS
    joints = episodes.settings.array.panel_count
    found = []
    while going.size:
        episodes.step(going, actions)
        opening = episodes.observations[:, :joints].mean(axis=1)
        there = opening[going] >= wanted[going]
        found += [(float(opening[lane]), episodes.save(lane)) for lane in going[there]]
        going = going[~there & ~episodes.terminated[going]]
    episodes.close()
    if not found:
        raise ValueError(f"starts = {starts!r}: no approach comes there before the deadline; ask for faster ones")
    return sorted(found, key=lambda start: start[0])
