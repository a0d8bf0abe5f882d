"""The Gymnasium environments: one deploying array, and a vector of many that advance together.

From the bottom up: `hardware` and `scenarios` say what differs between environments; `task` has limits, durations and
the motor; `observations` and `reward` are the tables of what can be observed and charged; `periods` begins and ends a
control period with them; `settings` checks all keywords and holds what episodes take from them; `episodes` runs these
lane by lane; `env` and `vector_env` are the environments of Gymnasium. The room may import `solar_env.array`,
`solar_env.pictures` and `solar_env.mechanics`, and nothing of learning.

To add

* an observable: its code, a branch of `observations.reading` and a row of `observations.OBSERVABLES`. Tests and the
  documentation of the environment take it from there. A sensor of a new kind is a field of `hardware.Hardware`.
* a term of the reward: its code, a branch of `reward.reading` and a row of `reward.REWARD_TERMS`, with weight 0 so that
  returns stay comparable. `tests/environment/test_reward_terms.py` wants its figure of an imagined deployment.
* a keyword: a field of `settings.EnvironmentSettings`.
* a scenario: a row of `scenarios.SCENARIOS`, and its id in `registration.ENVIRONMENTS`.
"""
