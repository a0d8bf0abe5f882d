"""Environment steps per second by model and number of lanes, and the fraction of the time in compiled calls.

Steps cost most after latching, hundreds of times as much as in free flight. The lanes (a vector environment's single
environments) therefore start from states spread evenly over a passive deployment: few steps represent whole episodes.
"""

import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cache, partial
from typing import Any

import gymnasium
import numpy as np

from solar_env.environment.registration import DEPLOY
from solar_env.environment.vector_env import SolarArrayVectorEnv
from solar_env.mechanics.arrays.model import State
from solar_env.mechanics.running.batch import available_processors
from solar_env.support.markdown import markdown_table

LANES = (1, 2, 16, 64, 256)
SCALED_LANES = 64
COMPARED_LANES = 8
PEERS = ("SyncVectorEnv", "SubprocVecEnv")
MOMENTS = 128
# Least duration [s] and least number of rounds of a measurement.
ENOUGH, FEWEST = 2.0, 3


@cache
def moments(model: str) -> tuple[State, ...]:
    """Return 128 (MOMENTS) saved simulation states of a passive deployment, evenly spread over its control periods."""
    env: Any = gymnasium.make(DEPLOY, version="v1", model=model).unwrapped
    env.reset(seed=0)
    states, terminated = [env.simulation.snapshot()], False
    while not terminated:
        terminated = env.step(np.zeros(1))[2]
        states.append(env.simulation.snapshot())
    # Leave out the last two states: a step from the first is cut short, and the second ends the episode.
    return tuple(states[k] for k in np.linspace(0, len(states) - 3, MOMENTS).astype(int))


def placements(model: str, lanes: int) -> list[list[State]]:
    """Return lists of a saved state for each of `lanes` environments; together they hold a deployment's 128 states."""
    every = moments(model)
    return [[every[(first + lane) % MOMENTS] for lane in range(lanes)] for first in range(0, MOMENTS, lanes)]


