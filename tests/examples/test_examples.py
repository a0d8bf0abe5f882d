"""The examples run, draw their pictures, and stay short."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from solar_env.support.readme import PACKAGE

EXAMPLES = sorted((PACKAGE / "examples").glob("*.py"))
# What makes them short here, behind the name of the picture.
SHORT = {"train_ppo": ["100"], "loads_of_a_wing": ["2"]}


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
@pytest.mark.filterwarnings("ignore")
def test_every_example_draws_its_picture(path: Path, tmp_path: Path) -> None:
    picture = tmp_path / "picture.png"
    words = [sys.executable, str(path), str(picture), *SHORT.get(path.stem, [])]
    environment = {**os.environ, "PYTHONPATH": str(PACKAGE.parent)}
    subprocess.run(words, cwd=tmp_path, env=environment, check=True, capture_output=True, timeout=300)
    assert picture.stat().st_size > 5000
    assert (PACKAGE / "examples" / "figures" / f"{path.stem}.png").exists()


def test_there_are_eight_and_each_says_its_idea_and_fits_a_screen() -> None:
    assert len(EXAMPLES) == 8
    for path in EXAMPLES:
        text = path.read_text(encoding="utf-8")
        assert len(text.splitlines()) <= 40, path.stem
        assert text.startswith('"""'), path.stem
        assert text.index("\n\n") < text.index('\n"""\n'), f"{path.stem} says no more than its title"
