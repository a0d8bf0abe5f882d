"""Training with Stable-Baselines3: configurations, features, models, and the run from one to the other.

`runs` reads and writes the folder of a training run, `storage` the nested values of its checkpoints; `vec_env` is the
vector environment behind Stable-Baselines3's interface, `weight_search` CMA-ES and ARS over the weights of a policy,
`extraction` makes plain arrays of a trained one. Imports the laws and the policies; not the comparison. To add an
algorithm: its class in `runs.ALGORITHMS`, and its file in `agents/configs`.
"""
