"""Controllers for the deployment environments: baselines, their tuning, learning and evaluation.

Imports run one way, from the command lines down to the laws; pyproject.toml has the layers. The simulator
(``solar_env``) never imports this package.
"""
