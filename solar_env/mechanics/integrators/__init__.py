"""Time integration: one file per method, one driver for all.

`settings` has what a user chooses, in plain Python; `methods` is the table with the kernels of every method; `driver`
runs a call and its lanes; `adaptive` takes steps that land on events, with `acceptance` and `events`; `step` has the
arrays of a step; `history` and `recording` keep what happened to a mechanism and what a run records. Imports the
equations and what lies below them.

To add a method, write its module, with a subclass of `step.AdaptiveSettings`, a function that makes its arrays and the
kernels that `methods.AdaptiveKernels` lists; its settings are a class of `settings`, and its row in `methods.METHODS`
says which order it has. Command line, warm-up, batches and the tests of every method follow.
"""
