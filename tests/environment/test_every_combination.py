"""Whatever is combined, in whatever order: a lane is the single environment, and a refused call changes nothing.

Every lane of a vector has a single environment beside it, which a wrapper records. The suite tries a few sequences of
calls, the same ones every time; thousands, for an hour, with `--hypothesis-profile night`.
"""

from __future__ import annotations

import contextlib
import copy
import pickle
import warnings

import gymnasium
import numpy as np
import pytest
from episodes import RANGES, STRONG, assert_same
from gymnasium.vector import AutoresetMode
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, precondition, rule

from solar_env import ArrayParameters, Hardware
from solar_env.environment.registration import DEPLOY
from solar_env.environment.showing.recording import RecordTrajectory
from solar_env.mechanics.running.errors import SimulationError

STEP = 0.05  # s, between recorded samples
NOISY = {"angle_noise": 1e-3, "rate_noise": 1e-3, "sensor_delay": 2, "encoder_resolution": 1e-3, "motor_lag": 0.2}


def force_alone(before, after):
    return before["peak_impact"] - after["peak_impact"]


# What a keyword may be, beside being left out.
SURFACE = {
    "version": ("v1", "v2"),
    "torque_limit": (0.2, 5.0),
    "control_period": (0.1, 0.25),
    "deadline": (1.0, 3.0),
    "settling_window": (0.5, 1.0),
    "driven_joint": (0, 1, (1, 0)),
    "action": ("torque", "log_rate"),
    "observation": ("drive", "history", "privileged", ["theta", "rate_2_ago", "latched"]),
    "reward": ({"wear": 0.0}, {"motor_work": 0.05}, force_alone),
    "scenario": ("nominal", "randomised"),
    "randomize": ({}, RANGES, {"body_mass": (900.0, 1600.0), "initial_rate": (0.0, (0.01, 0.02))}),
    "hardware": ({"sensor_delay": 1}, NOISY, Hardware(load_compensation=True, rate_loop_frequency=20.0)),
    "max_steps": (150,),
    "render_mode": ("rgb_array",),
}
KEYWORDS = st.fixed_dictionaries(
    {"model": st.sampled_from(("rigid-ideal", "rigid-clearance"))},
    optional={name: st.sampled_from(values) for name, values in SURFACE.items()},
)
DESIGNS = (
    STRONG,
    {**STRONG, "body_mass": 900.0, "friction_coefficient": 0.0},
    {"spring_stiffness": 5.0, "clearance": (1e-4, 3e-4)},
    ArrayParameters(spring_stiffness=3.0, restitution=0.95),
    {**STRONG, "hinge_damping": (0.1, 0.02), "hinge_friction_torque": 0.01, "panel_length": (0.4, 1.2)},
    {**STRONG, "latching": (1, 0), "release_time": (0.0, 0.15), "spring_torque": ((0.0, 1.0), (3.2, 0.5))},
)
REFUSED = (
    lambda env, shape: env.reset(options={"parameters": {"clearance": -1.0}}),
    lambda env, shape: env.reset(options={"parameters": {"panel_count": 3}}),
    lambda env, shape: env.reset(options={"friction": 1.0}),
    # Refused by what is drawn beside it, or by what is not.
    lambda env, shape: env.reset(options={"parameters": {"journal_radius": 1.5e-4, "friction_speed_zero": 1.0}}),
    lambda env, shape: env.reset(seed=-1),
    lambda env, shape: env.reset(seed=[5] * (len(shape) - 1) + [-1]),
    lambda env, shape: env.step(np.full(shape, np.nan)),
    lambda env, shape: env.step(np.zeros((*shape, 2))),
)


