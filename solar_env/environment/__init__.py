"""The Gymnasium environments: a single deploying array, and a vector of arrays that advance together.

The modules from the bottom up: `hardware` and `scenarios` hold the differences between environments. `task` defines
observations, rewards and the end of an episode. `settings` checks all keywords and derives from them what episodes
need. `showing` draws and records episodes. `episodes` runs episodes in the environments of a batch, called lanes. `env`
and `vector_env` are the Gymnasium environments; `stable_baselines3` adapts the vector to that library's interface. The
package may import `solar_env`'s `array`, `pictures`, `mechanics` and `support`, and no other learning library.

A new keyword is a field of `settings.EnvironmentSettings`, a new scenario an entry of `scenarios.SCENARIOS`, a new
version of the task an entry of `task.task.VERSIONS`. The environments' ids follow from the two tables.
"""
