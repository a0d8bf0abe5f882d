"""Films as GIF."""

from collections.abc import Sequence
from pathlib import Path

from PIL import Image

from solar_env.support.files import writing


def write_gif(images: Sequence[Image.Image], path: Path, rate: float) -> None:
    """Write images as a GIF that plays for ever, at so many a second; whole or not at all.

    Raises:
        OSError: the file cannot be written.
    """
    # The usual choice of 64 colours goes by area, and lets the small arrows of forces go; an octree keeps them.
    few = [image.convert("RGB").quantize(64, Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE) for image in images]
    timing = {"duration": round(1000 / rate), "loop": 0}
    with writing(path) as file:
        few[0].save(file, "gif", save_all=True, append_images=few[1:], optimize=True, **timing)
