"""Training with Stable-Baselines3: configurations, features, models, and the run from one to the other.

`runs` reads and writes the folder of a training run, whose files `trust` seals; `vec_env` is the vector environment
behind Stable-Baselines3's interface, `weight_search` CMA-ES and ARS over the weights of a policy. Imports the laws; not
the comparison. To add an algorithm: its class in `runs.ALGORITHMS` and its file in `agents/configs`.
"""
