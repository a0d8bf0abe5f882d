"""The Gymnasium environments: a single deploying array, and a vector of arrays that advance together.

The modules from the bottom up: `hardware` describes sensors and motors, `scenarios` gives defaults by name. `task`
defines observations, rewards and the end of an episode. `settings` checks all keywords and derives from them what
episodes need. `showing` draws and records episodes. `episodes` runs episodes in the environments of a batch, called
lanes. `env` and `vector_env` are the Gymnasium environments. `stable_baselines3`, the only module that may import a
learning library, adapts the vector to that library. The package may import `array`, `pictures`, `mechanics`, `support`.

A new keyword is a field of `settings.EnvironmentSettings`, a new scenario an entry of `scenarios.SCENARIOS`, a new
version of the task an entry of `task.task.VERSIONS`. The environments' ids follow from the two tables.
"""
