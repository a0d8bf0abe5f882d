"""Command that shows one episode of several controllers: `solar-env replay`."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import gymnasium

from agents.commands.arguments import ModelOptions
from agents.commands.showing.film import FORMATS, check_film, filmed, write_film
from agents.commands.showing.page import evaluations, replay_page
from agents.comparison.controllers import parse_controllers
from agents.comparison.figures import deployments_figure
from agents.comparison.suites import MODEL
from agents.environments import DEFAULT_ENV_ID, episode_seeds, make_env, with_sampling
from agents.rollout import Step, run_episode
from agents.torque_laws import Controller
from solar_env.commands.arguments import CommandRecord, QuietOption
from solar_env.environment.showing.recording import RecordTrajectory
from solar_env.mechanics.running.trajectory import Trajectory
from solar_env.pictures.page.document import write_page
from solar_env.support.files import check_target
from solar_env.support.progress import counting_bar


@dataclass
class Args(ModelOptions, QuietOption, CommandRecord):
    """Show one episode of several controllers, side by side.

    The model is flexible-clearance unless another is named.
    """

    controllers: list[str] = field(default_factory=lambda: ["passive", "servo"])
    """laws, shipped policies and run folders, see solar-env evaluate --help; each once"""
    out: Path = Path("replay.html")
    """page in motion that needs no network, .html; film, .mp4, or three times as fast, .gif; figure, .png"""
    seed: int = 0
    """chooses the evaluation episode"""
    env_id: str = DEFAULT_ENV_ID
    """environment id"""


def run_command(args: Args) -> int:
    """Run the command; see `Args`."""
    check_target(args.out, (".html", *FORMATS, ".png"))
    suffix, (seed,) = args.out.suffix.lower(), episode_seeds("evaluation", args.seed, 1)
    if suffix in FORMATS:
        check_film(args.out)
        shown = _each(args, render_mode="rgb_array")
        films = [filmed(env, controller, name, seed, FORMATS[suffix]) for name, controller, env in shown]
        write_film(films, args.out)
    elif suffix == ".png":
        steps: dict[str, list[Step]] = {}
        for name, controller, env in _each(args):
            run_episode(env, controller, seed, steps.setdefault(name, []).append)
        deployments_figure(steps, args.out)
    else:
        episodes: dict[str, Trajectory] = {}
        figures: dict[str, dict[str, Any]] = {}
        for name, controller, env in _each(args):
            recorded = RecordTrajectory(env)
            figures[name] = run_episode(recorded, controller, seed)
            episodes[name] = recorded.trajectory
        write_page(replay_page(episodes, figures, args.command, evaluations(args.controllers)), args.out)
    print(f"written to {args.out}")
    return 0


def _each(args: Args, **keywords: Any) -> Iterator[tuple[str, Controller, gymnasium.Env]]:
    """Name every controller, loaded, with its environment, which has some keywords more; all are checked first.

    Raises:
        ValueError, OSError: There is no controller of a name, or its files cannot be loaded.
    """
    asked = {**args.keywords(MODEL), **keywords}
    named = parse_controllers(args.controllers)
    for controller in named:
        controller.training()  # refuses damaged files before any work
    with counting_bar(args.console) as bar:
        for controller in bar.track(named, description="episodes"):
            env = make_env(args.env_id, with_sampling({**asked, **controller.interface()}, args.env_id))
            yield controller.name, controller.load(env), env
