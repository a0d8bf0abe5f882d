"""Command that films an episode of a controller: `solar-env record`."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image
from rich.console import Console

from agents.commands.arguments import EpisodeOptions
from agents.rollout import Step, run_episode
from solar_env.pictures.gif import write_gif
from solar_env.support.files import check_target, write_bytes
from solar_env.support.progress import counting_bar

SUFFIXES = (".mp4", ".gif")
GIF_WIDTH = 640  # pixels; a GIF in full size has tens of megabytes


@dataclass
class Args(EpisodeOptions):
    """Film one episode of a controller, in real time unless told otherwise.

    The model is flexible-clearance unless another is named.
    """

    controller: str = "servo"
    """law, shipped policy or run folder, see solar-env evaluate --help"""
    out: Path = Path("episode.mp4")
    """film, .mp4 or .gif"""
    speed: float = 1.0
    """times real time"""


def run_command(args: Args) -> int:
    """Run the command; see `Args`."""
    if not 0.0 < args.speed <= 100.0:
        raise ValueError(f"speed = {args.speed!r} must be positive and at most 100")
    check_target(args.out, SUFFIXES)
    if args.out.suffix.lower() == ".mp4":
        _encoder()  # refuses before the episode
    ((named, env),) = args.prepare([args.controller], render_mode="rgb_array")
    frames: list[np.ndarray] = []
    with counting_bar(Console(stderr=True, quiet=args.quiet)) as bar:
        task = bar.add_task("frames", total=None)

        def draw(_: Step) -> None:
            frames.append(env.render())  # type: ignore[arg-type]
            bar.advance(task)

        run_episode(env, named.load(env), args.episode_seed, draw)
    rate = args.speed / env.unwrapped.task.control_period  # type: ignore[attr-defined]
    write_film(frames, args.out, rate)
    print(f"written to {args.out}")
    return 0


def write_film(frames: Sequence[np.ndarray], path: Path, rate: float) -> None:
    """Write frames (height, width, 3) of uint8 as MP4 or GIF, whole or not at all, at so many a second.

    Raises:
        ValueError: imageio-ffmpeg is not installed and the film is an MP4.
        OSError: the file cannot be written.
    """
    if path.suffix.lower() == ".gif":
        height, width = frames[0].shape[:2]
        size = (GIF_WIDTH, round(GIF_WIDTH * height / width))
        write_gif([Image.fromarray(frame).resize(size) for frame in frames], path, rate)
        return
    from tempfile import TemporaryDirectory

    with TemporaryDirectory() as folder:
        draft = Path(folder) / "film.mp4"
        height, width = frames[0].shape[:2]
        writer: Iterator[Any] = _encoder().write_frames(str(draft), (width, height), fps=rate, macro_block_size=2)
        next(writer)
        for frame in frames:
            writer.send(np.ascontiguousarray(frame))  # type: ignore[attr-defined]
        writer.close()  # type: ignore[attr-defined]
        write_bytes(path, draft.read_bytes())


def _encoder() -> Any:
    try:
        import imageio_ffmpeg
    except ImportError as error:
        raise ValueError("MP4 needs imageio-ffmpeg: pip install 'solar-env[video]', or write a .gif") from error
    return imageio_ffmpeg
