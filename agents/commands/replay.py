"""Command that shows the same episode under several controllers: `solar-env replay`."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import gymnasium
from PIL import Image

from agents.commands.arguments import ModelOptions
from agents.comparison.controllers import parse_controllers
from agents.comparison.report import TABLE
from agents.environments import DEFAULT_ENV_ID, MODEL, episode_seeds, make_env, with_interface, with_sampling
from agents.rollout import Figures, run_episode
from agents.torque_laws import Controller
from solar_env.array import ArrayParameters
from solar_env.commands.arguments import CommandRecord, QuietOption
from solar_env.environment.showing.recording import RecordTrajectory
from solar_env.mechanics.running.trajectory import Trajectory
from solar_env.pictures.films import FRAMES_PER_SECOND, captioned, encoder, write_film
from solar_env.pictures.frame import Renderer
from solar_env.pictures.page.content import Page, Table
from solar_env.pictures.page.document import write_page
from solar_env.studies.common.deployment_page import charts_of, motion_of, parameter_table, scenes_of
from solar_env.support.files import check_target
from solar_env.support.progress import counting_bar
from solar_env.support.versions import versions

# Width of a frame [pixels], and speed divided by real time: a GIF in full size at speed 1 has tens of megabytes.
FILMS = {".mp4": (960, 1.0), ".gif": (640, 3.0)}


@dataclass
class Args(ModelOptions, QuietOption, CommandRecord):
    """Show one episode of several controllers, side by side.

    The model is flexible-clearance unless another is named.
    """

    controllers: list[str] = field(default_factory=lambda: ["passive", "servo"])
    """drive laws, shipped policies and run folders, see solar-env evaluate --help; each once"""
    out: Path = Path("replay.html")
    """file to write: an animated page that needs no network (.html), a film (.mp4), or a film at triple speed (.gif)"""
    seed: int = 0
    """seed of the evaluation episode"""
    env_id: str = DEFAULT_ENV_ID
    """environment id"""


def run_command(args: Args) -> int:
    """Run an episode of each controller, and write the page or the film; see `Args`."""
    check_target(args.out, (".html", *FILMS))
    suffix, (seed,) = args.out.suffix.lower(), episode_seeds("evaluation", args.seed, 1)
    if suffix == ".mp4":
        encoder()
    episodes: dict[str, Trajectory] = {}
    figures: dict[str, Figures] = {}
    for name, controller, env in _each(args):
        recorded = RecordTrajectory(env)
        figures[name] = run_episode(recorded, controller, seed)
        episodes[name] = recorded.trajectory
    if suffix in FILMS:
        longest = max(trajectory.time[-1] for trajectory in episodes.values())
        write_film([filmed(*episode, longest, *FILMS[suffix]) for episode in episodes.items()], args.out)
    else:
        write_page(replay_page(episodes, figures, args.command), args.out)
    print(f"written to {args.out}")
    return 0


def _each(args: Args) -> Iterator[tuple[str, Controller, gymnasium.Env]]:
    """Yield every controller's name, the loaded controller and its environment, after checking all controllers."""
    asked = args.keywords(MODEL)
    interfaces = {controller: controller.interface() for controller in parse_controllers(args.controllers)}
    with counting_bar(args.console) as bar:
        for controller, interface in bar.track(interfaces.items(), description="episodes"):
            env = make_env(args.env_id, with_sampling(with_interface(asked, controller.name, interface), args.env_id))
            yield controller.name, controller.load(env), env


def replay_page(episodes: dict[str, Trajectory], figures: Mapping[str, Figures], command: str) -> Page:
    """Return the contents of an HTML page that shows `episodes` and their results, `figures`, side by side.

    The keys of both are names of controllers. A note on the page states `command`, the command line that made it.
    """
    landed = [name for name in episodes if figures[name]["latched"]]
    softest = min(landed, key=lambda name: figures[name]["peak_postlock_force_N"], default=None)
    lands = "none lands"
    if softest:
        lands = (
            f"{softest} lands softest, with at most {figures[softest]['peak_postlock_force_N']:.3g} N after latching"
        )
    best = max(episodes, key=lambda name: figures[name]["return"])
    answer = [
        f"Of {len(episodes)} controllers {lands}; {best} has the highest return, {figures[best]['return']:.3g}.",
        "One episode, the same for all: impacts are chaotic, so compare many with solar-env evaluate.",
    ]
    shown = {name: row for name, row in TABLE.items() if all(name in of for of in figures.values())}
    rows = [
        [words, *(f"{factor * of[name]:.4g}".replace("nan", "-") for of in figures.values())]
        for name, (words, factor) in shown.items()
    ]
    terms = [name for name in next(iter(figures.values())) if name.startswith("reward_")]
    rows += [[name.replace("_", " "), *(f"{of[name]:.3g}" for of in figures.values())] for name in terms]
    table = Table("Figures of the episode", ["figure", *figures], rows)
    motions = [motion_of(trajectory, name) for name, trajectory in episodes.items()]
    notes = [f"Made by: {command}", ", ".join(f"{name} {value}" for name, value in versions().items())]
    array = ArrayParameters().with_changes(next(iter(episodes.values())).metadata["parameters"])
    tables = [table, parameter_table(array)]
    return Page("One episode, " + " beside ".join(episodes), answer, motions, charts_of(episodes), tables, notes)


def filmed(name: str, trajectory: Trajectory, longest: float, width: int, speed: float) -> list[Image.Image]:
    """Return the images of a film, `width` pixels wide and captioned `name`, that plays at `speed` times real time.

    The time axes in the images end at `longest` [s].
    """
    scenes = scenes_of(trajectory, speed / FRAMES_PER_SECOND)
    renderer = Renderer(scenes[0], longest)
    return [captioned(renderer.draw(scene), name, width) for scene in scenes]
