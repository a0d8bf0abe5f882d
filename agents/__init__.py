"""Controllers for the deployment environments: torque laws, their tuning, learning and evaluation.

Packages, from the top down: `commands` (of `solar-env`), `comparison` (evaluation), `policies` (trained policies as
data), `learning` (training, run folders), `laws` (controllers without learning). `configs` holds tuned parameters and
hyperparameters. The packages share modules beside them, such as `environments` (keywords, seeds). Imports run one way,
from the top down; pyproject.toml defines the layers. The simulator (`solar_env`) never imports this package.
"""
