"""Files of parameters: complete, explained, read back to the same values, and refused by name, line and rule."""

from __future__ import annotations

import re
from dataclasses import fields

import gymnasium
import numpy as np
import pytest

import solar_env
from solar_env.__main__ import main
from solar_env.array import PRESETS, ArrayParameters
from solar_env.array.parameters.file import explanations, parameter_text, read_parameters
from solar_env.environment.settings import EnvironmentSettings


@pytest.fixture
def file(tmp_path):
    def write(content):
        (tmp_path / "my.toml").write_text(content)
        return tmp_path / "my.toml"

    return write


@pytest.mark.parametrize("preset", PRESETS)
def test_the_printed_file_explains_every_parameter_and_is_read_back(preset, file, capsys):
    assert main(["parameters", "--preset", preset]) == 0
    printed = capsys.readouterr().out
    assert read_parameters(file(printed)) == (ArrayParameters.preset(preset), {})
    texts = explanations()
    assert list(texts) == [item.name for item in fields(ArrayParameters)]
    unwrapped = " ".join(printed.replace("\n# ", " ").split())
    for name, text in texts.items():
        assert len(text) > 5
        assert text in unwrapped, name


def test_what_the_file_leaves_out_has_its_default(file):
    path = file('clearance = [1e-4, 2e-4] # m\ncontact_stiffness = "none"\n')
    assert read_parameters(path).parameters == ArrayParameters(clearance=(1e-4, 2e-4), contact_stiffness=None)


def test_tolerances_are_ranges_about_the_values_and_environments_take_both(file):
    content = (
        "clearance = [1e-4, 2e-4]\n[tolerance]\nclearance = 2e-5\nbody_inertia=5\n[randomize]\nbody_mass=[1e3,2e3]"
    )
    read = solar_env.read_parameters(file(content))
    assert set(read.randomize) == {"clearance", "body_inertia", "body_mass"}
    np.testing.assert_allclose(read.randomize["clearance"], [[0.8e-4, 1.8e-4], [1.2e-4, 2.2e-4]], rtol=1e-12)
    np.testing.assert_allclose(read.randomize["body_inertia"], [245.0, 255.0], rtol=1e-12)
    assert read.randomize["body_mass"] == (1e3, 2e3)
    settings = EnvironmentSettings.of(gymnasium.make("solar_env/Deploy-v1", **read._asdict()).spec.kwargs)
    assert settings.array == read.parameters
    assert settings.ranges == read.randomize


@pytest.mark.parametrize(
    ("content", "line", "words"),
    [
        ("panel_count = 2\nclearence = 1e-4", 2, "'clearence' is unknown; did you mean 'clearance'"),
        ("clearance = '0.1 mm'", 1, "clearance = '0.1 mm' must be a finite number; clearance is: bearing radius minus"),
        ("panel_count = 2.5", 1, "must be a whole number"),
        ("body_mass = -1", 1, "body_mass = -1 must be positive"),
        ("restitution = 0.9\nfriction_speed_zero = 1e-2", 2, "must be below friction_speed_full = 0.001"),
        ("clearance = [1e-4, 2e-4]\n[tolerance]\nclearance = 1e-3", 3, "must be positive"),
        ("[tolerance]\nbody_mass = -1", 2, "must be a finite number, not negative"),
        ("[tolerance]\nbody_mass = [1, 2]", 2, "must be a single number"),
        ("[tolerance]\nclearance = [1e-6, 1e-6, 1e-6]", 2, "more entries than panels"),
        ("[tolerance]\ncontact_law = 1", 2, "is not a real number"),
        ("[tolerance]\nclearence = 1e-5", 2, "did you mean 'clearance'"),
        ("[randomize]\nrestitution = [0.9, 0.7]", 2, "low <= high"),
        ("[tolerance]\nbody_mass=1\n[randomize]\nbody_mass = [1, 2]", 4, "stands in both"),
        ("tolerance = 3", 1, "write [tolerance]"),
        ("[tolerence]\nclearance = 1e-5", 1, "did you mean 'tolerance'"),
        ("body_mass = \nbody_inertia = 1", 1, "is no TOML"),
    ],
)
def test_a_refusal_names_the_line_and_the_rule(content, line, words, file):
    path = file(content)
    with pytest.raises(ValueError, match=re.escape(words)) as refusal:
        read_parameters(path)
    assert str(path) in str(refusal.value)
    assert re.search(rf"line {line}\b", str(refusal.value))


def test_ranges_that_meet_where_they_contradict_are_refused(file):
    path = file("[randomize]\nfriction_speed_zero = [1e-5, 8e-4]\nfriction_speed_full = [5e-4, 1e-3]")
    with pytest.raises(ValueError, match="friction_speed_zero"):
        read_parameters(path)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"\xff\xfe", "no text in UTF-8"),
        (b"a = " + b"[" * 5000, "is nested too deeply"),
        (b"panel_length = " + b"1" * 10_000, "is no TOML"),
        (b"#" * 2**21, "is longer than the 1,048,576 bytes"),
    ],
    ids=["other encoding", "nested", "digits", "long"],
)
def test_what_is_no_file_of_parameters_is_refused_by_its_name(tmp_path, content, words):
    path = tmp_path / "my.toml"
    path.write_bytes(content)
    with pytest.raises(ValueError, match=f"{path}.* {words}"):
        read_parameters(path)


def test_parameters_are_written_as_toml_has_them():
    text = parameter_text(ArrayParameters(body_fixed=True))
    assert "\nbody_fixed = true\n" in text
    assert '\ncable_torque_ratio = "none"\n' in text
