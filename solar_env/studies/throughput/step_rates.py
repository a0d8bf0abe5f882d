"""Environment steps per second by model and number of lanes, and where a step's time goes.

Episodes cost most after latching, hundreds of times as much as in free flight. Lanes are therefore put at moments
spread evenly over one passive deployment, so that a few steps stand for whole episodes.
"""

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np

from solar_env.environment.registration import DEPLOY
from solar_env.environment.vector_env import SolarArrayVectorEnv
from solar_env.mechanics.arrays.model import State
from solar_env.mechanics.running.batch import available_processors

LANES = (1, 2, 16, 64, 256)
SCALED_LANES = 64
COMPARED_LANES = 8
PEERS = ("SyncVectorEnv", "SubprocVecEnv")
MOMENTS = 128
# A measurement goes on until it has taken so long [s], one of several contestants longer, and for no fewer rounds.
ENOUGH, LONG_ENOUGH, FEWEST = 1.0, 5.0, 3


@dataclass(frozen=True)
class Split:
    """Split of a batch's wall time by what it was spent on [s].

    Attributes:
        steps: environment steps, of all lanes.
        wall: altogether.
        physics: in `Batch.advance`.
        observation: in setting torques, in charging and in observing.
    """

    steps: int
    wall: float
    physics: float
    observation: float

    @property
    def rate(self) -> float:
        """Environment steps per second."""
        return self.steps / self.wall

    @property
    def python(self) -> float:
        """The rest [s]."""
        return self.wall - self.physics - self.observation


@cache
def moments(model: str) -> tuple[State, ...]:
    """Saved states of one passive deployment, MOMENTS of them, evenly spread over its control periods."""
    env: Any = gymnasium.make(DEPLOY, model=model).unwrapped
    env.reset(seed=0)
    states, terminated = [env.simulation.snapshot()], False
    while not terminated:
        terminated = env.step(np.zeros(1))[2]
        states.append(env.simulation.snapshot())
    # The last control period is cut short, and after it the episode would be over.
    return tuple(states[k] for k in np.linspace(0, len(states) - 3, MOMENTS).astype(int))


