"""Files of parameters: complete, explained, read back to the same values, and refused by name and rule."""

from __future__ import annotations

import re
from dataclasses import fields, replace

import gymnasium
import numpy as np
import pytest

import solar_env
from solar_env.__main__ import main
from solar_env.array import PRESETS, ArrayParameters
from solar_env.array.parameters import checks
from solar_env.array.parameters.file import explanations, parameter_text, read_parameters
from solar_env.environment.registration import DEPLOY_V1
from solar_env.environment.settings import EnvironmentSettings
from solar_env.mechanics.running.diagnosis import SimulationWarning


@pytest.fixture
def file(tmp_path):
    def write(content):
        path = tmp_path / "my.toml"
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    return write


@pytest.mark.parametrize("preset", PRESETS)
def test_the_printed_file_explains_every_parameter_and_is_read_back(preset, file, capsys):
    assert main(["parameters", preset]) == 0
    printed = capsys.readouterr().out
    assert read_parameters(file(printed)) == (ArrayParameters.preset(preset), {})
    texts = explanations()
    assert list(texts) == [item.name for item in fields(ArrayParameters)]
    unwrapped = " ".join(printed.replace("\n# ", " ").split())
    for name, text in texts.items():
        assert len(text) > 5
        assert text in unwrapped, name


def test_the_file_has_the_words_of_toml_and_what_it_leaves_out_has_its_default(file):
    path = file('clearance = [1e-4, 2e-4] # m\ncontact_stiffness = "none"\n')
    assert read_parameters(path).parameters == ArrayParameters(clearance=(1e-4, 2e-4), contact_stiffness=None)
    text = parameter_text(ArrayParameters(body_fixed=True))
    assert "\nbody_fixed = true\n" in text
    assert '\ncable_torque_ratio = "none"\n' in text


def test_tolerances_are_ranges_about_the_values_and_environments_take_both(file):
    content = (
        "clearance = [1e-4, 2e-4]\n[tolerance]\nclearance = 2e-5\nbody_inertia=5\n[randomize]\nbody_mass=[1e3,2e3]"
    )
    read = solar_env.read_parameters(file(content))
    assert set(read.randomize) == {"clearance", "body_inertia", "body_mass"}
    np.testing.assert_allclose(read.randomize["clearance"], [[0.8e-4, 1.8e-4], [1.2e-4, 2.2e-4]], rtol=1e-12)
    np.testing.assert_allclose(read.randomize["body_inertia"], [245.0, 255.0], rtol=1e-12)
    assert read.randomize["body_mass"] == (1e3, 2e3)
    settings = EnvironmentSettings.of(gymnasium.make(DEPLOY_V1, **read._asdict()).spec.kwargs)
    assert settings.array == read.parameters
    assert settings.ranges == read.randomize


REFUSED = (
    ("panel_count = 2\nclearence = 1e-4", "'clearence' is unknown; did you mean 'clearance'"),
    ("clearance = '0.1 mm'", "clearance = '0.1 mm' must be a finite number; clearance is: bearing radius minus"),
    ("panel_count = 2.5", "must be a whole number"),
    ("spring_preload_angle = [1.5, 90]", "must lie between -2 pi and 2 pi: it is in radians"),
    ("[randomize]\nspring_preload_angle = [1, 90]", "it is in radians, not in degrees"),
    ("[randomize]\nrestitution = [0.9, 0.7]", "low <= high"),
    ("[randomize]\nclearence = [1e-5, 1e-4]", "did you mean 'clearance'"),
    ("randomize = 3", "write [randomize]"),
    ("[tolerance]\nbody_mass = -1", "must be a finite number, not negative"),
    ("[tolerance]\nbody_mass = [1, 2]", "must be a single number"),
    ("[tolerance]\nclearance = [1e-6, 1e-6, 1e-6]", "more entries than panels"),
    ("[tolerance]\nclearance = 3e-4", "tolerance of clearance = 0.0003 is refused: clearance = "),
    ("[tolerance]\nbody_mass=1\n[randomize]\nbody_mass = [1, 2]", "stands in both"),
    ("tolerance.clearance = -1", "must be a finite number"),
    ("[randomise]\nclearance = [1e-5, 1e-4]", "did you mean 'randomize'"),
    # What contradicts a value that the file leaves out.
    ("body_mass = 900\njournal_radius = 1e-4", "clearance = 0.0002 must be below journal_radius"),
    ("body_mass = 900\nfriction_speed_full = 1e-5", "friction_speed_zero = 0.0001 must be below"),
    ("body_mass = 900\ncontact_law = 'pereira'", "contact_stiffness = 73900000000.0 holds for spheres"),
    # What is no file of parameters.
    ("body_mass = \nbody_inertia = 1", "is no TOML"),
    (b"\xfe", "is no TOML: 'utf-8' codec"),
    (b"a = " + b"[" * 5000, "is no TOML"),
    (b"panel_length = " + b"1" * 10_000, "is no TOML"),
    (b"#" * 2**21, "is longer than the 1,048,576 bytes"),
)


