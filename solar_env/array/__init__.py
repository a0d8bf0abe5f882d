"""The deployable solar array: its parameters with their sources and presets, and the mechanism built from them.

`parameters` holds the values with their checks, ranges and files. `level` says how panels and joints are modelled.
`construction` builds the mechanism. `methods` chooses the integrator. `deployment` simulates a deployment, `data_files`
writes the trajectory. `motorization` compares driving and resisting torques. `ladder` finds the cheapest model level.

The package imports `mechanics` and `support`. A new parameter is a documented field of `ArrayParameters`, which
`construction` uses.
"""

# ruff: noqa: F401 - names that the package exports

from solar_env.array.construction import build, main_body_corners
from solar_env.array.ladder import cheapest_level
from solar_env.array.level import MODELS, ModelLevel
from solar_env.array.methods import (
    announce_compilation,
    compilation_note,
    default_integrator,
    make_integrator,
    mark_compiled,
)
from solar_env.array.parameters import PRESETS, ArrayParameters
from solar_env.array.parameters.file import ParameterFile, read_parameters
from solar_env.array.parameters.ranges import RELEASE_RATE, Ranges