def spread(model: str, lanes: int) -> list[State]:
    """A moment for every lane, spread over the deployment."""
    return [moments(model)[(lane * MOMENTS) // lanes] for lane in range(lanes)]


class FromMoment(gymnasium.Wrapper):
    """A single environment whose episodes begin at a saved state."""

    def __init__(self, model: str, moment: State) -> None:
        super().__init__(gymnasium.make(DEPLOY, model=model))
        self._moment = moment

    def reset(self, **keywords: Any) -> tuple[Any, dict[str, Any]]:
        """Reset, and go to the moment."""
        result = self.env.reset(**keywords)
        self.get_wrapper_attr("simulation").restore(self._moment)
        return result


def make_native(model: str, lanes: int, threads: int | None = None) -> SolarArrayVectorEnv:
    """A native vector environment that has been reset."""
    env: Any = gymnasium.make_vec(DEPLOY, lanes, model=model, num_threads=threads).unwrapped
    env.reset(seed=0)
    return env


def place(env: SolarArrayVectorEnv, chosen: Sequence[State]) -> None:
    """Put every lane at a moment."""
    for simulation, moment in zip(env.episodes.batch.simulations, chosen, strict=True):
        simulation.restore(moment)


def measure_native(model: str, lanes: int) -> Split:
    """Time the steps of a native vector environment, whose lanes go through all moments again and again."""
    env = make_native(model, lanes)
    physics, observation = [0.0], [0.0]
    episodes = env.episodes
    for owner, name, taken in (
        (episodes.batch, "attempt", physics),
        (episodes, "hold", observation),
        (episodes, "end", observation),
    ):
        setattr(owner, name, _timed(getattr(owner, name), taken))
    actions = np.zeros((lanes, 1), dtype=np.float32)
    env.step(actions)
    physics[0] = observation[0] = 0.0
    steps, wall = 0, 0.0
    while wall < ENOUGH or steps < FEWEST * lanes:
        for first in range(0, MOMENTS, lanes):
            place(env, [moments(model)[(first + lane) % MOMENTS] for lane in range(lanes)])
            start = time.perf_counter()
            env.step(actions)
            wall += time.perf_counter() - start
            steps += lanes
    env.close()
    return Split(steps, wall, physics[0], observation[0])


def _timed(function: Callable[..., Any], taken: list[float]) -> Callable[..., Any]:
    """The function, which adds the time of each call to the one number in `taken` [s]."""

    def call(*arguments: Any) -> Any:
        start = time.perf_counter()
        result = function(*arguments)
        taken[0] += time.perf_counter() - start
        return result

    return call


def compare(contestants: Mapping[str, tuple[Any, Callable[[], Any]]], lanes: int) -> dict[str, float]:
    """Steps per second, medians over rounds of contestants stepped in turn, so that what disturbs one disturbs all.

    Args:
        contestants: name -> environment, and what puts its lanes to their moments.
        lanes: of each.
    """
    actions = np.zeros((lanes, 1), dtype=np.float32)
    walls: dict[str, list[float]] = {name: [] for name in contestants}
    start = time.perf_counter()
    while time.perf_counter() - start < LONG_ENOUGH or len(next(iter(walls.values()))) < FEWEST:
        for name, (env, begin) in contestants.items():
            begin()
            before = time.perf_counter()
            env.step(actions)
            walls[name].append(time.perf_counter() - before)
    for env, _ in contestants.values():
        env.close()
    # The first round warms up.
    return {name: lanes / float(np.median(times[1:])) for name, times in walls.items()}


def measure_scaling(model: str) -> float:
    """Throughput of SCALED_LANES native lanes with all threads, over that with one."""
    chosen = spread(model, SCALED_LANES)
    envs = {str(threads): make_native(model, SCALED_LANES, threads) for threads in (1, available_processors())}
    rates = compare({name: (env, partial(place, env, chosen)) for name, env in envs.items()}, SCALED_LANES)
    return rates[str(available_processors())] / rates["1"]


def measure_peers(model: str) -> dict[str, float]:
    """Throughput of COMPARED_LANES native lanes over that of Gymnasium's and Stable-Baselines3's vectors.

    Raises:
        ImportError: without Stable-Baselines3.
    """
    from stable_baselines3.common.vec_env import SubprocVecEnv

    chosen = spread(model, COMPARED_LANES)
    makers = [partial(FromMoment, model, moment) for moment in chosen]
    native, sync = make_native(model, COMPARED_LANES), gymnasium.vector.SyncVectorEnv(makers)
    processes = SubprocVecEnv(makers)  # type: ignore[arg-type]
    rates = compare(
        {
            "native": (native, partial(place, native, chosen)),
            "SyncVectorEnv": (sync, partial(sync.reset, seed=0)),
            "SubprocVecEnv": (processes, processes.reset),
        },
        COMPARED_LANES,
    )
    return {name: rates["native"] / rates[name] for name in PEERS}


_STARTUP = """
import time
start = time.perf_counter()
import gymnasium, numpy, solar_env
env = gymnasium.make_vec({id!r}, 2, model={model!r})
env.reset(seed=0)
env.step(numpy.zeros((2, 1)))
print(time.perf_counter() - start)
"""


def measure_startup(model: str, cold: bool) -> float:
    """Seconds from a fresh interpreter to the first step, with the kernels in the cache or, `cold`, without."""
    with tempfile.TemporaryDirectory() as folder:
        changed = {"NUMBA_CACHE_DIR": folder} if cold else {}
        return float(_run(_STARTUP.format(id=DEPLOY, model=model), changed))


_MEMORY = """
import resource, sys
import gymnasium, numpy, solar_env
def used():
    try:
        with open("/proc/self/statm") as file:
            return int(file.read().split()[1]) * resource.getpagesize()
    except OSError:  # not Linux: the peak so far
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * (1 if sys.platform == "darwin" else 1024)
def run(lanes):
    env = gymnasium.make_vec({id!r}, lanes, model={model!r})
    env.reset(seed=0)
    env.step(numpy.zeros((lanes, 1)))
    return env
few = run(2)
before = used()
many = run({lanes})
print((used() - before) / {lanes})
"""


def measure_memory(model: str, lanes: int = 1000) -> float:
    """Bytes of memory that each further lane takes."""
    return float(_run(_MEMORY.format(id=DEPLOY, model=model, lanes=lanes), {}))


def _run(program: str, changed: dict[str, str]) -> str:
    parent = str(Path(__file__).resolve().parents[3])
    path = os.pathsep.join(filter(None, (parent, os.environ.get("PYTHONPATH"))))
    done = subprocess.run(
        [sys.executable, "-c", program],
        env={**os.environ, "PYTHONPATH": path, **changed},
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout


Key = tuple[str, str, int | str]


def measurements(models: Sequence[str], cold: bool) -> dict[Key, Callable[[], Any]]:
    """All measurements: (what, model, of what) -> function that measures; `cold`: with kernels compiled anew."""
    plan: dict[Key, Callable[[], Any]] = {}
    for model in models:
        for lanes in LANES:
            plan["lanes", model, lanes] = partial(measure_native, model, lanes)
        plan["threads", model, ""] = partial(measure_scaling, model)
        plan["peers", model, ""] = partial(measure_peers, model)
        plan["memory", model, ""] = partial(measure_memory, model)
        plan["startup", model, "cached"] = partial(measure_startup, model, cold=False)
    if cold:
        plan["startup", models[0], "cold"] = partial(measure_startup, models[0], cold=True)
    return plan
