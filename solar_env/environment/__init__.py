"""The Gymnasium environments: one deploying array, and a vector of many that advance together.

From the bottom up: `hardware` and `scenarios` say what differs between environments; `task` is what is asked of an
agent: what it sees, what it is charged, when an episode ends; `settings` checks all keywords and holds what episodes
take from them; `showing` has what is seen of an episode; `episodes` runs them lane by lane; `env` and `vector_env` are
the environments of Gymnasium, `stable_baselines3` is the vector behind that library's interface. The room may import
`solar_env.array`, `solar_env.pictures` and `solar_env.mechanics`, and nothing else of learning.

To add a keyword: a field of `settings.EnvironmentSettings`; a scenario: a row of `scenarios.SCENARIOS`; a version of
the task: a row of `task.task.VERSIONS`. Ids follow from both tables.
"""
