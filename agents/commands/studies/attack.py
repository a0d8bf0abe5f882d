"""`solar-env study attack-on-reward`: a search for actions that earn a high return without a soft landing."""

import json
import math
from collections.abc import Sequence
from contextlib import closing
from typing import Any

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode

from agents.environments import DEFAULT_ENV_ID, episode_seeds, with_sampling
from agents.learning import runs
from solar_env.commands.study import Args
from solar_env.environment.episodes import Info
from solar_env.environment.task.task import Task
from solar_env.support.minimisation import minimise

# A profile is numbers in [0, 1]: `KNOTS` actions, and then, once for the time before the first latch and once for the
# time after, a chatter's amplitude as a fraction of the greatest action, its half-period and its phase.
KNOTS = 30
NUMBERS = KNOTS + 2 * 3
LONGEST_HALF_PERIOD = 4  # longest half-period of a chatter [control periods]

OPTIONS = ("quick", "out")
SEED = 0  # seed of the search and of its episodes
EPISODES, QUICK_EPISODES = 1920, 28
KEYWORDS: dict[str, Any] = {}  # keywords of the environment
FILE = "attack.json"


def actions(profiles: np.ndarray, times: np.ndarray, latched: np.ndarray, task: Task) -> np.ndarray:
    """Return the actions (n,) of action profiles (n, NUMBERS) at times (n,) [s], one for each environment of a batch.

    A profile holds numbers in [0, 1]: actions at equal intervals up to the deadline of `task`, 0.5 for no action; then
    amplitude, half-period and phase of a square wave (chatter), which is blended with the actions before the first
    latch; and the same three numbers for the time after it. `latched` (n,) is true if a joint has latched.
    """
    knots = np.linspace(0.0, task.deadline, KNOTS)
    steady = np.array([np.interp(t, knots, 2.0 * of[:KNOTS] - 1.0) for t, of in zip(times, profiles, strict=True)])
    chatter = np.where(latched[:, None], profiles[:, KNOTS + 3 :], profiles[:, KNOTS : KNOTS + 3])
    share, half_period = chatter[:, 0], np.ceil(np.maximum(chatter[:, 1] * LONGEST_HALF_PERIOD, 1e-9))
    period = np.rint(times / task.control_period + chatter[:, 2] * 2.0 * half_period)
    sign = np.where((period // half_period) % 2 == 0, 1.0, -1.0)
    return np.clip((1.0 - share) * steady + share * sign, -1.0, 1.0)


def passive_profile() -> np.ndarray:
    """Return the profile (NUMBERS,) that `actions` decodes to actions of 0 at all times.

    Its first KNOTS numbers are 0.5, the middle of the range of actions. Both of its square waves have amplitude 0.
    """
    return np.concatenate([np.full(KNOTS, 0.5), [0.0, 0.25, 0.0], [0.0, 0.25, 0.0]])


def deployments(env: Any, profiles: Sequence[np.ndarray], seeds: Sequence[int]) -> list[Info]:
    """Run an episode of each action profile with the seed at the same index, in vector environment `env`.

    A profile (NUMBERS,) holds actions at KNOTS times and the parameters of two square waves, which `actions` decodes.
    Return, for each episode, a dictionary with its "return" and the entries of `info["deployment"]`.
    """
    env, idle = env.unwrapped, env.num_envs - len(profiles)
    given = np.stack([*profiles, *[passive_profile()] * idle])
    env.reset(seed=[*seeds, *[0] * idle])
    episodes, going = env.episodes, np.arange(len(profiles))
    totals = np.zeros(env.num_envs)
    results: list[Info] = [{} for _ in profiles]
    while going.size:
        latched = episodes.batch.states.clock["latched_joints"][:, 0] > 0
        episodes.step(going, actions(given, episodes.times, latched, env.task)[:, None])
        totals[going] += episodes.rewards[going]
        for lane in going[episodes.terminated[going]]:
            results[lane] = {"return": float(totals[lane]), **episodes.figures(int(lane))}
        going = going[~episodes.terminated[going]]
    return results


def run(args: Args) -> int:
    """Search by CMA-ES, from zero actions, for action profiles of highest return, and write them to `attack.json`."""
    folder, _ = args.folders("attack-on-reward")
    lanes = 4 + math.floor(3 * math.log(NUMBERS))  # number of candidates in pycma's generations
    keywords = {**with_sampling(KEYWORDS), "autoreset_mode": AutoresetMode.DISABLED}
    with closing(gymnasium.make_vec(DEFAULT_ENV_ID, lanes, **keywords)) as env:
        used = 0

        def costs(points: Sequence[np.ndarray]) -> list[float]:
            nonlocal used
            seeds = episode_seeds("training", SEED, used + len(points))[-len(points) :]
            used += len(points)
            return [-result["return"] for result in deployments(env, points, seeds)]

        budget = QUICK_EPISODES if args.quick else EPISODES
        found = minimise(costs, passive_profile(), budget, SEED, not args.quiet, spread=0.2)
        seeds = episode_seeds("validation", SEED, lanes)
        named = zip(("passive", "best episode", "mean of the search"), found, strict=True)
        results = {name: deployments(env, [profile] * lanes, seeds) for name, profile in named}
    summary = {
        name: {
            "return": float(np.median([each["return"] for each in of])),
            "latched": float(np.mean([each["latched"] for each in of])),
            "peak_postlock_force_N": float(np.median([sum(each["peak_postlock_force_N"]) for each in of])),
            "sliding_work_J": float(np.median([sum(each["sliding_work_J"]) for each in of])),
            "wear_depth_max_m": float(np.median([max(each["wear_depth_max_m"]) for each in of])),
        }
        for name, of in results.items()
    }
    profiles = {name: profile.tolist() for name, profile in zip(results, found, strict=True)}
    record = {"command": args.command, "episodes": used, "medians": summary, "profiles": profiles}
    runs.write_json(folder / FILE, record)
    print(json.dumps(summary, indent=2))
    print(f"written to {folder / FILE}")
    return 0
