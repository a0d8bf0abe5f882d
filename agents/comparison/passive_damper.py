"""What a controlled drive buys over a passive damper: the best damper, tuned laws and a shipped policy on one array."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from agents.comparison.controllers import parse_controller
from agents.comparison.evaluation import mean_returns, run_cells, without_failed
from agents.comparison.report import Row, Summary
from agents.environments import OF_LAWS, Keywords, environment_settings, episode_seeds, make_env, with_interface
from agents.laws.table import TUNABLE
from agents.learning import runs
from solar_env.array import ModelLevel
from solar_env.array.motorization import slowest_damper
from solar_env.support.campaigns import Cell
from solar_env.support.minimisation import minimise

SPRINGS, DAMPER, DRIVE = "springs alone", "passive damper", "drive by"  # how the names of contestants begin
_COARSE, _FINE = 12, 6  # dampers that are tried over two decades, and then between the neighbours of the best


@dataclass(frozen=True)
class Contest:
    """Array, environment and budget of a comparison.

    Attributes:
        env_id, env_kwargs: Environment with the array's parameters, as a dictionary, and the ranges to draw from.
        points: Candidates for a law's parameters.
        episodes: Episodes that a candidate is judged by.
        workers: Processes.
        seed: Of the searches and of all episodes.
        progress: Show progress bars.
    """

    env_id: str
    env_kwargs: Keywords
    points: int
    episodes: int
    workers: int
    seed: int
    progress: bool

    def damped(self, damping: float) -> Keywords:
        """Return the keywords of the array with a damper in every hinge [N m s/rad], for laws."""
        return {**self.env_kwargs, **OF_LAWS, "parameters": {**self.env_kwargs["parameters"], "hinge_damping": damping}}

    def cells(self, spec: str, env_kwargs: Mapping[str, object], seeds: Sequence[int], **more: object) -> list[Cell]:
        """Make the cells of a controller's episodes."""
        shared = {"spec": spec, "env_id": self.env_id, "env_kwargs": runs.jsonable(env_kwargs), **more}
        return [{**shared, "seed": seed} for seed in seeds]

    def best_damper(self) -> float:
        """Find the damping of all hinges [N m s/rad] with the highest mean return on the springs alone."""
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
            ratio = 1e2 ** (1.0 / (_COARSE - 1))
            ends = best / ratio, best * ratio
        return best

    def tuned(self, law: str) -> dict[str, Any]:
        """Find the parameters of a law with the highest mean return, as JSON keeps them."""
        defaults, keywords = TUNABLE[law].defaults, {**self.env_kwargs, **OF_LAWS}
        generations = 0

        def costs(points: Sequence[np.ndarray]) -> list[float]:
            nonlocal generations
            generations += 1
            seeds = episode_seeds("training", self.seed, generations * self.episodes)[-self.episodes :]
            candidates = [defaults.from_unit(np.clip(point, 0.0, 1.0)) for point in points]
            return [-value for value in mean_returns(law, candidates, self.env_id, keywords, seeds, self.workers)]

        found = minimise(costs, defaults.to_unit(), self.points, self.seed, self.progress)
        seeds = episode_seeds("validation", self.seed, 4 * self.episodes)
        candidates = [defaults.from_unit(np.clip(point, 0.0, 1.0)) for point in found]
        returns = mean_returns(law, candidates, self.env_id, keywords, seeds, self.workers)
        return asdict(candidates[int(np.argmax(returns))])

    def rows(self, laws: Sequence[str], episodes: int) -> tuple[list[Row], Keywords]:
        """Tune everything, and run it on the same evaluation episodes.

        Returns:
            Rows for `agents.comparison.report`, and what was found: the damping, the laws' parameters, and why a policy
            does not fit.
        """
        seeds, driven = episode_seeds("evaluation", self.seed, episodes), {**self.env_kwargs, **OF_LAWS}
        damping = self.best_damper()
        found: Keywords = {"hinge_damping": damping, "laws": {law: self.tuned(law) for law in laws}, "policy": None}
        contestants = {
            SPRINGS: self.cells("passive", driven, seeds),
            f"{DAMPER} of {damping:g} N m s/rad": self.cells("passive", self.damped(damping), seeds),
        }
        for law, parameters in found["laws"].items():
            contestants[f"{DRIVE} {law}"] = self.cells(law, driven, seeds, parameters=parameters)
        policy = "flexible" if ModelLevel.of(str(self.env_kwargs["model"])).flexible else "rigid"
        try:
            named = parse_controller(policy)
            keywords = with_interface(self.env_kwargs, policy, named.interface())
            named.load(make_env(self.env_id, keywords))
            contestants[f"{DRIVE} {policy}"] = self.cells(policy, keywords, seeds)
        except ValueError as error:
            found["policy"] = f"the shipped policy {policy} does not fit: {error}"
        asked = [cell for cells in contestants.values() for cell in cells]
        labels = [
            {"controller": name, "spec": cell["spec"], "episode": k}
            for name, cells in contestants.items()
            for k, cell in enumerate(cells)
        ]
        done = run_cells(asked, self.workers, self.progress)
        return without_failed([{**label, **of} for label, of in zip(labels, done, strict=True)]), found


def answer(summary: Summary, found: Mapping[str, Any], torque_limit: float) -> list[str]:
    """State what the best drive buys over the best damper."""
    returns = {name: entry["return"].mean for name, entry in summary.items()}
    (damper,) = (name for name in returns if name.startswith(DAMPER))
    drive = max((name for name in returns if name.startswith(DRIVE)), key=lambda name: returns[name])
    better, worse = sorted((drive, damper), key=lambda name: -returns[name])
    force = {name: summary[name]["peak_postlock_force_N"].mean for name in returns}
    lines = [
        f"The {better} does better than the {worse}: return {returns[better]:.2f} and {returns[worse]:.2f}, force "
        f"after latching {force[better]:.3g} and {force[worse]:.3g} N; the springs alone have "
        f"{returns[SPRINGS]:.2f} and {force[SPRINGS]:.3g} N. The drive has up to {torque_limit:g} N m."
    ]
    return [*lines, f"{found['policy'][0].upper()}{found['policy'][1:]}."] if found["policy"] else lines