class Combined(RuleBasedStateMachine):
    """A vector, and a recorded single environment for each of its lanes."""

    @initialize(
        given=KEYWORDS,
        designs=st.lists(st.sampled_from(DESIGNS), min_size=1, max_size=3),
        mode=st.sampled_from(list(AutoresetMode)),
        longest=st.sampled_from((None, 1, 4)),
        seed=st.integers(0, 2**31),
    )
    def make(self, given, designs, mode, longest, seed):
        self.designs, self.mode, self.longest, self.saved = designs, mode, longest, []
        lanes = range(len(designs))
        self.vector = gymnasium.make_vec(
            DEPLOY, len(designs), parameters=designs, autoreset_mode=mode, max_episode_steps=longest, **given
        ).unwrapped
        self.singles = [
            RecordTrajectory(gymnasium.make(DEPLOY, parameters=designs[i], **given).unwrapped, STEP) for i in lanes
        ]
        self.shares = np.array([1.0, -0.7])[: self.vector.single_action_space.shape[0]]  # of an action, by motor
        self.elapsed, self.ended = [0 for _ in lanes], [False for _ in lanes]
        self.seen = [None for _ in lanes]
        self.reset(seed)

    def fold(self, lane, seed=None):
        """Reset the single environment of a lane."""
        self.elapsed[lane], self.ended[lane] = 0, False
        self.seen[lane] = self.singles[lane].reset(seed=seed)[0]

    @rule(seed=st.none() | st.integers(0, 2**31), mask=st.lists(st.booleans(), min_size=3, max_size=3))
    def reset(self, seed, mask=(True, True, True)):
        chosen = [lane for lane in range(len(self.singles)) if mask[lane]] or [0]
        if any(seen is None for seen in self.seen):
            chosen = list(range(len(self.singles)))
        flags = np.isin(np.arange(len(self.singles)), chosen)
        observations, _ = self.vector.reset(seed=seed, options={"reset_mask": flags})
        for lane in chosen:
            self.fold(lane, None if seed is None else seed + lane)
        assert_same(observations, np.array(self.seen))

    @precondition(lambda self: not (self.mode is AutoresetMode.DISABLED and any(self.ended)))
    @rule(actions=st.lists(st.sampled_from((-1.0, -0.3, 0.0, 0.9)), min_size=3, max_size=3))
    def step(self, actions):
        given = np.outer(actions[: len(self.singles)], self.shares).astype(np.float32)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            observations, rewards, terminations, truncations, infos = self.vector.step(given)
        final = {}
        for lane, single in enumerate(self.singles):
            if self.ended[lane]:
                self.fold(lane)
                assert (rewards[lane], terminations[lane], truncations[lane]) == (0.0, False, False)
                continue
            self.elapsed[lane] += 1
            over = self.longest is not None and self.elapsed[lane] >= self.longest
            try:
                with warnings.catch_warnings():
                    warnings.simplefilter("ignore")
                    self.seen[lane], reward, terminated, _, info = single.step(given[lane])
            except SimulationError as error:
                reward, terminated, over, info = 0.0, False, True, {"failure": str(error)}
            assert (rewards[lane], terminations[lane], truncations[lane]) == (reward, terminated, over)
            self.ended[lane] = terminated or over
            final[lane] = self.seen[lane], info
        if self.mode is AutoresetMode.SAME_STEP:
            for lane in np.flatnonzero(self.ended).tolist():
                last, info = final[lane]
                assert_same(infos["final_obs"][lane], last)
                for name in {"deployment", "failure"} & set(info):
                    assert_same(infos["final_info"][name][lane], info[name]) if name == "failure" else None
                self.fold(lane)
        assert_same(observations, np.array(self.seen))

    @precondition(lambda self: not all(self.ended))
    @rule(lane=st.integers(0, 2))
    def save(self, lane):
        lane %= len(self.singles)
        if not self.vector.episodes.terminated[lane] and not self.ended[lane]:
            self.saved.append((lane, self.vector.lane(lane).save_episode(), pickle.dumps(self.singles[lane])))

    @precondition(lambda self: self.saved and self.mode is not AutoresetMode.SAME_STEP)
    @rule(which=st.integers(0, 99), into=st.integers(0, 2))
    def restore(self, which, into):
        lane, saved, single = self.saved[which % len(self.saved)]
        into %= len(self.singles)
        if self.designs[into] is not self.designs[lane]:
            into = lane
        observed = self.vector.lane(into).restore_episode(saved)
        self.singles[into] = pickle.loads(single)
        unwrapped = self.singles[into].unwrapped
        self.seen[into], self.ended[into] = unwrapped._episodes.observations[0].copy(), False
        self.elapsed[into] = round(unwrapped.simulation.time / unwrapped.task.control_period)
        assert_same(observed, self.seen[into])

    @rule(lane=st.integers(0, 2), action=st.sampled_from((-1.0, 0.5)))
    def try_futures(self, lane, action):
        single = self.singles[lane % len(self.singles)]
        if self.ended[lane % len(self.singles)]:
            return
        clone, futures = pickle.loads(pickle.dumps(single)), single.unwrapped.futures(2)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            failures = futures.attempt(np.arange(2), np.outer([action, 0.0], self.shares))
            try:
                observed, reward, terminated, *_ = clone.step(action * self.shares)
            except SimulationError:
                assert 0 in failures
                return
        assert_same(futures.observations[0].copy(), observed)
        assert (futures.rewards[0], futures.terminated[0]) == (reward, terminated)

    @rule(lane=st.integers(0, 2), torque=st.sampled_from((-0.5, 0.5)))
    def try_a_future_and_give_it_up(self, lane, torque):
        simulation = self.singles[lane % len(self.singles)].unwrapped.simulation
        before = simulation.snapshot()
        simulation.set_motor_torque(0, torque)
        with warnings.catch_warnings(), contextlib.suppress(SimulationError):
            warnings.simplefilter("ignore")
            simulation.advance(simulation.time + 0.3)
        simulation.restore(before)

    @rule(call=st.sampled_from(REFUSED), single=st.booleans())
    def refuse(self, call, single):
        env = self.singles[0] if single else self.vector
        shape = self.shares.shape if single else (len(self.singles), self.shares.size)
        times, before = self.vector.episodes.times, pickle.dumps(env.unwrapped.np_random)
        with pytest.raises((ValueError, TypeError, gymnasium.error.Error)):
            call(env, shape)
        assert_same(self.vector.episodes.times, times)
        assert pickle.dumps(env.unwrapped.np_random) == before

    @rule(by=st.sampled_from((copy.deepcopy, lambda env: pickle.loads(pickle.dumps(env)))))
    def go_on_with_copies(self, by):
        self.vector, self.singles = by(self.vector), [by(single) for single in self.singles]

    @precondition(lambda self: self.vector.render_mode)
    @rule()
    def render(self):
        frames = self.vector.render()
        assert frames[0].shape == (540, 960, 3)

    @rule()
    def look_at_what_was_recorded(self):
        for single in self.singles:
            env = single.unwrapped
            if env.simulation.time == 0.0:
                continue
            trajectory = single.trajectory
            assert len(trajectory.time) == int(np.ceil(env.simulation.time / STEP - 1e-9)) + 1
            assert trajectory.time[-1] == env.simulation.time
            contacts, begun = trajectory.contacts, env.simulation.state.joints["contact_starts"].sum()
            assert len(contacts) == trajectory.contact_starts.sum() == begun
            assert not (contacts["start_s"] > env.simulation.time).any()

    @invariant()
    def lanes_are_where_their_single_environments_are(self):
        for lane, single in enumerate(self.singles):
            env = single.unwrapped
            assert self.vector.episodes.times[lane] == env.simulation.time
            assert self.vector.lane(lane).episode_parameters == env.episode_parameters
            assert self.vector.np_random[lane].bit_generator.state == env.np_random.bit_generator.state


Combined.TestCase.settings = settings(stateful_step_count=25, max_examples=4 * settings.default.max_examples)


class TestEveryCombination(Combined.TestCase):
    """The machine above, as pytest finds it."""
