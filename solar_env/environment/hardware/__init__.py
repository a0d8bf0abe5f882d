"""The hinge drives between the array and its controller: their sensors and their motor.

`imperfections` describes those of this package's environments (`Hardware`), which `environment.task` applies;
`wrappers` do the same to any environment of Gymnasium.

Imports `solar_env.array`. A new imperfection is a field of `Hardware` and its use in `environment.task.sensors`.
"""

from solar_env.environment.hardware.imperfections import Hardware as Hardware
