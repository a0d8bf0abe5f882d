"""Episodes begin where approaches have come, at their clocks and charges, and the same seed begins at the same."""

from __future__ import annotations

import gymnasium
import numpy as np
import pytest

from solar_env.environment.starts import Starts

ID = "solar_env/Deploy-v1"
QUICK = {"model": "rigid-ideal", "postlock_window": 1.0}
STARTS = {"opening": (0.5, 0.9), "rate": (0.2, 0.25), "count": 6, "folded": 0.25}


def make(lanes=1, **starts):
    return gymnasium.make_vec(ID, lanes, starts={**STARTS, **starts}, num_threads=1, **QUICK).unwrapped


def openings(env, resets):
    """(resets, lanes) mean openings and (resets, lanes) times of first states."""
    env.reset(seed=0)
    seen, times = [], []
    for _ in range(resets):
        observations, infos = env.reset()
        seen.append(observations[:, :2].mean(axis=1))
        times.append(infos["time_s"])
    return np.array(seen), np.array(times)


def test_starts_are_spread_over_the_openings_asked_for_and_the_share_asked_for_is_folded():
    seen, times = openings(make(lanes=20), 20)
    folded = seen < 0.01
    assert np.mean(folded) == pytest.approx(0.25, abs=0.08)
    assert np.all(times[folded] == 0.0)
    # Beyond by the way of a period at most.
    assert np.all((seen[~folded] >= 0.5) & (seen[~folded] <= 0.9 + 0.1 * 0.25))
    assert np.all(times[~folded] > 1.0)
    assert len(np.unique(seen[~folded])) == 6


def test_an_episode_goes_on_from_where_its_approach_was_to_the_bits_of_an_equal_one_single_and_in_a_vector():
    many, single = make(lanes=3), gymnasium.make(ID, starts=STARTS, **QUICK).unwrapped
    together, alone = many.reset(seed=[4, 5, 4])[0], single.reset(seed=4)[0]
    assert alone.tobytes() == together[0].tobytes() == together[2].tobytes() != together[1].tobytes()
    for action in (0.3, -0.5):
        seen, rewards, *_ = many.step(np.full((3, 1), action, np.float32))
        one, reward, *_ = single.step(np.array([action], np.float32))
        assert one.tobytes() == seen[0].tobytes() == seen[2].tobytes()
        assert reward == rewards[0] == rewards[2]


def test_what_the_approach_has_worn_is_not_charged_to_the_episode():
    env = gymnasium.make(ID, starts={**STARTS, "folded": 0.0}, **{**QUICK, "model": "rigid-clearance"}).unwrapped
    env.reset(seed=0)
    before = env._episodes.figures(0)["sliding_work_J"]
    *_, info = env.step([0.0])
    worn = sum(env._episodes.figures(0)["sliding_work_J"]) - sum(before)
    assert sum(before) > 10.0 * worn > 0.0
    assert info["reward_terms"]["wear"] == pytest.approx(-worn / 0.1, rel=1e-9)


def test_changed_parameters_begin_folded():
    env = make(folded=0.0)
    assert env.reset(seed=0)[1]["time_s"][0] > 0.0
    assert env.reset(options={"parameters": {"friction_coefficient": 0.2}})[1]["time_s"][0] == 0.0


def test_a_curriculum_narrows_the_starts_and_widens_them_again():
    env = make(lanes=20)
    env.reset(seed=0)
    env.narrow_starts(0.75, 0.0)
    assert openings(env, 5)[0].min() >= 0.75
    env.narrow_starts(0.0, 1.0)
    assert openings(env, 5)[0].max() < 0.01


@pytest.mark.parametrize(
    ("starts", "words"),
    [
        ({"openings": (0.1, 0.2)}, ["openings", "opening"]),
        ({"opening": (0.9, 0.8)}, ["opening", "0.9, 0.8", "low, high"]),
        ({"opening": (0.9, 1.2)}, ["opening", "1.2", "0.99"]),
        ({"rate": (0.0, 0.1)}, ["rate", "above 0"]),
        ({"rate": 0.1}, ["rate", "pair"]),
        ({"folded": 1.0}, ["folded", "1.0", "below 1"]),
        ({"count": 0}, ["count", "0", "at least 1"]),
    ],
)
def test_starts_that_cannot_be_are_refused_by_name(starts, words):
    with pytest.raises(ValueError, match="(?s)" + ".*".join(words)):
        gymnasium.make(ID, starts=starts)


def test_starts_take_numbers_of_numpy_as_ranges_do():
    assert Starts(opening=(np.float32(0.5), np.float32(0.75))) == Starts(opening=(0.5, 0.75))


def test_approaches_that_never_come_there_are_refused_with_what_to_do():
    with pytest.raises(ValueError, match=r"no approach comes there before the deadline; ask for faster ones"):
        gymnasium.make(ID, starts={**STARTS, "folded": 0.0}, **{**QUICK, "deadline": 1.0}).reset(seed=0)
