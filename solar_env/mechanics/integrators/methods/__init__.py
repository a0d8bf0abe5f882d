"""Integration methods, one file each; `table` has their kernels, a row a method.

Imports `settings`, `step` and `formulations` of the room around it, `modal`, `history` and `recording` of `records`,
and the equations with what lies below them. `rosenbrock` builds on `runge_kutta`, and this on `stiff_forces`;
`rosenbrock_step` (with `rosenbrock_stages`) and `alpha_step` are one step of the implicit methods, `alpha_control`
chooses its length.

To add a method, write its module, with a subclass of `step.AdaptiveSettings`, a function that makes its arrays and the
kernels that `table.AdaptiveKernels` lists; its settings are a class of `settings`, and its row in `table.METHODS` says
which order it has. Command line, warm-up, batches and the tests of every method follow.
"""
