"""The Gymnasium environments: one deploying array, and a vector of many that advance together.

From the bottom up: `hardware` and `scenarios` hold the differences between environments; `task` defines an agent's
task: observations, charges, and the end of an episode; `settings` checks all keywords and holds the values that
episodes take from them; `showing` draws and records episodes; `episodes` runs them lane by lane; `env` and
`vector_env` are the environments of Gymnasium, `stable_baselines3` is the vector behind that library's interface. The
room may import `solar_env.array`, `solar_env.pictures` and `solar_env.mechanics`, and nothing else of learning.

To add a keyword: a field of `settings.EnvironmentSettings`; a scenario: a row of `scenarios.SCENARIOS`; a version of
the task: a row of `task.task.VERSIONS`. Ids follow from both tables.
"""
