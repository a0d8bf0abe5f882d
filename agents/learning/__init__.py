"""Training with Stable-Baselines3: configurations, features, landings, models, and the run from one to the other.

Imports the laws, run folders and `agents.vec_env`; not the comparison. To add an algorithm: its class in
`agents.runs.ALGORITHMS`, its file in `agents/configs`, and its ranges in `agents.search.SPACES`.

`minimisation` (CMA-ES) serves the commands `agents.tune` and `agents.search`.
"""
