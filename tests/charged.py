"""Deployments under given torques and what they are charged, for the tests of the reward."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import NamedTuple

import gymnasium
import numpy as np
import pytest

import solar_env
from agents.environments import with_sampling
from agents.laws.feedback import DamperParameters, ViscousDamper
from agents.torque_laws import Signals
from solar_env.array.methods import default_integrator
from solar_env.environment.registration import DEPLOY_V1
from solar_env.environment.task.reward import Reward
from solar_env.environment.task.task import VERSIONS
from solar_env.mechanics.arrays import model as m
from solar_env.mechanics.arrays.columns import ANGLE

SAMPLING = with_sampling({}, DEPLOY_V1)["randomize"]
TASK = VERSIONS["v1"].task
# What costs 1, the most that either of the two can cost, and what a missed deadline costs.
FORCE_SCALE, WORK_SCALE, LARGEST, MISSED = 500.0, 0.1, 12.0, 25.0
WORST_DEPLOYMENT = -2.0 * LARGEST
# The outer joint latches and the root, which the motor works on, is left behind.
SOFT_CABLE = {"cable_stiffness": 0.02}


@dataclass
class ChargedEpisode:
    """One episode: actions, times at the ends of the steps, terms of the reward, and the figures at its end."""

    actions: list[float] = field(default_factory=list)
    times: list[float] = field(default_factory=list)
    terms: list[list[float]] = field(default_factory=list)
    figures: dict = field(default_factory=dict)

    @property
    def total(self):
        return float(np.sum(self.terms))

    @property
    def latched(self):
        return bool(self.figures["latched"])

    @property
    def last_latch(self):
        return max(self.figures["latch_times_s"])

    @property
    def force(self):
        return sum(self.figures["peak_postlock_force_N"])

    @property
    def work(self):
        return sum(self.figures["sliding_work_J"])


def deploy(laws, **keywords):
    """An episode of every law, side by side; a law makes an action of an observation and the number of the step."""
    env = gymnasium.make_vec(DEPLOY_V1, num_envs=len(laws), **keywords)
    observations, _ = env.reset(seed=0)
    runs = [ChargedEpisode() for _ in laws]
    step = 0
    while not all(run.figures for run in runs):
        # Lanes whose episode has ended are kept folded, which costs next to nothing.
        actions = [
            -1.0 if run.figures else float(np.clip(law(observed, step), -1.0, 1.0))
            for run, law, observed in zip(runs, laws, observations, strict=True)
        ]
        observations, _, terminations, truncations, info = env.step(np.array(actions)[:, None])
        assert not truncations.any()
        for lane, run in enumerate(runs):
            if run.figures:
                continue
            run.actions.append(actions[lane])
            run.times.append(float(info["time_s"][lane]))
            run.terms.append([float(info["reward_terms"][name][lane]) for name in Reward(version=VERSIONS["v1"]).names])
            if terminations[lane]:
                run.figures = {name: values[lane] for name, values in info["deployment"].items() if name[0] != "_"}
        step += 1
    env.close()
    return runs


def mean_total(runs):
    return float(np.mean([run.total for run in runs]))


def constant(action):
    return lambda observation, step: action


def any_latched(observation):
    return observation[4] + observation[5] > 0.5


def all_latched(observation):
    return observation[4] * observation[5] > 0.5


def held_short_at(opening):
    """A feedback that opens both joints to a share of their lock angles, gently enough not to run past."""

    def law(observation, step):
        mean = 0.5 * (observation[0] + observation[1])
        rate = 0.5 * (observation[2] / (math.pi / 2) + observation[3] / math.pi)
        return 40.0 * (np.clip(0.2 * (opening - mean), -0.06, 0.06) - rate)

    return law


def folded_until(step_of_release):
    """The passive deployment, begun later."""
    return lambda observation, step: -1.0 if step < step_of_release else 0.0


def chatter(pattern, phase=0):
    return lambda observation, step: pattern[(step + phase) % len(pattern)]


def phases(pattern):
    return [chatter(pattern, phase) for phase in range(len(pattern))]


def in_turn(before, after, switch):
    """One law until the switch closes, then another."""
    return lambda observation, step: (after if switch(observation) else before)(observation, step)


def erratic(seed):
    actions = np.random.default_rng(seed).uniform(-1.0, 1.0, 400)
    return lambda observation, step: actions[step]


def viscous(damping, settling_damping):
    law = ViscousDamper(Signals.of(gymnasium.make(DEPLOY_V1)), DamperParameters(damping, settling_damping))
    return lambda observation, step: law.predict(observation)[0][0]


def step_of(time, run):
    """Number of the step in which a time falls."""
    return int(np.searchsorted(run.times, time))


class Record(NamedTuple):
    """Loads felt by an array up to the end of every step, (steps, joints); but wear, (joints,), is that at the end."""

    peaks: np.ndarray
    work: np.ndarray
    impulse: np.ndarray
    angles: np.ndarray
    wear: np.ndarray


def physical_record(run, **changes):
    """The same torques on an array that knows of no task: peak forces of the steps [N]; the rest from the start on."""
    model = "rigid-clearance"
    array = solar_env.build(solar_env.ArrayParameters().with_changes(changes), model)
    simulation = solar_env.Simulation(array, default_integrator(model))
    state, rows = simulation.state, []
    for action, end in zip(run.actions, run.times, strict=True):
        simulation.set_motor_torque(0, TASK.torque_limit * action)
        state.joints["recent_peak_force"] = 0.0
        simulation.advance(end)
        integrals = m.joint_integrals(state.integrals)
        sums = integrals[:, m.SLIDING_WORK], integrals[:, m.IMPULSE]
        rows.append(np.array([state.joints["recent_peak_force"], *sums, simulation.joint_loads()[:, ANGLE]]))
    return Record(*np.stack(rows, axis=1), np.maximum(state.wear_journal, state.wear_bearing).max(axis=1))


def assert_charged(terms, peaks, work, first, last):
    """The terms add up to what the record says to the step `last`, peaks since the latching in the step `first`.

    When in the step `first` it latched, the record does not say: that step counts not at all, or wholly.
    """
    peak_impact, wear, _ = np.sum(terms[: last + 1], axis=0)
    peak = [peaks[start : last + 1].max(axis=0).sum() for start in (first + 1, first)]
    assert peak[0] * (1.0 - 1e-9) <= -peak_impact * FORCE_SCALE <= peak[1] * (1.0 + 1e-9)
    assert -wear * WORK_SCALE == pytest.approx(work[last].sum(), rel=1e-9)
