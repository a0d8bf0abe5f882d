"""The deployable solar array: its parameters with their sources and presets, and the mechanism that they describe.

`parameters` holds the values, their checks, ranges and files, `level` says how panels and joints are modelled,
`construction` turns both into a mechanism, `methods` says which integrator a level gets and whether it is compiled;
`deployment` simulates one, `data_files` keeps it, `ladder` chooses the cheapest level.

Imports `mechanics` and `support`. A new parameter is a field of `ArrayParameters`, documented there, and its use in
`construction`.
"""

from solar_env.array.construction import build as build
from solar_env.array.construction import main_body_corners as main_body_corners
from solar_env.array.ladder import cheapest_level as cheapest_level
from solar_env.array.level import MODELS as MODELS
from solar_env.array.level import ModelLevel as ModelLevel
from solar_env.array.methods import announce_compilation as announce_compilation
from solar_env.array.methods import compilation_note as compilation_note
from solar_env.array.methods import default_integrator as default_integrator
from solar_env.array.methods import make_integrator as make_integrator
from solar_env.array.methods import mark_compiled as mark_compiled
from solar_env.array.parameters import PRESETS as PRESETS
from solar_env.array.parameters import ArrayParameters as ArrayParameters
from solar_env.array.parameters.file import ParameterFile as ParameterFile
from solar_env.array.parameters.file import read_parameters as read_parameters
from solar_env.array.parameters.ranges import RELEASE_RATE as RELEASE_RATE
from solar_env.array.parameters.ranges import Ranges as Ranges
