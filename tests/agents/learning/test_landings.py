"""Training on landings: they are exactly those of the law, and the law itself earns nothing in them."""

import numpy as np
import pytest

from agents.learning import configurations, learn
from agents.learning.features import APPROACH_BEGINS
from agents.learning.landings import LandingVecEnv, record
from agents.learning.vec_env import LAW_REWARD, FixedSeeds, NativeVecEnv, ResidualVecEnv

ENV_IDS = ("solar_env/Deploy-v1", "solar_env/DeployRandomised-v1")
LANES = 3


def prepared(env_id, count=4, seed=0):
    config = configurations.complete("ppo", env_id, {}, seed, n_envs=LANES, residual=0.2, landings=count)
    return config, learn.prepare(config)[1]


@pytest.mark.parametrize("env_id", ENV_IDS)
def test_the_law_alone_earns_nothing_and_its_landings_are_those_recorded_to_the_bit(env_id):
    config, landings = prepared(env_id)
    venv = learn.make_training_env(config, landings, None)
    venv.seed(7)
    venv.reset()
    nothing = np.zeros((LANES, 1), dtype=np.float32)
    of_law, costs, returns = np.zeros(LANES), [], []
    while len(returns) < 2 * len(landings):
        _, rewards, dones, infos = venv.step(nothing)
        assert not rewards.any()
        of_law += [info[LAW_REWARD] for info in infos]
        costs += of_law[dones].tolist()
        returns += [infos[lane]["episode"]["r"] for lane in np.flatnonzero(dones)]
        of_law[dones] = 0.0
    assert returns == pytest.approx(costs, rel=1e-6)
    assert len({round(cost, 9) for cost in costs}) == len(landings)
    assert max(costs) < 0.0


@pytest.mark.parametrize("env_id", ENV_IDS)
def test_a_recorded_landing_ends_as_the_whole_episode_of_its_seed_does_after_the_same_opening(env_id):
    config, landings = prepared(env_id, count=2)
    first = learn.episode_seeds("training", 0, learn.EPISODES_PER_SEED)[-2]
    whole = ResidualVecEnv(FixedSeeds(NativeVecEnv(2, env_id, config.env_kwargs), first), config.residual)
    opening = whole.get_attr("observation_names", 0)[0].index("theta_1")
    near = whole.reset()[:, opening] >= APPROACH_BEGINS
    costs, returns = np.zeros(2), [None, None]
    while None in returns:
        observations, rewards, dones, _ = whole.step(np.zeros((2, 1), dtype=np.float32))
        costs += np.where(near, rewards, 0.0)
        near |= observations[:, opening] >= APPROACH_BEGINS
        for lane in np.flatnonzero(dones):
            returns[lane] = costs[lane] if returns[lane] is None else returns[lane]
    assert [landing.rewards.sum() for landing in landings] == pytest.approx(returns, rel=1e-6)


def test_a_landing_begins_where_the_law_has_come_near_the_latches():
    config, landings = prepared(ENV_IDS[0])
    venv = LandingVecEnv(LANES, config.env_id, config.env_kwargs, landings)
    opening = venv.reset()[:, venv.get_attr("observation_names", 0)[0].index("theta_1")]
    assert np.all(opening >= APPROACH_BEGINS)
    assert np.all(opening < APPROACH_BEGINS + 0.02)


def test_agents_that_add_more_or_less_to_the_same_law_have_their_landings_in_common():
    config, landings = prepared(ENV_IDS[0])
    more = configurations.complete("sac", config.env_id, {}, 0, residual=0.4, landings=len(landings))
    other_seed = configurations.complete("ppo", config.env_id, {}, 1, residual=0.2, landings=len(landings))
    assert learn.prepare(more)[1] is landings
    assert learn.prepare(other_seed)[1] is not landings


def test_every_landing_comes_before_any_comes_again_in_an_order_that_follows_from_the_seed():
    config, landings = prepared(ENV_IDS[0], count=6)
    number = {landing.episode.parameters.initial_rate: k for k, landing in enumerate(landings)}

    def order(seed):
        venv = LandingVecEnv(LANES, config.env_id, config.env_kwargs, landings)
        venv.seed(seed)
        seen = []
        for _ in range(4):
            venv.reset()
            seen += [number[parameters.initial_rate] for parameters in venv.get_attr("episode_parameters")]
        return seen

    assert sorted(order(1)[:6]) == sorted(order(1)[6:]) == list(range(6))
    assert order(1) == order(1) != order(2)


@pytest.mark.parametrize("action", [0.5, -0.5], ids=["earlier", "later"])
def test_what_the_law_was_charged_is_given_back_whenever_the_episode_ends(action):
    config, landings = prepared(ENV_IDS[1], count=LANES)
    lanes = LandingVecEnv(LANES, config.env_id, config.env_kwargs, landings)
    venv = ResidualVecEnv(lanes, config.residual)
    venv.seed(0)
    venv.reset()
    lane_of = {parameters: lane for lane, parameters in enumerate(venv.get_attr("episode_parameters"))}
    by_lane = {lane_of[landing.episode.parameters]: landing.rewards for landing in landings}
    given, periods, over = np.zeros(LANES), 0, np.zeros(LANES, dtype=bool)
    lengths = np.array([len(by_lane[lane]) for lane in range(LANES)])
    while not over.all():
        _, _, dones, infos = venv.step(np.full((LANES, 1), action, dtype=np.float32))
        given += np.where(over, 0.0, [info[LAW_REWARD] for info in infos])
        periods += 1
        lengths[dones & ~over] -= periods
        over |= dones
    assert given == pytest.approx([by_lane[lane].sum() for lane in range(LANES)], rel=1e-5)
    assert np.all(np.sign(lengths) == np.sign(action))


def test_a_law_that_does_not_come_near_the_latches_is_refused():
    keywords = {"deadline": 0.5}
    lanes = NativeVecEnv(1, ENV_IDS[0], keywords)
    with pytest.raises(ValueError, match="does not bring the array near the latches; tune it first"):
        record(lanes)


def test_episodes_that_the_law_does_not_bring_near_the_latches_are_left_out_with_a_warning():
    soft, stiff = (0.05, 0.0375), (0.1, 0.075)
    keywords = {"model": "rigid-ideal", "deadline": 12.5, "randomize": {"spring_stiffness": (soft, stiff)}}
    lanes = NativeVecEnv(6, ENV_IDS[0], keywords)
    lanes.seed(0)
    with pytest.warns(UserWarning, match=r"near the latches in \d of 6 episodes; the agent trains on these alone"):
        found, _ = record(lanes)
    assert 0 < len(found) < 6
