"""Parameters of the array: their values, presets, ranges and files.

`parameters` holds the values with units and sources, `rows` describes joints and panels. `checks` refuses values that
are not allowed, `ranges` samples values not known exactly, `file` reads and writes values and ranges as TOML.

The package imports `mechanics` and `support`. A new parameter is a field of `ArrayParameters`.
"""

from solar_env.array.parameters.parameters import PRESETS as PRESETS
from solar_env.array.parameters.parameters import ArrayParameters as ArrayParameters
