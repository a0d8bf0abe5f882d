"""Comparison of drives (tuned torque laws and a shipped policy) with the best passive hinge damper on one array."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from agents.comparison.controllers import parse_controller
from agents.comparison.evaluation import run_cells, without_failed
from agents.comparison.law_search import LawSearch
from agents.comparison.report import Row, Summary
from agents.environments import OF_LAWS, Keywords, environment_settings, episode_seeds, make_env, with_interface
from agents.laws.table import TUNABLE
from agents.learning import runs
from solar_env.array import ModelLevel
from solar_env.array.motorization import slowest_damper
from solar_env.support.campaigns import Cell

SPRINGS, DAMPER, DRIVE = "springs alone", "passive damper", "drive by"  # beginnings of the contestants' names
_COARSE, _FINE = 12, 6  # numbers of dampers tried over two decades, and then between the neighbours of the best


@dataclass(frozen=True)
class Contest:
    """Comparison of controlled drives with passive dampers in one environment, and the budget for tuning them.

    `env_kwargs` must hold "model" and, as a dictionary, the array's "parameters". Tuning a law tries `points`
    candidates, each on `episodes` episodes.
    """

    env_id: str
    env_kwargs: Keywords
    points: int
    episodes: int
    workers: int
    seed: int
    progress: bool

    def damped(self, damping: float) -> Keywords:
        """Return `env_kwargs` with the keywords that torque laws need and with `damping` [N m s/rad] in every hinge."""
        return {**self.env_kwargs, **OF_LAWS, "parameters": {**self.env_kwargs["parameters"], "hinge_damping": damping}}

    def cells(self, spec: str, env_kwargs: Mapping[str, object], seeds: Sequence[int], **more: object) -> list[Cell]:
        """Describe an episode of controller `spec` per seed, as dictionaries for `run_cells` that also hold `more`."""
        shared = {"spec": spec, "env_id": self.env_id, "env_kwargs": runs.jsonable(env_kwargs), **more}
        return [{**shared, "seed": seed} for seed in seeds]

    def best_damper(self) -> float:
        """Find the damping [N m s/rad], equal in all hinges, with the highest mean return without a motor torque."""
        settings = environment_settings(self.env_id, self.env_kwargs)
        most = slowest_damper(settings.array, settings.task.deadline)
        tried: dict[float, float] = {}
        ends = 1e-2 * most, most
        for count in (_COARSE, _FINE):
            dampings = [float(f"{damping:.3g}") for damping in np.geomspace(*ends, count)]
            seeds = episode_seeds("training", self.seed, self.episodes)
            asked = [cell for damping in dampings for cell in self.cells("passive", self.damped(damping), seeds)]
            returns = [figures.get("return", -np.inf) for figures in run_cells(asked, self.workers, self.progress)]
            tried |= dict(zip(dampings, np.reshape(returns, (count, -1)).mean(axis=1).tolist(), strict=True))
            best = max(tried, key=lambda damping: tried[damping])
            ends = best * 1e-2 ** (1.0 / (_COARSE - 1)), best * 1e2 ** (1.0 / (_COARSE - 1))
        return best

    def tuned(self, law: str) -> dict[str, Any]:
        """Tune a law; return the parameters of the highest mean return in validation, as a dictionary."""
        keywords, budget = {**self.env_kwargs, **OF_LAWS}, (self.points, self.episodes, 4 * self.episodes)
        search = LawSearch(law, self.env_id, keywords, *budget, self.seed, self.workers, self.progress)
        candidates, validated, _ = search.run(TUNABLE[law].defaults)
        return asdict(candidates[int(np.argmax(validated))])

    def rows(self, laws: Sequence[str], episodes: int) -> tuple[list[Row], Keywords]:
        """Tune damper and laws; run them, the springs alone and a shipped policy on the same evaluation episodes.

        Return one row of results per controller and episode, and a dictionary of findings: "hinge_damping"
        [N m s/rad], "laws" (dictionary of each law's parameters), "hinges" (their number), "model", and "unfit". The
        last is a list of sentences on controllers that were left out because they do not suit the environment.
        """
        seeds, driven = episode_seeds("evaluation", self.seed, episodes), {**self.env_kwargs, **OF_LAWS}
        damping = self.best_damper()
        array = environment_settings(self.env_id, self.env_kwargs).array
        found: Keywords = {"hinge_damping": damping, "laws": {}, "unfit": [], "hinges": array.joint_count}
        found["model"] = self.env_kwargs["model"]
        contestants = {
            SPRINGS: self.cells("passive", driven, seeds),
            f"{DAMPER} of {damping:g} N m s/rad": self.cells("passive", self.damped(damping), seeds),
        }
        for law in laws:
            try:
                found["laws"][law] = self.tuned(law)
                contestants[f"{DRIVE} {law}"] = self.cells(law, driven, seeds, parameters=found["laws"][law])
            except ValueError as error:
                found["unfit"].append(f"The law {law} does not fit: {error}.")
        policy = "flexible" if ModelLevel.of(str(self.env_kwargs["model"])).flexible else "rigid"
        try:
            named = parse_controller(policy)
            keywords = with_interface(self.env_kwargs, policy, named.interface())
            named.load(make_env(self.env_id, keywords))
            contestants[f"{DRIVE} {policy}"] = self.cells(policy, keywords, seeds)
        except ValueError as error:
            found["unfit"].append(f"The shipped policy {policy} does not fit: {error}.")
        asked = [cell for cells in contestants.values() for cell in cells]
        labels = [
            {"controller": name, "spec": cell["spec"], "episode": k}
            for name, cells in contestants.items()
            for k, cell in enumerate(cells)
        ]
        done = run_cells(asked, self.workers, self.progress)
        return without_failed([{**label, **of} for label, of in zip(labels, done, strict=True)]), found


def answer(summary: Summary, found: Mapping[str, Any], torque_limit: float) -> list[str]:
    """Return sentences that compare returns, torques and forces of the best drive, the best damper and the springs.

    They also state the motor's `torque_limit` [N m], and three entries of `found`, the findings that `Contest.rows`
    returns: "model", "hinges" (number of hinges), and "unfit" (sentences on unsuitable controllers).
    """
    returns = {name: entry["return"].mean for name, entry in summary.items()}
    (damper,) = (name for name in returns if name.startswith(DAMPER))
    drive = max((name for name in returns if name.startswith(DRIVE)), key=lambda name: returns[name])
    better, worse = sorted((drive, damper), key=lambda name: -returns[name])
    force = {name: summary[name]["peak_postlock_force_N"].mean for name in returns}
    torque = {name: summary[name]["peak_latch_torque_Nm"].mean for name in returns}
    lines = [
        f"On {found['model']} the {better} does better than the {worse}: return {returns[better]:.2f} and "
        f"{returns[worse]:.2f}, latch torque {torque[better]:.3g} and {torque[worse]:.3g} N m, force after latching "
        f"{force[better]:.3g} and {force[worse]:.3g} N; the springs alone have {returns[SPRINGS]:.2f}, "
        f"{torque[SPRINGS]:.3g} N m and {force[SPRINGS]:.3g} N. The damper is in each of {found['hinges']} hinges; "
        f"the drive turns the root alone, with up to {torque_limit:g} N m."
    ]
    return [*lines, *found["unfit"]]
