"""Controllers for the deployment environments: torque laws, their tuning, learning and evaluation.

Rooms, from the top down: `commands` (what `solar-env` runs), `comparison` (evaluation), `policies` (trained policies as
data), `learning` (training, run folders), `laws` (controllers without learning); `configs` keeps tuned parameters and
hyperparameters. All rooms share the modules beside them. Imports run one way, from the commands down to
`environments`; pyproject.toml has the layers. The simulator (`solar_env`) never imports this package.
"""
