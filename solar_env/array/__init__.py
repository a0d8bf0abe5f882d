"""The deployable solar array: its parameters with their sources and presets, and the mechanism that they describe.

`parameters` holds the values, their checks, ranges and files, `level` says how panels and joints are modelled,
`construction` turns both into a mechanism, `methods` says which integrator a level gets and whether it is compiled;
`deployment` simulates one, `data_files` keeps it, `ladder` chooses the cheapest level.

Imports `mechanics` and `support`. A new parameter is a field of `ArrayParameters`, documented there, and its use in
`construction`.
"""

# ruff: noqa: F401 - names of the room

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
