"""The search over futures that are known in closed form: a motor that is paid for being near a wanted action."""

from types import SimpleNamespace

import numpy as np
import pytest

from agents.comparison.receding_horizon import RecedingHorizon, SearchSettings

PERIOD, DEADLINE, AFTER = 0.1, 1.0, 0.4
BASE = 0.2  # the base law's action


class Futures:
    """Lanes that all end together, or one after the other."""

    def __init__(self, world, count):
        self.world, self.period = world, world.period
        self.actions = []
        self.observations, self.rewards = np.zeros((count, 1)), np.zeros(count)
        self.terminated = np.zeros(count, dtype=bool)

    def step(self, lanes, actions):
        actions = actions[:, 0]  # of the one motor
        assert not self.terminated[lanes].any(), "an episode that has ended goes on"
        self.actions.append(np.where(np.isin(np.arange(len(actions)), lanes), actions, np.nan))
        self.rewards[lanes] = -((actions[lanes] - self.world.wanted) ** 2)
        self.period += 1
        self.terminated = self.period >= self.world.lengths(len(actions))

    def close(self):
        self.world.tried.append(np.array(self.actions).T)


class World:
    """An environment as the search sees it, which remembers all actions that were tried."""

    def __init__(self, wanted=0.6, lengths=lambda count: np.full(count, 14)):
        self.unwrapped, self.wanted, self.lengths = self, wanted, lengths
        self.task = SimpleNamespace(control_period=PERIOD, deadline=DEADLINE, settling_window=AFTER, overtime=0.0)
        self.period, self.tried = 0, []

    @property
    def simulation(self):
        return SimpleNamespace(time=self.period * PERIOD)

    def futures(self, count):
        return Futures(self, count)


def search(world, **settings):
    base = SimpleNamespace(predict=lambda observations: (np.full((len(observations), 1), BASE, np.float32), None))
    return RecedingHorizon(world, base, SearchSettings(**settings))


def play(world, controller, periods=14):
    """The actions of an episode."""
    actions = []
    for world.period in range(periods):
        actions.append(controller.act(np.zeros(1))[0])
    return np.array(actions)


def returns(world, tried):
    return -np.nansum((tried - world.wanted) ** 2, axis=1)


def test_the_base_law_alone_is_among_the_first_candidates_and_others_are_linear_between_their_knots():
    world = World()
    search(world, knots=3, iterations=1).act(np.zeros(1))
    (tried,) = world.tried
    assert tried.shape == (24, 14)
    # The plan so far, which is none, and the base law.
    np.testing.assert_array_equal(tried[:2], np.float32(BASE))
    bends = np.abs(np.diff(tried[2:], 2, axis=1)) > 1e-6
    # Knots at the start, at 0.5 s and at the deadline; constant from there on.
    assert np.flatnonzero(bends.any(axis=0)).tolist() == [4, 9]
    np.testing.assert_allclose(np.diff(tried[:, 10:]), 0.0, atol=1e-7)


def test_later_candidates_are_spread_about_the_best_of_the_earlier_ones_as_these_are_spread():
    world = World()
    search(world, knots=2, iterations=2, candidates=4000, elites=500, initial_deviation=0.2).act(np.zeros(1))
    first, second = (tried[:, [0, 10]] for tried in world.tried)
    assert first[2:].mean(axis=0) == pytest.approx([BASE, BASE], abs=0.02)
    assert first[2:].std(axis=0) == pytest.approx([0.2] * 2, rel=0.05)
    best = first[np.argsort(-returns(world, world.tried[0]))[:500]]
    assert second[1:].mean(axis=0) == pytest.approx(best.mean(axis=0), abs=0.01)
    assert second[1:].std(axis=0) == pytest.approx(best.std(axis=0), rel=0.1)
    np.testing.assert_allclose(second[0], best.mean(axis=0), rtol=1e-6)


def test_the_best_of_all_that_was_tried_is_played_and_earns_what_was_predicted():
    world = World()
    controller = search(world, knots=4, replan_after=5 * PERIOD)
    actions = play(world, controller)
    assert controller.predicted_returns[-1] == pytest.approx(returns(world, actions[None])[0], rel=1e-6)
    assert len(world.tried) == 2 * 3
    first = np.concatenate(world.tried[:2])
    best = first[returns(world, first).argmax()]
    np.testing.assert_array_equal(actions[:5], best[:5].astype(np.float32))
    assert controller.predicted_returns[0] == pytest.approx(returns(world, best[None])[0], rel=1e-6)
    assert np.all(np.diff(controller.predicted_returns) >= 0.0)
    assert controller.predicted_returns[0] > returns(world, np.full((1, 14), BASE))[0]
    # Later ones have fewer periods before them.
    assert [tried.shape[1] for tried in world.tried] == [14, 14, 9, 9, 4, 4]


def test_a_search_goes_on_from_the_plan_that_it_has():
    world = World()
    controller = search(world, knots=2, replan_after=4 * PERIOD, iterations=1)
    play(world, controller, 5)
    first, second = world.tried
    best = first[returns(world, first).argmax()]
    # A plan of two knots is a line to the deadline, and so is the rest of it.
    np.testing.assert_allclose(second[0], best[4:], rtol=1e-6)
    np.testing.assert_array_equal(second[1], np.float32(BASE))


def test_where_nothing_beats_the_base_law_it_is_played():
    world = World(wanted=BASE)
    controller = search(world, replan_after=3 * PERIOD)
    assert play(world, controller) == pytest.approx(BASE, abs=1e-7)
    assert controller.predicted_returns == pytest.approx([0.0] * 5, abs=1e-12)


def test_futures_that_end_early_earn_nothing_more():
    world = World(lengths=lambda count: np.where(np.arange(count) == 3, 2, 14))
    controller = search(world, iterations=1, candidates=6, elites=2)
    controller.act(np.zeros(1))
    assert np.isnan(world.tried[0][3, 2:]).all()
    assert np.isfinite(np.delete(world.tried[0], 3, axis=0)).all()
    assert controller.predicted_returns[0] == pytest.approx(returns(world, world.tried[0]).max(), rel=1e-6)


def test_an_episode_begins_anew_and_repeats_itself():
    world = World()
    controller = search(world)
    first = play(world, controller)
    np.testing.assert_array_equal(play(world, controller), first)
    assert len(controller.predicted_returns) == 1
    assert len(world.tried) == 4, "each episode is searched"
