"""Content of the wheel: everything that runs, and no pictures."""

import tomllib
from pathlib import Path

import solar_env

ROOT = Path(solar_env.__file__).parent.parent


def test_the_wheel_leaves_the_pictures_out_and_names_the_command():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())
    wheel = project["tool"]["hatch"]["build"]["targets"]["wheel"]
    assert {"*.png", "*.gif"} <= set(wheel["exclude"])
    assert project["project"]["scripts"] == {"solar-env": "agents.script:main"}
    assert {"solar_env", "agents"} == set(wheel["packages"])
    assert project["project"]["version"] == solar_env.__version__


def test_dir_shows_what_there_is():
    for name in ("ArrayParameters", "simulate", "read_parameters", "SolarArrayEnv", "__version__"):
        assert name in dir(solar_env)
        assert getattr(solar_env, name) is not None
