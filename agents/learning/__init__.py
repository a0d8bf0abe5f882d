"""Training with Stable-Baselines3, from a configuration to a run folder.

`learn` trains; `runs` says what a run folder holds, and reads it; `vec_env` is the vector environment behind
Stable-Baselines3's interface, `weight_search` CMA-ES and ARS over the weights of a policy, `models` makes models and
plain arrays of trained ones. To add an algorithm: its class in `runs.ALGORITHMS`, and its file in `agents/configs`.
"""
