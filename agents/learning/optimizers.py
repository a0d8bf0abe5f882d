"""Optimiser for agents whose actor learns more slowly than their critics."""

from collections.abc import Callable
from typing import Any

from stable_baselines3.common.base_class import BaseAlgorithm
from torch import optim

SHARE = "share"


class SlowedAdam(optim.Adam):
    """Adam whose parameter groups learn at a "share" of their rate.

    Stable-Baselines3 sets one rate for actor and critics, anew before every update. The share is part of the
    optimiser's state, and so of a checkpoint.
    """

    def step(self, closure: Callable[[], float] | None = None) -> Any:
        """Update the parameters once; returns the loss of the closure."""
        rates = [group["lr"] for group in self.param_groups]
        for group in self.param_groups:
            group["lr"] *= group.get(SHARE, 1.0)
        loss = super().step(closure)
        for group, rate in zip(self.param_groups, rates, strict=True):
            group["lr"] = rate
        return loss


def slow_actor(model: BaseAlgorithm, share: float) -> None:
    """Make the actor of a SAC or TD3 model made with `SlowedAdam` learn at a `share` of the critics' rate."""
    policy: Any = model.policy
    for group in policy.actor.optimizer.param_groups:
        group[SHARE] = share