def test_a_refusal_names_the_file_and_the_rule(file):
    for content, words in REFUSED:
        path = file(content)
        with pytest.raises(ValueError, match=re.escape(words)) as refusal:
            read_parameters(path)
        assert str(path) in str(refusal.value)


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16"])
def test_a_file_of_an_editor_or_a_shell_of_windows_is_read(file, encoding):
    assert read_parameters(file("body_mass = 900\r\n".encode(encoding))).parameters.body_mass == 900


def test_explanations_are_there_without_docstrings(run_python):
    program = "from solar_env.array.parameters.file import units; print(units()['clearance'])"
    assert run_python(program, PYTHONOPTIMIZE="2").strip() == "m"


@pytest.fixture
def untold(monkeypatch):
    """As in a new process, in which nothing was warned of yet."""
    monkeypatch.setattr(checks, "_told", set())


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("panel_length = 1500", "panel_length = 1500 m is implausibly large for a spacecraft (over 50 m)"),
        ("panel_young = 280", "panel_young = 280 Pa is implausibly small (under 1e+05 Pa); give it in Pa, not in MPa"),
        ("[randomize]\nbody_size = [1.0, 1000.0]", "body_size = 1000 m is implausibly large"),
        ("initial_rate = [0.0, 20.0]", "initial_rate = 20 rad/s is implausibly large"),
        ("panel_damping = 0.02", "give it in s, not in parts of the critical damping"),
        ("latch_gap = 1", "latch_gap = 1 rad is implausibly large for a spacecraft (over 0.3 rad)"),
        ("panel_density = 3.5", "give it in kg/m3, not in kg/m2"),
        ("spring_stiffness = [100, 75]", "give it in N m/rad, not in N mm/rad"),
        ("friction_coefficient = 15", "friction_coefficient = 15 is implausibly large for a spacecraft (over 2)"),
        ("cable_stiffness = 2e4", "give it in N m/rad, not in N mm/rad"),
        ("latch_stiffness = 1e6", "give it in N m/rad, not in N mm/rad"),
        ("latch_damping = 1e4", "give it in N m s/rad, not in N mm s/rad"),
        ("contact_stiffness = 2.34e6", "give it in N/m^1.5, not in N/mm^1.5"),
        ("minimum_impact_speed = 0.1", "give it in m/s, not in mm/s"),
        ("friction_speed_full = 1", "give it in m/s, not in mm/s"),
        ('contact_stiffness = "none"\njournal_young = 207e3', "give it in Pa, not in MPa or GPa"),
        ("body_inertia = 1.28e7", "is a radius of gyration of 92.4 m, larger than body_size = 1 m"),
        ("bearing_young = 70e9", "bearing_young = 70000000000.0 changes nothing: contact_stiffness = 7390"),
    ],
)
def test_a_value_in_another_unit_is_warned_of_once_by_value_and_unit(content, words, file, untold):
    path = file(content)
    with pytest.warns(SimulationWarning, match=re.escape(words)) as told:
        read = read_parameters(path)
    assert len(told) == 1
    assert replace(read.parameters, wear_bins=90).wear_bins == 90, "and not again, whatever is made of it"


def test_every_default_is_plausible_by_a_factor_of_ten_either_way(untold):
    """And so are the values over which the other tests draw arrays."""
    rows = {item.name: checks.row_of(item).usual for item in fields(ArrayParameters)}
    assert sum(usual is not None for usual in rows.values()) > 20
    for name, usual in rows.items():
        for entry in ArrayParameters().entries(name) if usual else ():
            entry = entry or 0.0
            assert entry == 0.0 or usual.low <= 0.1 * entry, name
            assert 10.0 * entry <= usual.high, name
