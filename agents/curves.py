"""Learning curves: every agent on every scenario, with several training seeds: `python -m agents.curves`."""

import csv
import itertools
import shlex
import shutil
import sys
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from agents import runs
from agents.arguments import parse_arguments, run_command
from agents.comparison.figures import learning_curves_figure
from agents.comparison.suites import SUITES, TRAINING_MODEL, WHOLE_TORQUE_MODEL
from agents.environments import check_seeds, with_model
from agents.learning import configurations, learn
from solar_env.environment.registration import ENVIRONMENTS
from solar_env.support.campaigns import Workers

FIGURE, TABLE = "learning_curves.png", "learning_curves.csv"

# (panel of the figure, algorithm) -> mean validation return (seeds, validations), after these steps (validations,).
Curves = dict[tuple[str, str], tuple[np.ndarray, np.ndarray]]


@dataclass
class Args:
    """Train agents on both scenarios with several seeds and draw how their validation returns develop."""

    algos: list[str] = field(default_factory=lambda: sorted(runs.ALGORITHMS))
    """algorithms: ppo, sac and td3"""
    seeds: list[int] = field(default_factory=lambda: [0, 1, 2, 3, 4])
    """training seeds of every agent"""
    suites: list[str] = field(default_factory=lambda: list(SUITES))
    """scenarios: paper (nominal) and robust (randomised)"""
    whole: bool = False
    """agents that command the whole torque too, on rigid panels, not only those that add to the tuned servo"""
    timesteps: int | None = None
    """environment steps of every training; None: the number in agents/configs"""
    model: str | None = None
    """rigid-ideal, rigid-clearance, flexible-ideal or flexible-clearance; None: flexible-clearance with 4 elements;
    agents that command the whole torque are on rigid-clearance whatever is named"""
    elements: int | None = None
    """beam elements of each panel of a flexible model; None: 4, or 6 for a model that was named"""
    env_kwargs: dict[str, Any] = field(default_factory=dict)
    """environment keywords"""
    landings: int | None = None
    """as for train.py"""
    hyperparams: dict[str, Any] = field(default_factory=dict)
    """hyperparameters in place of those in agents/configs"""
    out: str = "curves"
    """folder of runs, table and figure; what is complete there is not done again"""
    jobs: int | None = None
    """processes; None: one a processor"""
    cluster: str | None = None
    """ray: run on the Ray cluster that this machine belongs to"""
    readme: bool = False
    """put figure and table beside the page, agents/README.md"""
    quiet: bool = False
    """no progress bars"""


def wanted_runs(args: Args) -> dict[tuple[str, str], dict[Path, configurations.Configuration]]:
    """(panel, algorithm) -> run folder -> what is to be trained there, a run for each seed."""
    wanted: dict[tuple[str, str], dict[Path, configurations.Configuration]] = {}
    for suite, whole in itertools.product(args.suites, (False, True) if args.whole else (False,)):
        env_id = SUITES[suite]
        if whole:
            keywords = {**args.env_kwargs, **WHOLE_TORQUE_MODEL}
        else:
            keywords = with_model(args.env_kwargs, args.model, args.elements, env_id, TRAINING_MODEL)
        panel = f"{ENVIRONMENTS[env_id]}, {keywords['model']}, {'whole torque' if whole else 'added to the servo'}"
        for algo in args.algos:
            wanted[panel, algo] = {
                Path(args.out) / f"{suite}-{algo}{'-whole' if whole else ''}-{seed}": configurations.configuration(
                    algo,
                    env_id,
                    keywords,
                    seed,
                    timesteps=args.timesteps,
                    hyperparameters=args.hyperparams,
                    residual=0.0 if whole else None,
                    landings=None if whole else args.landings,
                )
                for seed in args.seeds
            }
    return wanted


def curve(folders: Sequence[Path]) -> tuple[np.ndarray, np.ndarray]:
    """Steps (validations,) and mean validation returns (runs, validations) of runs of one configuration."""
    histories = [np.load(folder / "evaluations.npz") for folder in folders]
    return histories[0]["timesteps"], np.array([history["results"].mean(axis=1) for history in histories])


def write_table(curves: Curves, seeds: Sequence[int], path: Path) -> None:
    """A row for each validation of each run; the runs of an agent are those of the seeds."""
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["task", "algorithm", "seed", "steps", "validation return"])
        for (panel, algo), (steps, returns) in curves.items():
            for seed, history in zip(seeds, returns, strict=True):
                writer.writerows([panel, algo, seed, int(s), float(r)] for s, r in zip(steps, history, strict=True))


def main(argv: Sequence[str] | None = None) -> None:
    """The command line; see `Args`."""
    args = parse_arguments(Args, argv, prog="python -m agents.curves")
    unknown = [suite for suite in args.suites if suite not in SUITES]
    if unknown:
        raise ValueError(f"no suite {unknown[0]!r}; available: {', '.join(SUITES)}")
    check_seeds(args.seeds)
    command = shlex.join(["python", "-m", "agents.curves", *(sys.argv[1:] if argv is None else argv)])
    wanted = wanted_runs(args)
    everything = {folder: config for of_agent in wanted.values() for folder, config in of_agent.items()}
    learn.train_missing(everything, command, "cpu", Workers(args.jobs, args.cluster), not args.quiet)
    curves: Curves = {key: curve(list(of_agent)) for key, of_agent in wanted.items()}
    out = Path(args.out)
    write_table(curves, args.seeds, out / TABLE)
    learning_curves_figure(curves, out / FIGURE)
    if args.readme:
        for name in (FIGURE, TABLE):
            shutil.copy(out / name, Path(__file__).parent / "figures" / name)
    print(f"written to {out}")


if __name__ == "__main__":
    run_command(main)
