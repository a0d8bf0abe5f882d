"""Films of one episode of several controllers, one above the other, as MP4 or GIF."""

import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from agents.rollout import Step, run_episode
from agents.torque_laws import Controller
from solar_env.pictures.gif import write_gif
from solar_env.support.files import write_bytes

CAPTION = 28  # height of a controller's name [pixels]
FRAMES_PER_SECOND = 10.0


class Format(NamedTuple):
    """How a film is made.

    Attributes:
        width: of a frame [pixels]; a GIF in full size has tens of megabytes.
        speed: times real time.
    """

    width: int
    speed: float


FORMATS = {".mp4": Format(960, 1.0), ".gif": Format(640, 3.0)}


def check_film(path: Path) -> None:
    """Refuse an MP4, by a ValueError, where nothing can encode it."""
    if path.suffix.lower() == ".mp4":
        _encoder()


def filmed(env: Any, controller: Controller, name: str, seed: int, form: Format) -> list[Image.Image]:
    """Run an episode of an environment with `render_mode="rgb_array"`; its frames, under the controller's name."""
    film: list[Image.Image] = []
    interval = form.speed / FRAMES_PER_SECOND

    def record(step: Step) -> None:
        due = math.ceil(step.time_s / interval - 1e-6) - len(film)
        if due > 0:
            film.extend([_captioned(env.render(), name, form.width)] * due)

    run_episode(env, controller, seed, record)
    return film


def _captioned(frame: np.ndarray, name: str, width: int) -> Image.Image:
    """A frame in the film's width, under the name of its controller."""
    image = Image.fromarray(frame)
    height = round(width * image.height / image.width)
    captioned = Image.new("RGB", (width, CAPTION + height), "white")
    captioned.paste(image.resize((width, height), Image.Resampling.LANCZOS), (0, CAPTION))
    ImageDraw.Draw(captioned).text((10, 5), name, "black", ImageFont.load_default(16))
    return captioned


def write_film(films: Sequence[Sequence[Image.Image]], path: Path) -> None:
    """Write films as one, whole or not at all; a film that ends first stays on its last frame.

    Raises:
        ValueError: imageio-ffmpeg is not installed and the film is an MP4.
        OSError: the file cannot be written.
    """
    width, height = films[0][0].size
    frames = []
    for k in range(max(map(len, films))):
        frame = Image.new("RGB", (width, height * len(films)))
        for row, film in enumerate(films):
            frame.paste(film[min(k, len(film) - 1)], (0, height * row))
        frames.append(frame)
    if path.suffix.lower() == ".gif":
        write_gif(frames, path, FRAMES_PER_SECOND)
        return
    with TemporaryDirectory() as folder:
        draft = Path(folder) / "film.mp4"
        size = frames[0].size
        writer: Iterator[Any] = _encoder().write_frames(str(draft), size, fps=FRAMES_PER_SECOND, macro_block_size=2)
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
