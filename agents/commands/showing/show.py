"""Command that draws and animates one episode of several controllers: `solar-env show`."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image, ImageDraw, ImageFont
from rich.console import Console

from agents.commands.arguments import ShowingOptions
from agents.comparison.figures import deployments_figure
from agents.rollout import Step, run_episode
from agents.torque_laws import Controller
from solar_env.pictures.gif import write_gif
from solar_env.support.files import copy_file, make_folder
from solar_env.support.progress import counting_bar

FIGURE, ANIMATION = "deployments.png", "deployments.gif"
WIDTH, CAPTION = 640, 28  # of the animation, and height of a controller's name in it [pixels]
FRAME_EVERY = 3  # control periods
FRAMES_PER_SECOND = 10


@dataclass
class Args(ShowingOptions):
    """Draw one episode of several controllers, the same for all, and animate them one above the other.

    The model is flexible-clearance unless another is named.
    """

    out: str = "show"
    """folder of the figure and the animation"""
    readme: bool = False
    """put the figure and the animation beside the page, agents/comparison/README.md"""


def run_command(args: Args) -> int:
    """Run the command; see `Args`."""
    prepared = args.prepare(args.controllers, render_mode="rgb_array")
    out = make_folder(args.out)
    episodes: dict[str, list[Step]] = {}
    films: list[list[Image.Image]] = []
    with counting_bar(Console(stderr=True, quiet=args.quiet)) as bar:
        for named, env in bar.track(prepared, description="episodes"):
            episodes[named.name], film = _filmed(env, named.load(env), named.name, args.episode_seed)
            films.append(film)
    deployments_figure(episodes, out / FIGURE)
    animate(films, out / ANIMATION)
    if args.readme:
        for name in (FIGURE, ANIMATION):
            copy_file(out / name, Path(__file__).parents[2] / "comparison" / "figures" / name)
    print(f"written to {out}")
    return 0


def _filmed(env: Any, controller: Controller, name: str, seed: int) -> tuple[list[Step], list[Image.Image]]:
    """Run an episode; its steps and its film."""
    steps: list[Step] = []
    film: list[Image.Image] = []

    def record(step: Step) -> None:
        if len(steps) % FRAME_EVERY == 0:
            film.append(_scaled(env.render(), name))
        steps.append(step)

    run_episode(env, controller, seed, record)
    film.append(_scaled(env.render(), name))
    return steps, film


def _scaled(frame: np.ndarray, name: str) -> Image.Image:
    """A frame in the animation's width, under the name of its controller."""
    image = Image.fromarray(frame)
    height = round(WIDTH * image.height / image.width)
    captioned = Image.new("RGB", (WIDTH, CAPTION + height), "white")
    captioned.paste(image.resize((WIDTH, height), Image.Resampling.LANCZOS), (0, CAPTION))
    ImageDraw.Draw(captioned).text((10, 5), name, "black", ImageFont.load_default(16))
    return captioned


def animate(films: Sequence[Sequence[Image.Image]], path: Path) -> None:
    """Write films as one GIF, one above the other; a film that ends first stays on its last frame."""
    width, height = films[0][0].size
    frames = []
    for k in range(max(map(len, films))):
        frame = Image.new("RGB", (width, height * len(films)))
        for row, film in enumerate(films):
            frame.paste(film[min(k, len(film) - 1)], (0, height * row))
        frames.append(frame)
    write_gif(frames, path, FRAMES_PER_SECOND)
