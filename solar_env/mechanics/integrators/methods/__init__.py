"""Integration methods, one file each; `table` has their kernels, a row a method.

Imports `settings` and `formulations` of the room around it, `modal`, `records` and the equations with what lies below
them. `stages` has the arrays of methods in stages and `stage_steps` what these share before the run loop; `rosenbrock`
builds on `runge_kutta`, and this on `stiff_forces`; `rosenbrock_step` (with `rosenbrock_stages`) and `alpha_step` are
one step of the implicit methods.

To add a method, write its module, with a subclass of `stages.StageSettings`, a function that makes its arrays and the
kernels that `table.Kernels` lists; its settings are a class of `settings`, and its row in `table.METHODS` says which
order it has. Command line, warm-up, batches and the tests of every method follow.
"""
