"""Training with Stable-Baselines3, from a configuration to a run folder.

`training` trains; `runs` defines and reads run folders; `weight_search` is CMA-ES over the weights of a policy. To add
an algorithm, add its class to `training.ALGORITHMS`.
"""
