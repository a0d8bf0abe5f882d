"""A film keeps the colours of small marks."""

import numpy as np
from PIL import Image

from solar_env.pictures.films import write_gif


def test_a_small_red_arrow_stays_red_among_many_shades(tmp_path):
    shades = np.tile(np.linspace(0, 255, 640), (360, 1))
    picture = np.stack([shades, shades, 0.5 * shades], axis=-1).astype(np.uint8)
    picture[100:104, 50:90] = (220, 30, 60)
    turned = picture[::-1]
    write_gif([Image.fromarray(picture), Image.fromarray(turned)], tmp_path / "film.gif", 20.0)
    with Image.open(tmp_path / "film.gif") as film:
        assert (film.n_frames, film.info["duration"], film.info["loop"]) == (2, 50, 0)
        first = np.asarray(film.convert("RGB"), int)
        film.seek(1)
        second = np.asarray(film.convert("RGB"), int)
    for shown, row in ((first, 102), (second, 359 - 102)):
        assert np.abs(shown[row, 55:85] - (220, 30, 60)).max() < 20
    assert np.abs(first - picture).mean() < 12
