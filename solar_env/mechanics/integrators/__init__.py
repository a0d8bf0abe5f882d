"""Time integration: one file per method, one driver for all.

`settings` has what a user chooses, in plain Python; `methods` is the table with the kernels of every method, and
`formulations` that of what models and states consist of; `driver` runs a call and its lanes; `adaptive` takes steps
that land on events, with `acceptance` and `events`; `step` has the arrays of a step. Imports `modal`, whose method is
one of the table, `records` and the equations.

To add a method, write its module, with a subclass of `step.AdaptiveSettings`, a function that makes its arrays and the
kernels that `methods.AdaptiveKernels` lists; its settings are a class of `settings`, and its row in `methods.METHODS`
says which order it has. Command line, warm-up, batches and the tests of every method follow.
"""
