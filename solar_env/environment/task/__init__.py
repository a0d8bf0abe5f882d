"""The control task: an agent's observations, actions and rewards, and the end of an episode.

`task` holds limits, times and driven joints, and the versions of the task with their prices: what a reward term charges
for a quantity. `observations`, `features` and `reward` are tables of quantities to observe and to charge. `sensors`
adds the hardware's imperfections to observations. `drive` turns actions into motor torques. `control` finds the last
latching and a missed deadline. `periods` advances environments by a control period.

* A new observable needs an integer code, a branch of `reading` and an entry of `OBSERVABLES` in `observations`, which
  tests and the environment's documentation read. A new kind of sensor is a field of `hardware.Hardware`.
* A new reward term needs an integer code, a branch of `reading` and an entry of `REWARD_TERMS` in `reward`; a version's
  prices give its weight. `tests/environment/task/test_reward_terms.py` needs its value for an imagined deployment.
* A new version is an entry of `task.VERSIONS`; a new form of price also needs a code and a branch of `reward.cost`.
"""