def spread(model: str, lanes: int) -> list[State]:
    """Return one saved state for each lane (environment), spread evenly over the deployment."""
    return [moments(model)[(lane * MOMENTS) // lanes] for lane in range(lanes)]


class FromMoment(gymnasium.Wrapper):
    """A single environment whose episodes begin at a saved state."""

    def __init__(self, model: str, moment: State) -> None:
        super().__init__(gymnasium.make(DEPLOY, version="v1", model=model))
        self._moment = moment

    def reset(self, **keywords: Any) -> tuple[Any, dict[str, Any]]:
        """Reset the environment, and restore the saved state."""
        result = self.env.reset(**keywords)
        self.get_wrapper_attr("simulation").restore(self._moment)
        return result


def make_native(model: str, lanes: int, threads: int | None = None) -> SolarArrayVectorEnv:
    """Return a native vector environment (this project's SolarArrayVectorEnv) after a reset."""
    env: Any = gymnasium.make_vec(DEPLOY, lanes, version="v1", model=model, num_threads=threads).unwrapped
    env.reset(seed=0)
    return env


def place(env: SolarArrayVectorEnv, chosen: Sequence[State]) -> None:
    """Restore in each lane (environment) of a vector environment the saved state chosen for it."""
    for simulation, moment in zip(env.episodes.batch.simulations, chosen, strict=True):
        simulation.restore(moment)


# An environment, and for each placement a function that restores the saved states in the environment's lanes.
Contestant = tuple[Any, Sequence[Callable[[], object]]]


def compare(contestants: Mapping[str, Contestant], lanes: int) -> dict[str, float]:
    """Return vector environments' steps per second by name. They take turns, so that disturbances affect all alike.

    `contestants` maps a name to (vector environment, placements). A placement is a function that restores a saved state
    in each of the `lanes` single environments. In a round, each vector environment takes one step from each of its
    placements; all have equally many. Such a step counts as `lanes` steps. Its time is the mean over the placements of
    medians over all rounds but the first.
    """
    actions = np.zeros((lanes, 1), dtype=np.float32)
    rounds: list[list[list[float]]] = []
    start = time.perf_counter()
    while time.perf_counter() - start < ENOUGH or len(rounds) < FEWEST:
        rounds.append([])
        for begins in zip(*(begins for _, begins in contestants.values()), strict=True):
            walls = []
            for (env, _), begin in zip(contestants.values(), begins, strict=True):
                begin()
                before = time.perf_counter()
                env.step(actions)
                walls.append(time.perf_counter() - before)
            rounds[-1].append(walls)
    for env, _ in contestants.values():
        env.close()
    # The first round warms up.
    seconds = np.median(rounds[1:], axis=0).mean(axis=0)
    return {name: lanes / float(wall) for name, wall in zip(contestants, seconds, strict=True)}


def measure_rate(model: str, lanes: int) -> dict[str, float]:
    """Measure our vector environment's steps per second with `lanes` environments; return {str(lanes): rate}.

    If `lanes` is SCALED_LANES, a key "compiled" is added: the fraction of the time spent in compiled code.
    """
    env = make_native(model, lanes)
    taken = {"step": 0.0, "run": 0.0}
    for owner, name in ((env, "step"), (env.episodes.batch, "run")):
        setattr(owner, name, _timed(getattr(owner, name), taken, name))
    begins = [partial(place, env, chosen) for chosen in placements(model, lanes)]
    rates = compare({str(lanes): (env, begins)}, lanes)
    return {**rates, "compiled": taken["run"] / taken["step"]} if lanes == SCALED_LANES else rates


def _timed(function: Callable[..., object], taken: dict[str, float], name: str) -> Callable[..., object]:
    """Return `function`, wrapped so that it adds the time of each call [s] to `taken[name]`."""

    def call(*arguments: object) -> object:
        start = time.perf_counter()
        result = function(*arguments)
        taken[name] += time.perf_counter() - start
        return result

    return call


def measure_threads(model: str) -> dict[str, float]:
    """Measure the ratio of our throughput with all threads to one thread's, for SCALED_LANES lanes (environments)."""
    chosen, every = spread(model, SCALED_LANES), available_processors()
    envs = {name: make_native(model, SCALED_LANES, threads) for name, threads in (("one", 1), ("every", every))}
    rates = compare({name: (env, [partial(place, env, chosen)]) for name, env in envs.items()}, SCALED_LANES)
    return {"threads": rates["every"] / rates["one"]}


def measure_peers(model: str) -> dict[str, float]:
    """Return {name: our speed / its speed} for SyncVectorEnv and SubprocVecEnv, each of COMPARED_LANES environments."""
    from stable_baselines3.common.vec_env import SubprocVecEnv

    chosen = spread(model, COMPARED_LANES)
    makers = [partial(FromMoment, model, moment) for moment in chosen]
    native, sync = make_native(model, COMPARED_LANES), gymnasium.vector.SyncVectorEnv(makers)
    processes = SubprocVecEnv(makers)  # type: ignore[arg-type]
    rates = compare(
        {
            "native": (native, [partial(place, native, chosen)]),
            "SyncVectorEnv": (sync, [partial(sync.reset, seed=0)]),
            "SubprocVecEnv": (processes, [processes.reset]),
        },
        COMPARED_LANES,
    )
    return {name: rates["native"] / rates[name] for name in PEERS}


def measurements(models: Iterable[str]) -> list[tuple[str, Callable[[], dict[str, float]]]]:
    """Return all measurements, as pairs of a model and a function that returns measured values by name."""
    whats: list[Callable[[str], dict[str, float]]] = [partial(measure_rate, lanes=lanes) for lanes in LANES]
    whats += [measure_threads, measure_peers]
    return [(model, partial(what, model)) for model in models for what in whats]


def as_markdown(figures: Mapping[str, Mapping[str, float]]) -> str:
    """Return Markdown tables of measured speeds, given as model -> name -> value.

    Values are steps per second, speed ratios (all threads to one, this library's vector environment to others), and the
    fraction of the stepping time in compiled code.
    """
    threads = available_processors()
    rates = [(model, *(f"{measured[str(lanes)]:,.0f}" for lanes in LANES)) for model, measured in figures.items()]
    ratios = [
        (model, f"{found['threads']:.2f}", f"{found['compiled']:.1%}", *(f"{found[peer]:.2f}" for peer in PEERS))
        for model, found in figures.items()
    ]
    columns = ("model", f"ratio of {threads} threads to 1", "fraction of the time in compiled calls")
    return (
        f"Steps per second of wall time, by number of environments, with {threads} threads; a step is 0.1 s of the "
        f"deployment:\n\n"
        f"{markdown_table(('model', *map(str, LANES)), rates)}\n\n"
        f"Two threads compared with one ({SCALED_LANES} environments), and this library's vector environment with "
        f"others ({COMPARED_LANES} environments):\n\n"
        f"{markdown_table((*columns, *(f'ratio to {peer}' for peer in PEERS)), ratios)}"
    )
