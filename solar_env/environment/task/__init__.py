"""The control task: what an agent sees, what it is charged, when an episode ends.

`task` has limits, times and motors, and its versions with their prices; `observations`, `features` and `reward` are the
tables of quantities to observe and to charge; `sensors` adds the hardware's imperfections to observations; `control`
says when an array has latched or missed its deadline, `periods` begins and ends a control period.

To add

* an observable: its code, a branch of `observations.reading` and a row of `observations.OBSERVABLES`. Tests and the
  documentation of the environment take it from there. A sensor of a new kind is a field of `hardware.Hardware`.
* a term of the reward: its code, a branch of `reward.reading` and a row of `reward.REWARD_TERMS`; a version charges it
  with a weight in its prices. `tests/environment/task/test_reward_terms.py` wants its figure of an imagined deployment.
* a version: a row of `task.VERSIONS`; a price of another form also a code there and a branch of `reward.cost`.
"""
