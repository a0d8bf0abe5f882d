"""Controllers for the deployment environments: torque laws, their tuning, learning and evaluation.

Rooms: `laws` (controllers without learning), `learning` (training), `policies` (trained policies as data), `comparison`
(evaluation), `configs` (tuned parameters and hyperparameters). The modules beside them are the commands (`tune`,
`evaluate`, `search`, `curves`, `transfer`, `export`, `show`) and what the rooms share. Imports run one way, from the
commands down to the laws; pyproject.toml has the layers. The simulator (`solar_env`) never imports this package.
"""
