"""Receding-horizon control by rollouts of the simulator itself, a reference that no drive could run."""

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
        knots: Number of values of the residual action, at equal distances from now to the deadline.
        candidates: Number of rollouts of an iteration.
        elites: Number of the best of them, to which the next iteration's distribution is fitted.
        iterations: Number of iterations of the cross-entropy method at every replanning.
        replan_every: Control periods from one replanning to the next.
        initial_deviation: Standard deviation of the knots in the first iteration, in units of the action.
        least_deviation: Bound below which it does not shrink.
    """

    knots: int = 8
    candidates: int = 24
    elites: int = 6
    iterations: int = 2
    replan_every: int = 40
    initial_deviation: float = 0.01
    least_deviation: float = 0.001


@dataclass(frozen=True)
class PredictedEpisode:
    """Actions to the end of an episode, and what they are predicted to earn."""

    start: int  # control period in which it begins
    actions: np.ndarray  # (periods,) float32, from `start` to the end of the episode
    rewards: np.ndarray  # (periods,) of these actions
    knot_times: np.ndarray  # (knots,) of the residual's values [s]
    residual: np.ndarray  # (knots,) action on top of that of the base
    predicted_return: float  # sum of the rewards; -inf where there is no plan yet


class RecedingHorizon(DeterministicController):
    """Actions found by search over rollouts of the simulator from its present state.

    Its return can be reached by a controller with foresight; it is no upper bound of the return.

    Candidates are actions linear over time on top of those of a base, a law or a policy, to the end of the episode, for
    the cost comes with latching and after it. They are searched by the cross-entropy method (R. Y. Rubinstein,
    Methodol. Comput. Appl. Probab. 1 (1999) 127-190, doi:10.1023/A:1010091220143), anew every `replan_every` periods,
    around the last plan. The rollouts start from the exact state, with the true parameters, the true motor, and the
    noise of the sensors that is to come.

    The actions of the best rollout are applied: the simulator is deterministic, so that its return is reached. A plan
    is replaced only by a better one: the predicted return never falls, and is never below that of the base.

    Args:
        env: Environment of this project, not a vector; `act` must be asked in every period of its episodes, and
            the answers be taken as they are.
        base: Controller without a memory.
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

        Only the shape of `observation`, (n_obs,) or (1, n_obs), is used. The environment's clock shows a new episode.

        Raises:
            gymnasium.error.ResetNeeded: Before the environment's first reset.
        """
        period = round(self._env.simulation.time / self._env.task.control_period)
        if period == 0 or not self.predicted_returns:
            self._begin(period)
        if period >= self._next_replanning:
            self._replan(period)
        action = self._plan.actions[period - self._plan.start]
        return np.full((1,) * np.ndim(observation), action)

    def _begin(self, period: int) -> None:
        """Discard the plan of the last episode."""
        self._generator = np.random.default_rng(self._seed)
        nothing = np.zeros(0, dtype=np.float32), np.zeros(0), np.zeros(1), np.zeros(1)
        self._plan = PredictedEpisode(period, *nothing, predicted_return=-math.inf)
        self._next_replanning = period
        self.predicted_returns = []

    def _replan(self, period: int) -> None:
        """Search from the present state, around the plan so far, for a better one."""
        settings, task, plan = self._settings, self._env.task, self._plan
        done = period - plan.start
        now = self._env.simulation.time
        knot_times = np.linspace(now, max(task.deadline, now + task.control_period), settings.knots)
        mean = np.interp(knot_times, plan.knot_times, plan.residual)
        deviation = np.full(settings.knots, settings.initial_deviation)
        for iteration in range(settings.iterations):
            residuals = self._generator.normal(mean, deviation, (settings.candidates, settings.knots))
            residuals[0] = mean
            if iteration == 0:
                residuals[1] = 0.0
            actions, rewards = self._roll_out(knot_times, residuals)
            ranking = np.argsort(-rewards.sum(axis=1), kind="stable")
            best = ranking[0]
            foreseen = np.concatenate([plan.rewards[:done], rewards[best]])
            if foreseen.sum() > self._plan.predicted_return:
                acted = np.concatenate([plan.actions[:done], actions[best]])
                self._plan = PredictedEpisode(
                    plan.start, acted, foreseen, knot_times, residuals[best], float(foreseen.sum())
                )
            elites = residuals[ranking[: settings.elites]]
            mean = elites.mean(axis=0)
            deviation = np.maximum(elites.std(axis=0), settings.least_deviation)
        self._next_replanning = period + settings.replan_every
        self.predicted_returns.append(self._plan.predicted_return)

    def _roll_out(self, knot_times: np.ndarray, residuals: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Actions, float32, and rewards (n, periods) from now to the end, under residuals (n, knots).

        After the end of an episode that is shorter than others there are zeros.
        """
        task, count = self._env.task, len(residuals)
        times = np.arange(knot_times[0], task.deadline + task.postlock_window, task.control_period)
        offsets = np.array([np.interp(times, knot_times, row) for row in residuals])
        actions, rewards = np.zeros(offsets.shape, dtype=np.float32), np.zeros(offsets.shape)
        lanes, k = np.arange(count), 0
        with closing(self._env.futures(count)) as futures:
            while lanes.size:
                base, _ = self._base.predict(futures.observations)
                actions[lanes, k] = np.clip(base[lanes, 0] + offsets[lanes, k], -1.0, 1.0)
                # Rounded to float32, as the environment will get them.
                futures.step(lanes, actions[:, [k]].astype(np.float64))
                rewards[lanes, k] = futures.rewards[lanes]
                lanes = lanes[~futures.terminated[lanes]]
                k += 1
        return actions[:, :k], rewards[:, :k]
