"""The deployable solar array: its parameters with their sources and presets, and the mechanism that they describe.

`names` refuses unknown names; `models` names the four models, `parameters` holds the values, their checks, ranges and
files, `panels` says how panels are modelled, `construction` turns both into a mechanism, `methods` says which
integrator a model gets, `compilation` whether it is compiled; `deployment` simulates one, `data_files` keeps it,
`ladder` chooses the cheapest model for a question.

Imports `mechanics`. A new parameter is a field of `ArrayParameters` and its use in `construction`.
"""

from solar_env.array.construction import build as build
from solar_env.array.construction import main_body_corners as main_body_corners
from solar_env.array.models import MODELS as MODELS
from solar_env.array.models import check_model as check_model
from solar_env.array.models import has_clearance as has_clearance
from solar_env.array.models import has_flexible_panels as has_flexible_panels
from solar_env.array.panels import DEFAULT_ELEMENTS as DEFAULT_ELEMENTS
from solar_env.array.panels import DEFAULT_MODES as DEFAULT_MODES
from solar_env.array.panels import PANELS as PANELS
from solar_env.array.panels import PanelModel as PanelModel
from solar_env.array.parameters import PRESETS as PRESETS
from solar_env.array.parameters import ArrayParameters as ArrayParameters
from solar_env.array.parameters.file import ParameterFile as ParameterFile
from solar_env.array.parameters.file import read_parameters as read_parameters
