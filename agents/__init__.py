"""Controllers for the deployment environments: baselines, their tuning, learning and evaluation.

Imports run one way: arguments, environments <- baselines <- runs <- evaluate, tune, learn <- train.py.
The simulator (``solar_env``) never imports this package.
"""
