"""Writers of films as GIF or MP4."""

from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from types import ModuleType

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from solar_env.support.files import write_bytes, writing

CAPTION, FRAMES_PER_SECOND = 28, 10.0  # height of a caption [pixels], and frames per second


def write_gif(images: Sequence[Image.Image], path: Path, rate: float) -> None:
    """Write images atomically as a GIF that plays for ever, at `rate` images per second.

    Raises:
        OSError: the file cannot be written.
    """
    # The usual choice of 64 colours goes by area and loses the small force arrows; an octree keeps small areas.
    few = [image.convert("RGB").quantize(64, Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE) for image in images]
    timing = {"duration": round(1000 / rate), "loop": 0}
    with writing(path) as file:
        few[0].save(file, "gif", save_all=True, append_images=few[1:], optimize=True, **timing)


def captioned(frame: np.ndarray, name: str, width: int) -> Image.Image:
    """Return a frame (height, width, 3), scaled to a width [pixels], with a name written above it."""
    image = Image.fromarray(frame)
    height = round(width * image.height / image.width)
    shown = Image.new("RGB", (width, CAPTION + height), "white")
    shown.paste(image.resize((width, height), Image.Resampling.LANCZOS), (0, CAPTION))
    ImageDraw.Draw(shown).text((10, 5), name, "black", ImageFont.load_default(16))
    return shown


def write_film(films: Sequence[Sequence[Image.Image]], path: Path) -> None:
    """Stack films vertically, and write them to `path` as one film; a shorter film stays on its last frame."""
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
        draft = Path(folder) / path.name
        writer = encoder().write_frames(str(draft), frames[0].size, fps=FRAMES_PER_SECOND, macro_block_size=2)
        next(writer)
        for frame in frames:
            writer.send(np.ascontiguousarray(frame))
        writer.close()
        write_bytes(path, draft.read_bytes())


def encoder() -> ModuleType:
    """Return the library that writes MP4; raise a ValueError if the library is not installed."""
    try:
        import imageio_ffmpeg
    except ImportError as error:
        raise ValueError("MP4 needs imageio-ffmpeg: pip install -e '.[video]', or write a .gif") from error
    return imageio_ffmpeg
