"""Parameters of the array: their values, presets, ranges and files.

`parameters` holds the values with units and sources, `checks` says what they may be and refuses the rest, `ranges`
draws what is not known exactly, `file` reads and writes all of it as TOML.

Imports `mechanics` and `support`. A new parameter is a field of `ArrayParameters`.
"""

from solar_env.array.parameters.parameters import PRESETS as PRESETS
from solar_env.array.parameters.parameters import ArrayParameters as ArrayParameters
