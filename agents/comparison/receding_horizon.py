"""Receding-horizon control by rollouts of the simulator itself, as a reference that no real drive could run."""

import math
from contextlib import closing
from dataclasses import dataclass
from typing import Any

import gymnasium
import numpy as np

from agents.torque_laws import Controller, DeterministicController


@dataclass(frozen=True)
class SearchSettings:
    """Settings of the search of `RecedingHorizon`.

    Attributes:
        knots: Number of corrections to a base controller's action, evenly spaced in time from now to the deadline.
        candidates: Number of rollouts in an iteration.
        elites: Number of the best rollouts, to which the next iteration's distribution is fitted.
        iterations: Number of iterations of the cross-entropy method at every replanning.
        replan_after: Time from one replanning to the next [s], in whole control periods.
        initial_deviation: Standard deviation of the knots in the first iteration, in units of the action.
        least_deviation: Bound below which the deviation does not shrink.
    """

    knots: int = 8
    candidates: int = 24
    elites: int = 6
    iterations: int = 2
    replan_after: float = 4.0
    initial_deviation: float = 0.01
    least_deviation: float = 0.001


class RecedingHorizon(DeterministicController):
    """Controller that searches for its actions by rollouts of the simulator from the present state.

    Its return shows what a controller with perfect foresight can reach, but is no upper bound of all returns.
    A candidate adds a residual, linear between knots, to the actions of a base controller (a law or a policy). Rollouts
    last to the end of the episode, because the cost comes with latching and after it. The cross-entropy method (R. Y.
    Rubinstein, Methodol. Comput. Appl. Probab. 1 (1999) 127-190, doi:10.1023/A:1010091220143) searches around the last
    plan, anew every `settings.replan_after` seconds. Rollouts start from the exact state, with the true parameters, the
    true motor, and the sensors' future noise.

    The actions of the best rollout are applied. The simulator is deterministic: the predicted return is reached. Only a
    better plan replaces a plan: the predicted return never falls, and is never below the base controller's return.

    Args:
        env: Environment of this project, not a vector; `act` must be called in every period of its episodes, and
            the returned actions must be applied unchanged.
        base: Memoryless controller, to whose actions residuals are added.
        settings: Settings of the search.
        seed: Seed of the search, used anew in every episode.

    Attributes:
        predicted_returns: Return of the present episode as predicted at every replanning.
    """

    def __init__(
        self, env: gymnasium.Env, base: Controller, settings: SearchSettings = SearchSettings(), seed: int = 0
    ) -> None:
        self._env: Any = env.unwrapped
        self._base, self._settings, self._seed = base, settings, seed
        self.predicted_returns: list[float] = []

    def act(self, observation: np.ndarray) -> np.ndarray:
        """Return the planned action (1,) or (1, 1) for the present period of the environment.

        Only the shape of `observation`, (n_obs,) or (1, n_obs), is used. The environment's time 0 marks a new episode.

        Raises:
            gymnasium.error.ResetNeeded: Before the environment's first reset.
        """
        period = round(self._env.simulation.time / self._env.task.control_period)
        if period == 0 or not self.predicted_returns:
            self._generator = np.random.default_rng(self._seed)
            self._start = self._next_replanning = period
            # The plan: actions and rewards from `_start` to the end, and the residual at the times of its knots.
            self._actions, self._rewards = np.zeros(0, dtype=np.float32), np.zeros(0)
            self._knot_times, self._residual = np.zeros(1), np.zeros(1)
            self.predicted_returns = []
        if period >= self._next_replanning:
            self._replan(period - self._start)
            self._next_replanning = period + round(self._settings.replan_after / self._env.task.control_period)
        return np.full((1,) * np.ndim(observation), self._actions[period - self._start])

    def _replan(self, done: int) -> None:
        """Search around the present plan, `done` periods into it, for a better plan, and keep the better one."""
        settings, task, now = self._settings, self._env.task, self._env.simulation.time
        knot_times = np.linspace(now, max(task.deadline, now + task.control_period), settings.knots)
        mean = np.interp(knot_times, self._knot_times, self._residual)
        deviation = np.full(settings.knots, settings.initial_deviation)
        predicted = self.predicted_returns[-1] if self.predicted_returns else -math.inf
        acted, earned = self._actions[:done], self._rewards[:done]
        for iteration in range(settings.iterations):
            residuals = self._generator.normal(mean, deviation, (settings.candidates, settings.knots))
            residuals[0] = mean
            if iteration == 0:
                residuals[1] = 0.0
            actions, rewards = self._roll_out(knot_times, residuals)
            ranking = np.argsort(-rewards.sum(axis=1), kind="stable")
            best = ranking[0]
            foreseen = np.concatenate([earned, rewards[best]])
            if foreseen.sum() > predicted:
                predicted = float(foreseen.sum())
                self._actions, self._rewards = np.concatenate([acted, actions[best]]), foreseen
                self._knot_times, self._residual = knot_times, residuals[best]
            elites = residuals[ranking[: settings.elites]]
            mean, deviation = elites.mean(axis=0), np.maximum(elites.std(axis=0), settings.least_deviation)
        self.predicted_returns.append(predicted)

    def _roll_out(self, knot_times: np.ndarray, residuals: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Simulate the episode's rest n times; return actions and rewards (n, periods), zero after an episode's end.

        Rows of `residuals` (n, knots), linear between `knot_times` (knots,) [s], add to the base controller's actions.
        """
        task, count = self._env.task, len(residuals)
        longest = task.deadline * (1.0 + task.overtime) + task.settling_window
        times = np.arange(knot_times[0], longest, task.control_period)
        offsets = np.array([np.interp(times, knot_times, row) for row in residuals])
        actions, rewards = np.zeros(offsets.shape, dtype=np.float32), np.zeros(offsets.shape)
        lanes, k = np.arange(count), 0
        with closing(self._env.futures(count)) as futures:
            while lanes.size:
                base, _ = self._base.predict(futures.observations)
                actions[lanes, k] = np.clip(base[lanes, 0] + offsets[lanes, k], -1.0, 1.0)
                # Actions are rounded to float32, as the environment will get them.
                futures.step(lanes, actions[:, [k]].astype(np.float64))
                rewards[lanes, k] = futures.rewards[lanes]
                lanes = lanes[~futures.terminated[lanes]]
                k += 1
        return actions[:, :k], rewards[:, :k]
